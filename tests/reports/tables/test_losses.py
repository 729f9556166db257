"""Scenes in which another engine is better, against a count by hand."""

import math
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from reports.reading.load import EngineNote
from reports.tables.losses import losses
from runfiles.metrics import RANKED
from runfiles.table import Row
from tests.reports.small_runs import BULLET, MUJOCO, OURS, OVERLAP, RAW, figure, run_of

METRICS = (OVERLAP, "course_error_max", "link_jump_max", "joint_limit_excess_max")
numbers = st.sampled_from([0.0, 1e-7, 1e-6, 2e-6, 1e-4, 1.05e-4, 1e-2, 3.0, math.nan])
runs = st.sampled_from((OURS, MUJOCO, BULLET, RAW))
keys = st.tuples(st.sampled_from("abc"), runs, st.sampled_from(METRICS), st.integers(0, 1))
tables = st.dictionaries(keys, numbers | st.none(), min_size=1)


def by_hand(rows: list[Row]) -> dict[str, tuple[int, int]]:
    """Count compared and lost scenes by metric: the worst seed counts, and so does a missing one of a non-optional metric."""
    found: dict[str, tuple[int, int]] = {}
    for name in {row.metric for row in rows}:
        compared = lost = 0
        for scene in "abc":
            values = {run: [row.value for row in rows if (row.scenario, row.metric, row.run) == (scene, name, run)]
                      for run in (OURS, MUJOCO, BULLET)}
            numbers = {run: [one for one in some if one is not None and one == one] for run, some in values.items()}
            best = min((max(numbers[run]) for run in (MUJOCO, BULLET) if numbers[run]), default=None)
            own = [one for one in values[OURS] if one is not None or not RANKED[name].optional]
            if best is not None and own:
                compared += 1
                lost += RANKED[name].better(best, max(numbers[OURS]) if len(numbers[OURS]) == len(own) else math.nan)
        if compared:
            found[name] = (compared, lost)
    return found


@given(tables)
def test_counts_are_those_of_a_count_by_hand(table: dict[tuple[str, str, str, int], float | None]) -> None:
    rows = [figure(scene, run, metric, value, seed=seed) for (scene, run, metric, seed), value in table.items()]
    rows.append(figure("z", OURS, "run", 0.0, "pass", 1.0))
    found = losses(run_of(rows))
    told = {row.metric: (row.scenes, row.lost) for row in found.itertuples()}
    assert told == by_hand([row for row in rows if row.metric != "run"])
    assert found.lost.is_monotonic_decreasing
    for row in found.itertuples():
        assert row.share == row.lost / row.scenes and len(row.each) == row.lost


def compared(*rows: Row) -> dict[str, int]:
    """Return the number of lost scenes by metric."""
    return {row.metric: row.lost for row in losses(run_of(rows)).itertuples()}


def test_every_lost_scene_is_named_the_widest_loss_first() -> None:
    values = {"a": (1e-3, 0.0), "b": (5e-2, 1e-2), "c": (0.0, 1.0)}
    runs = (OURS, MUJOCO)
    rows = [figure(scene, runs[k], OVERLAP, value) for scene, pair in values.items() for k, value in enumerate(pair)]
    [row] = losses(run_of(rows)).itertuples()
    assert (row.scenes, row.lost) == (3, 2) and row.each == [("b", 5e-2, 1e-2, MUJOCO), ("a", 1e-3, 0.0, MUJOCO)]


def test_baselines_our_presets_and_who_left_do_not_win() -> None:
    rows = [figure("a", OURS, OVERLAP, 1.0), figure("a", RAW, OVERLAP, 0.0), figure("a", "avatarsim/paper", OVERLAP, 0.0)]
    assert compared(*rows) == {} and compared(*rows, figure("a", MUJOCO, OVERLAP, 2.0)) == {OVERLAP: 0}
    rows = [figure("a", OURS, OVERLAP, 1.0), figure("a", MUJOCO, OVERLAP, 0.0)]
    assert compared(*rows, figure("a", MUJOCO, "wrong_side_frames", 0.0)) == {OVERLAP: 1}
    for frames in (1.0, math.nan):
        assert OVERLAP not in compared(*rows, figure("a", MUJOCO, "wrong_side_frames", frames))
    assert compared(*rows, figure("b", MUJOCO, "wrong_side_frames", 9.0))[OVERLAP] == 1


def test_what_does_not_compare_is_not_counted() -> None:
    rows = [figure("a", OURS, "reach_cone_excess_max", 9.0), figure("a", MUJOCO, "reach_cone_excess_max", 0.0)]
    note = EngineNote(MUJOCO, "a", "1", {"reach cones": "ignored"}, {})
    assert compared(*rows) == {"reach_cone_excess_max": 1}
    assert losses(run_of(rows, notes=[note])).empty
    one = run_of([figure("a", OURS, "run", None, "crashed")])
    assert losses(one).empty and "lost" in losses(one).columns


def test_a_world_of_another_size_is_compared_as_one_of_size_one() -> None:
    rows = [figure("a", OURS, OVERLAP, 2e-5), figure("a", MUJOCO, OVERLAP, 0.0)]
    assert compared(*rows) == {OVERLAP: 1}
    large = run_of(rows)
    large = replace(large, results=replace(large.results, scales={"a": 1000.0}))
    assert losses(large).lost.tolist() == [0]
    # and shown with its own figures
    small = replace(run_of(rows), results=replace(large.results, scales={"a": 0.1}))
    [row] = losses(small).itertuples()
    assert row.each == [("a", 2e-5, 0.0, MUJOCO)]
