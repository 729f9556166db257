"""Pooled statistics against a dumb twin: loops over frames, sorted lists, percentiles on the line between two neighbours."""

import math
from dataclasses import asdict

import numpy as np
import pytest

from scenarios.posture_table.rows import Row, row_of, rows
from scenarios.posture_table.runs import Seen
from tests.scenarios.posture_table.runs_by_hand import run


def slow_percentile(values: list[float], share: float) -> float:
    """On the line between the two neighbours in order."""
    if not values:
        return math.nan
    values = sorted(values)
    place = share / 100.0 * (len(values) - 1)
    low = int(place)
    high = min(low + 1, len(values) - 1)
    return values[low] + (place - low) * (values[high] - values[low])


def slow_row(runs: list[Seen]) -> dict[str, float]:
    """The same figures, frame by frame."""
    contact = shaking = turns = moves = silent = owed = far = 0
    largest_turn = largest_move = 0.0
    reversals, offsets, angles, times = list[float](), list[float](), list[float](), list[float]()
    for one in runs:
        s = one.series
        assert s is not None
        times += one.times.tolist()
        for k in range(len(s.contact)):
            if s.contact[k]:
                contact += 1
                shaking += int(s.shakes[k])
                reversals.append(s.reversal[k])
                offsets.append(s.offset[k])
                angles.append(s.angle[k])
            turns += int(s.turn[k] > 15.0)
            moves += int(s.way[k] > 0.1)
            largest_turn, largest_move = max(largest_turn, s.turn[k]), max(largest_move, s.way[k])
            silent += int(s.silent[k])
            if s.owed[k]:
                owed += 1
                far += int(s.farthest[k] > 0.1)
    return {
        "contact": contact, "chatter": 100.0 * shaking / contact if contact else math.nan, "turns": turns, "root_moves": moves,
        "turn_max": largest_turn, "root_max": largest_move, "silent": silent, "owed": owed,
        "far": 100.0 * far / owed if owed else math.nan, "reversal_p95": slow_percentile(reversals, 95.0),
        "offset_p50": slow_percentile(offsets, 50.0), "offset_p95": slow_percentile(offsets, 95.0),
        "angle_p50": slow_percentile(angles, 50.0), "angle_p95": slow_percentile(angles, 95.0),
        "time_p50": slow_percentile(times, 50.0), "time_p99": slow_percentile(times, 99.0), "time_max": max(times),
    }


@pytest.mark.parametrize("seed", range(6))
def test_a_row_is_what_loops_over_frames_give(seed: int) -> None:
    random, runs = np.random.default_rng(seed), []
    for k in range(3):
        frames = int(random.integers(1, 40))
        flags = {name: random.integers(0, 2, frames) for name in ("contact", "shakes", "silent", "owed")}
        values = {name: random.exponential(size, frames) for name, size in (
            ("reversal", 0.01), ("turn", 12.0), ("way", 0.1), ("farthest", 0.1), ("offset", 0.1), ("angle", 9.0))}
        runs.append(run(f"s{k}", frames=frames, times=random.exponential(50.0, frames), **flags, **values))
    found = asdict(row_of("avatarsim/default", "g", runs))
    for name, value in slow_row(runs).items():
        assert found[name] == pytest.approx(value, rel=1e-12, nan_ok=True), name


def one(**given: object) -> Row:
    return row_of("avatarsim/default", "g", [run(**given)])  # type: ignore[arg-type]


def test_jumps_are_those_beyond_the_limits_and_not_at_them() -> None:
    found = one(turn=[1.0, 40.0, 16.0, 15.0], way=[0.0, 0.5, 0.2, 0.1])
    assert (found.turns, found.turn_max, found.root_moves, found.root_max) == (2, 40.0, 2, 0.5)


def test_what_is_no_number_counts_as_a_jump_and_as_far_off() -> None:
    nan = math.nan
    found = one(turn=[0, nan, 0, 0], way=[nan, 0, 0, 0], farthest=[nan, 0, 0, 0], owed=[1, 1, 0, 0])
    assert found.turns == 1 and found.root_moves == 1 and math.isnan(found.turn_max) and found.far == 50.0


def test_the_worst_run_counts_for_promises_and_the_median_for_jerk() -> None:
    figures = [
        {"residual_overlap_max": 1e-9, "joint_limit_excess_max": 0.5, "jerk_ratio": 1.0},
        {"residual_overlap_max": 3e-9, "reach_cone_excess_max": 0.7, "jerk_ratio": 9.0, "not_finite_frames": 2.0},
        {"residual_overlap_max": 2e-9, "jerk_ratio": 2.0, "wrong_side_frames": 5.0},
    ]
    found = row_of("e", "g", [run(f"s{k}", figures=given) for k, given in enumerate(figures)])
    assert (found.overlap, found.limits, found.jerk_ratio, found.runs) == (3e-9, 0.7, 2.0, 3)
    assert (found.not_finite, found.wrong_side) == (2, 5)
    broken = row_of("e", "g", [run(figures={"residual_overlap_max": math.nan}), run(figures=figures[0])])
    assert math.isnan(broken.overlap)


def test_the_slowest_frame_is_named_with_scene_seed_and_number() -> None:
    found = row_of("e", "g", [run("a", times=[1, 2, 9, 1]), run("b", seed=7, times=[1, 30, 2, 2])])
    assert found.slowest == "b --seed 7 frame 2" and found.time_max == 30.0
    untimed = row_of("e", "g", [run("a")])
    assert untimed.slowest == "" and math.isnan(untimed.time_p50)


def test_rows_of_a_group_stand_together_in_the_order_in_which_groups_came() -> None:
    runs = [run("b1"), run("b1", "paper"), run("a1"), run("a1", "paper"), run("b2"), Seen(run("a2").job, "crashed", "why")]
    found = rows(runs, lambda name: name[0])
    assert [(row.group, row.engine, row.runs) for row in found] == [
        ("b", "avatarsim/default", 2), ("b", "avatarsim/paper", 1), ("a", "avatarsim/default", 1), ("a", "avatarsim/paper", 1),
    ]
