"""Eq. 6 in the lower loop: the root relative to a moving tracker, and what it remembers."""

import numpy as np
import pytest

from avatarsim.model.skeleton import BALL, FREE
from avatarsim.paper.attraction import couple_roots, settle_roots
from avatarsim.settings import CouplingSettings

pytestmark = [pytest.mark.nojit]

KIND = np.array([FREE, BALL], dtype=np.int64)
MASS = np.array([0.4, 1.0])
EQ_6 = CouplingSettings()


def rows(*x):
    return np.array([[value, 0.0, 0.0] for value in x])


def frame(tracker, tracked, shown, velocity, dt, couple=1):
    speed, target = rows(velocity, 0.0), rows(9.0, 9.0)
    couple_roots(KIND, rows(tracker, 5.0), rows(tracked, 5.0), rows(shown, 5.0), MASS, dt, EQ_6, couple, speed, target)
    assert target[1, 0] == 9.0 and speed[1, 0] == 0.0
    return target[0, 0], speed[0, 0]


def test_a_root_that_moves_with_its_tracker_does_not_trail():
    place, speed = frame(0.05, 0.0, 0.0, 3.0, 0.05 / 3.0)
    assert place == pytest.approx(0.05, abs=1e-15)
    assert speed == pytest.approx(3.0, abs=1e-12)


@pytest.mark.parametrize("frames", [1, 5, 100])
def test_frames_of_any_length_add_up(frames):
    place, speed, seconds = 0.1, -0.5, 0.08
    for _ in range(frames):
        place, speed = frame(0.0, 0.0, place, speed, seconds / frames)
    # critically damped: 40^2 = 4 * 0.4 * 1000
    s = 50.0
    assert place == pytest.approx((0.1 + (-0.5 + s * 0.1) * seconds) * np.exp(-s * seconds), rel=1e-9)


def test_without_coupling_or_time_the_root_is_where_the_user_is():
    assert frame(0.3, 0.0, 0.0, 0.0, 0.1, couple=0) == (0.3, 0.0)
    assert frame(0.3, 0.0, 0.0, 0.0, 0.0)[0] == 0.3


def test_a_root_that_was_held_has_the_velocity_it_was_shown_to_have():
    speed, tracked = rows(7.0, 0.0), rows(0.0, 0.0)
    settle_roots(KIND, rows(1.0, 0.0), rows(0.5, 0.0), rows(0.2, 0.0), rows(0.3, 0.0), 0.1, speed, tracked)
    assert speed[0, 0] == pytest.approx(1.0)
    assert tracked[0, 0] == 1.0
    # and one that went where eq. 6 wanted keeps the velocity of eq. 6
    speed = rows(7.0, 0.0)
    settle_roots(KIND, rows(1.0, 0.0), rows(0.3, 0.0), rows(0.2, 0.0), rows(0.3, 0.0), 0.1, speed, tracked)
    assert speed[0, 0] == 7.0


def test_a_tracker_that_is_no_number_is_not_remembered():
    speed, tracked = rows(np.nan, 0.0), rows(0.0, 0.0)
    settle_roots(KIND, rows(np.nan, 0.0), rows(np.nan, 0.0), rows(0.2, 0.0), rows(0.2, 0.0), 0.1, speed, tracked)
    assert (speed[0, 0], tracked[0, 0]) == (0.0, 0.2)
