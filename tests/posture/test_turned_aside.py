"""What a hand without joints pays for being turned: the cost against its own differences, and what it is for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.posture.closeness import couple, merit_of
from avatarsim.posture.turned_aside import ASIDE, SLIGHT, STRAIGHT, bent, cost, rise
from avatarsim.posture.workspace import RIGID
from avatarsim.scene.scene import Scene
from tests.posture.little_worlds import hand, little, mixed_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
ANGLES = st.floats(0.0, 3.0)


@given(ANGLES)
def test_the_rise_is_the_slope_of_the_cost(angle: float) -> None:
    square, step = angle * angle, 1e-7
    slope = (cost(square + step) - cost(square)) / step
    assert slope == pytest.approx(rise(square), rel=1e-2, abs=1e-6)


@given(ANGLES)
def test_what_bends_is_never_less_than_the_second_derivative_and_no_more_where_nothing_bends_down(angle: float) -> None:
    step = 1e-4
    second = (cost((angle + step) ** 2) - 2.0 * cost(angle * angle) + cost((angle - step) ** 2)) / (2.0 * step * step)
    assert bent(angle * angle) >= second - 1e-5 * bent(angle * angle) - 1e-3
    if angle > 30.0 * SLIGHT:
        assert bent(angle * angle) == pytest.approx(second, rel=1e-2)


def test_the_first_angles_cost_more_and_the_largest_too() -> None:
    assert rise(0.0) == 1.0 + STRAIGHT
    assert rise(SLIGHT**2) == pytest.approx(1.0 + 0.25 * STRAIGHT, rel=1e-6)
    assert rise(ASIDE**2) == pytest.approx(2.0, rel=1e-6)
    angles = np.radians([5.0, 10.0, 20.0, 40.0])
    assert [rise(angle**2) for angle in angles] == pytest.approx([1.0] * 4, abs=0.1)


def turned(by: float) -> tuple[float, np.ndarray]:
    """Merit and pull of a hand that is `by` [rad] from its user's, in place."""
    scene = Scene("s", (), (hand(),))
    found = little(scene)
    c, nd = found.memory.goal.closeness, len(found.memory.goal.closeness.pull)
    full = np.zeros(nd)
    full[3:6] = by * np.array([0.6, 0.0, 0.8])
    c.here[:], c.there[:], c.far[0] = 0.0, 0.0, 1.0
    couple(found.world.skeleton, np.vstack([np.eye(3), np.eye(3)]), full, c)
    return merit_of(c, c.here, full), c.pull.copy()


@pytest.mark.parametrize("by", [0.001, 0.02, 0.4, 1.5])
def test_a_hand_is_weighed_by_the_cost_of_the_square_and_wants_home(by: float) -> None:
    c = little(Scene("s", (), (hand(),))).memory.goal.closeness
    merit, pull = turned(by)
    assert c.mode[RIGID] == 1.0
    assert merit == pytest.approx(0.5 * c.turn_weight[3] * cost(by * by))
    assert pull[:3] == pytest.approx(0.0, abs=1e-15)
    # a way home that goes no farther than home
    assert 0.0 < np.linalg.norm(pull[3:]) <= by * (1.0 + 1e-9)
    assert pull[3:] / np.linalg.norm(pull[3:]) == pytest.approx([0.6, 0.0, 0.8])


def test_joints_of_an_avatar_are_weighed_by_the_square_alone() -> None:
    found = little(Scene("s", (), (mixed_avatar(),)))
    c = found.memory.goal.closeness
    full = np.full(len(c.pull), 0.3)
    c.there[:] = c.here
    assert c.mode[RIGID] == 0.0
    assert merit_of(c, c.here, full) == pytest.approx(0.5 * 0.09 * c.turn_weight.sum())
