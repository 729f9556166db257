"""Shaking, jerk and silence: known results, a reference version in plain loops, and changes that must not affect a figure."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.measure.known import Known
from scenarios.measure.posture.smoothness import NEAR, creep, own_acceleration, smoothness
from scenarios.measure.value import Missing
from tests.scenarios.examples import DT, arm_scene, drop_scene, fist, fist_scene, resting, walked

SEEDS = st.integers(0, 2**32 - 1)


def moved(shown: np.ndarray, target: np.ndarray, dt: float = DT) -> Recording:
    """Return a recording with the arm's three links at `shown` (F+1, 3, 3) and the tracker's at `target`."""
    plain = resting(arm_scene(), len(shown) - 1)
    return replace(plain, positions=shown, raw_positions=target, meta={**plain.meta, "dt": dt})


def walk(seed: int, frames: int, size: float = 4e-3) -> np.ndarray:
    """Return link origins (F+1, 3, 3) that reverse about as often as they continue, by a few millimetres."""
    steps = size * np.random.default_rng(seed).normal(size=(frames + 1, 3, 3))
    steps[:, :, 0] += 0.5 * size
    return np.cumsum(steps, axis=0)


def case(seed: int, frames: int = 40) -> tuple[Recording, np.ndarray, np.ndarray]:
    """Return a recording with statuses in some frames, the mask of its free states, and the mask of states in contact."""
    draw = np.random.default_rng(seed)
    shown, target = walk(seed, frames), walk(seed + 1, frames, 2e-3)
    shown[draw.integers(5, frames) :] += 0.2
    # in the first part the user hardly moves, where links creep
    target[: frames // 2] = target[frames // 2] + walk(seed + 2, frames // 2 - 1, 2e-4)
    made = replace(moved(shown, target), statuses={"waiting": (draw.random(frames + 1) < 0.1).astype(np.int64)})
    return made, draw.random(frames + 1) < 0.98, draw.random(frames + 1) < 0.7


def by_loops(recording: Recording, free: np.ndarray, contact: np.ndarray) -> dict[str, float]:
    """Return the figures by their definitions, one number at a time."""
    p, q, dt = recording.positions[:, recording.links].tolist(), recording.raw_positions.tolist(), recording.dt
    frames, links, silent = recording.frames, len(q[0]), 0

    def step(x: list[list[list[float]]], k: int, i: int) -> list[float]:
        return [x[k][i][a] - x[k - 1][i][a] for a in range(3)]

    def second(x: list[list[list[float]]], k: int, i: int) -> float:
        return math.hypot(*(x[k + 1][i][a] - 2.0 * x[k][i][a] + x[k - 1][i][a] for a in range(3)))

    def dot(u: list[float], v: list[float]) -> float:
        return sum(a * b for a, b in zip(u, v, strict=True))

    taken_back = [[0.0] * links for _ in range(frames + 1)]
    for k in range(2, frames + 1):
        for i in range(links):
            now, before = step(p, k, i), step(p, k - 1, i)
            if dot(now, before) < 0.0 and not dot(step(q, k, i), step(q, k - 1, i)) < 0.0:
                taken_back[k][i] = min(math.hypot(*now), math.hypot(*before))
    held, shakes, largest = 0, 0, []
    for k in range(1, frames + 1):
        if contact[k]:
            held += 1
            often = [sum(taken_back[j][i] > 0.18 * dt for j in range(max(k - 3, 1), k + 1)) for i in range(links)]
            shakes += max(often) >= 3
            largest.append(max(taken_back[k]))
    jitters = []
    for i in range(links):
        calm = [k for k in range(1, frames + 1) if contact[k] and math.hypot(*step(q, k, i)) <= 0.18 * dt]
        squares = [min(taken_back[k][i], 0.18 * dt) ** 2 for k in calm]
        jitters.append(math.sqrt(sum(squares) / len(squares)) if squares else 0.0)
    reach, squares, dashes = round(0.05 / dt), [], 0
    for k in range(1, frames + 1):
        own = max(math.hypot(*step(p, k, i)) for i in range(links)) / dt
        near = range(max(k - reach, 1), min(k + reach, frames) + 1)
        dashes += own > max(math.hypot(*step(q, j, i)) / dt for j in near for i in range(links)) + 0.5
    for k in range(1, frames):
        if max(math.dist(p[k][i], q[k][i]) for i in range(links)) > 1e-3:
            for i in range(links):
                near = range(max(k - reach, 1), min(k + reach, frames - 1) + 1)
                allowed = max(second(q, j, i) for j in near) / dt**2
                squares.append(max(second(p, k, i) / dt**2 - allowed, 0.0) ** 2)
    creeps = []
    for k in range(1, frames + 1):
        near = range(max(k - reach, 1), min(k + reach, frames) + 1)
        for i in range(links):
            rests = max(math.hypot(*step(q, j, i)) for j in near) / dt <= 0.1
            if rests and math.dist(p[k][i], q[k][i]) > 1e-3:
                creeps.append(max(math.hypot(*step(p, k, i)) - math.hypot(*step(q, k, i)), 0.0) / dt)
    for k in range(1, frames + 1):
        rested = k >= 29 and all(free[k - 29 : k + 1])
        far = max(math.dist(p[k][i], q[k][i]) for i in range(links)) > 0.1
        silent += bool(rested and far and not any(numbers[k] > 0 for numbers in recording.statuses.values()))
    return {
        "chatter_frames": 100.0 * shakes / held, "jitter_rms": max(jitters),
        "reversal_max": max(map(max, taken_back)), "reversal_p95": float(np.percentile(largest, 95.0)),
        "own_acceleration_rms": math.sqrt(sum(squares) / len(squares)), "dash_frames": float(dashes),
        "creep_mean": sum(creeps) / len(creeps), "silent_offset_frames": float(silent),
    }


@pytest.mark.parametrize("seed", range(6))
def test_figures_are_those_of_plain_loops(seed: int) -> None:
    recording, free, contact = case(seed, 90)
    found, wanted = smoothness(recording, arm_scene(), free, contact), by_loops(recording, free, contact)
    assert found == {name: pytest.approx(value, rel=1e-9) for name, value in wanted.items()}
    assert all(value > 0.0 for value in wanted.values()) and wanted["reversal_p95"] > 3e-3


@settings(max_examples=30, deadline=None)
@given(SEEDS, st.lists(st.floats(-1.0, 1.0), min_size=7, max_size=7), st.floats(0.25, 4.0))
def test_places_turns_and_frame_times_do_not_matter(seed: int, there: list[float], factor: float) -> None:
    """A run at another place, rotated, or with another frame time at equal speeds (lengths then scale with the frame time)."""
    recording, free, contact = case(seed)
    wanted = smoothness(recording, arm_scene(), free, contact)
    turn = rotation.from_rotation_vector(np.array(there[:3]))

    def sent(positions: np.ndarray) -> np.ndarray:
        return np.asarray(rotation.rotate(turn, positions) + 3.0 * np.array(there[3:6]))

    away = replace(recording, positions=sent(recording.positions), raw_positions=sent(recording.raw_positions))
    found = smoothness(away, arm_scene(), free, contact)
    known = {name: value for name, value in wanted.items() if not isinstance(value, Missing)}
    assert {name: found[name] for name in known} == {
        name: pytest.approx(value, rel=1e-6, abs=1e-12) for name, value in known.items()
    }
    quick = moved(factor * recording.positions, factor * recording.raw_positions, factor * DT)
    scaled = smoothness(quick, arm_scene(), free, contact)
    assert scaled["chatter_frames"] == pytest.approx(wanted["chatter_frames"])
    assert scaled["reversal_p95"] == pytest.approx(factor * float(str(wanted["reversal_p95"])))


def test_what_is_no_number_shakes_is_off_and_spoils_the_rest() -> None:
    shown, every = np.zeros((61, 3, 3)), np.ones(61, dtype=bool)
    shown[40:] = np.nan
    found = smoothness(moved(shown, np.zeros_like(shown)), arm_scene(), every, every)
    assert found["chatter_frames"] == pytest.approx(100.0 * 19 / 60) and found["silent_offset_frames"] == 21
    assert all(math.isnan(float(str(found[name]))) for name in ("reversal_p95", "own_acceleration_rms"))
    assert found["dash_frames"] == 21


def test_smoothness_needs_contact_and_an_avatar() -> None:
    """And an avatar that is held off in enough frames, whose user holds it still."""
    recording, free, contact = case(1)
    found = smoothness(recording, arm_scene(), free, np.zeros_like(contact))
    assert all(isinstance(found[name], Missing) for name in ("chatter_frames", "reversal_p95"))
    assert smoothness(resting(drop_scene(), 4), drop_scene(), free, contact) == {}
    off, still = np.full((30, 1, 3), 0.01), np.zeros((30, 1, 3))
    for value in (own_acceleration(off[:2], still[:2], DT), own_acceleration(still, still, DT), creep(still, still, DT)):
        assert isinstance(value, Missing) and value.fault == "scene"


def test_contact_is_a_bad_target_or_a_near_link() -> None:
    """The fist's user moves into the wall from frame 20 on; the shown fist stops before it, or is moved to the side."""
    recording, known, link = walked(30), Known(fist(), fist_scene()), 1
    assert known.contact(recording).tolist() == [k >= 20 for k in range(31)]
    for gap, near in ((0.99 * NEAR, True), (1.01 * NEAR, False), (math.nan, True)):
        recording.positions[:, link, 0] = 0.4 - gap
        assert known.contact(recording).tolist() == [near or k > 20 for k in range(31)]
