"""Inertia of the shown posture against backward Euler of a critically damped spring, written out."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.engine import Settings
from avatarsim.ik.inertia import minmod
from avatarsim.ik.motion_budget import AT_REST
from avatarsim.simulator import AvatarsimEngine
from tests.worlds.little_worlds import at, hand_scene


def spring(way: float, omega: float, times: list[float]) -> list[float]:
    """Return ways [m] left after frames of so many seconds, from rest: x'' = -2 omega x' - omega^2 x by backward Euler, as the
    two equations that it is; a motion slower than AT_REST ends at the target."""
    speed, left = 0.0, []
    for dt in times:
        if max(abs(way), abs(speed) * dt) <= AT_REST * dt:
            way, speed = 0.0, 0.0
        else:
            matrix = np.array([[1.0, -dt], [omega**2 * dt, 1.0 + 2.0 * omega * dt]])
            way, speed = np.linalg.solve(matrix, [way, speed])
        left.append(way)
    return left


@given(st.floats(0.005, 0.2), st.floats(10.0, 80.0), st.lists(st.floats(1 / 120, 1 / 50), min_size=5, max_size=40))
@settings(max_examples=30)
def test_an_offset_returns_as_a_critically_damped_spring(off: float, omega: float, times: list[float]) -> None:
    """The user of a hand moves along y all the while; only the hand's offset along x takes time."""
    scene = hand_scene((0.0, 0.0, 0.0))
    user, seen, clock = scene.first_sample, [], 0.0
    with AvatarsimEngine() as engine:
        engine.load(scene, Settings("default", {"natural_frequency": omega, "catch_up_move": 1e3}), times[0])
        engine.put(at(user, (off, 0.0, 0.0)), user)
        for dt in times:
            clock += dt
            record = engine.advance(at(user, (0.0, 0.3 * clock, 0.0)), dt)
            seen.append(record.shown.positions[0])
    assert [place[1] for place in seen] == pytest.approx(0.3 * np.cumsum(times), abs=1e-12)
    assert [place[0] for place in seen] == pytest.approx(spring(off, omega, times), abs=1e-9)


@given(st.floats(allow_nan=True), st.floats(allow_nan=True))
def test_minmod_is_between_both_numbers_and_zero(a: float, b: float) -> None:
    found = minmod(a, b)
    assert found == 0.0 or (found in (a, b) and a * b > 0.0 and abs(found) == min(abs(a), abs(b)))
