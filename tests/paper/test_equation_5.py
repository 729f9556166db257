"""Eq. 5, phi_h: the turn of a joint that brings the effector nearest to its goal, with a sign."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from avatarsim.paper.ccd_ik import joint_turn
from avatarsim.spatial import rotation

pytestmark = [pytest.mark.nojit]

coordinate = st.floats(-2.0, 2.0)
point = st.tuples(coordinate, coordinate, coordinate)
ORIGIN, Z = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def turned(p, origin, axis, angle):
    return np.array(origin) + rotation.rotate(rotation.from_axis_angle(axis, angle), np.array(p) - origin)


@given(point, point, point, point.filter(lambda a: np.linalg.norm(a) > 0.1))
@hypothesis_settings(deadline=None, max_examples=200)
def test_no_other_turn_brings_the_effector_nearer(effector, goal, origin, axis):
    a = tuple(np.array(axis) / np.linalg.norm(axis))
    phi = joint_turn(origin, a, effector, goal)
    assert -np.pi <= phi <= np.pi
    found = np.linalg.norm(turned(effector, origin, a, phi) - goal)
    for other in np.linspace(-np.pi, np.pi, 73):
        assert found <= np.linalg.norm(turned(effector, origin, a, other) - goal) + 1e-8


@given(st.floats(-3.1, 3.1), st.floats(0.1, 2.0), st.floats(0.1, 2.0), st.floats(-1.0, 1.0))
@hypothesis_settings(deadline=None)
def test_the_sign_is_that_of_the_turn_and_lengths_do_not_matter(phi, length, other_length, height):
    goal = (other_length * np.cos(phi), other_length * np.sin(phi), height)
    assert joint_turn(ORIGIN, Z, (length, 0.0, 0.3), goal) == pytest.approx(phi, abs=1e-14)


def test_small_angles_are_exact_where_acos_is_blind():
    phi = 1e-9
    goal = (np.cos(phi), np.sin(phi), 0.0)
    assert np.arccos(np.clip(np.dot((1.0, 0.0, 0.0), goal), -1.0, 1.0)) == 0.0
    assert joint_turn(ORIGIN, Z, (1.0, 0.0, 0.0), goal) == pytest.approx(phi, rel=1e-12)


@pytest.mark.parametrize(
    ("effector", "goal"),
    [
        ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)), ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)), (ORIGIN, (1.0, 0.0, 0.0)),
        ((1.0, 0.0, 0.0), ORIGIN), (ORIGIN, ORIGIN),
    ],
    ids=["effector on the axis", "goal on the axis", "effector at the joint", "goal at the joint", "both"],
)
def test_a_goal_off_the_plane_does_not_turn_the_joint(effector, goal):
    assert joint_turn(ORIGIN, Z, effector, goal) == 0.0


def test_nan_turns_nothing():
    assert joint_turn(ORIGIN, Z, (np.nan, 0.0, 0.0), (1.0, 0.0, 0.0)) == 0.0
