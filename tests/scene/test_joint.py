"""Joints: limits in order, axes of length 1, cones with a direction."""

import math

import numpy as np
import pytest

from avatarsim.errors import InvalidScene
from avatarsim.scene.joint import MANY_TURNS, Ball, Hinge, Hinges, ReachCone, SwingTwist

X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def test_hinge_limits_must_be_in_order() -> None:
    with pytest.raises(InvalidScene) as error:
        Hinge(X, 1.0, -1.0)
    assert "(1.0, -1.0)" in str(error.value) and "lower at most upper" in str(error.value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e6])
def test_hinge_limits_are_finite(value: float) -> None:
    with pytest.raises(InvalidScene, match="lower hinge limit"):
        Hinge(X, lower=value)
    with pytest.raises(InvalidScene, match="upper hinge limit"):
        Hinge(X, upper=value)


def test_a_locked_hinge_is_allowed_and_a_free_one_has_wide_limits() -> None:
    assert Hinge(X, 0.5, 0.5).lower == 0.5
    assert Hinge(X).upper == MANY_TURNS


def test_axes_are_scaled_and_zero_is_refused() -> None:
    assert Hinge((0.0, 3.0, 4.0)).axis == pytest.approx((0.0, 0.6, 0.8))
    with pytest.raises(InvalidScene, match="hinge axis"):
        Hinge((0.0, 0.0, 0.0))


@pytest.mark.parametrize("count", [0, 4])
def test_one_to_three_hinges_share_a_centre(count: int) -> None:
    with pytest.raises(InvalidScene, match=f"number of hinges that share a centre is {count}; valid: 1 to 3"):
        Hinges((Hinge(X),) * count)


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        ((X, Z, math.nan, (0.0, 0.0)), "swing limit"),
        ((X, Z, -0.1, (0.0, 0.0)), "swing limit"),
        ((X, Z, 3.1, (0.0, 0.0)), "swing limit"),
        ((X, Z, 1.0, (0.5, -0.5)), "lower at most upper"),
        ((X, Z, 1.0, (-4.0, 0.0)), "lower twist limit"),
        ((X, Z, 1.0, (0.0, math.nan)), "upper twist limit"),
        (((0.0, 0.0, 0.0), Z, 1.0, (0.0, 0.0)), "swing axis"),
        ((X, (0.0, 0.0, 0.0), 1.0, (0.0, 0.0)), "swing centre"),
    ],
)
def test_swing_and_twist_limits_say_what_is_wrong(arguments: tuple, part: str) -> None:
    with pytest.raises(InvalidScene, match=part):
        SwingTwist(*arguments)


def test_reach_cones_need_three_directions() -> None:
    with pytest.raises(InvalidScene, match="at least 3 directions"):
        ReachCone(np.array([X, Z]), X)
    with pytest.raises(InvalidScene, match="at least 3 directions"):
        ReachCone(np.array([X, Z, (0.0, 0.0, 0.0)]), X)
    with pytest.raises(InvalidScene, match="visible point"):
        ReachCone(np.eye(3), (0.0, 0.0, 0.0))
    cone = ReachCone(2.0 * np.eye(3), (1.0, 1.0, 1.0))
    assert (cone.vertices == np.eye(3)).all() and not cone.vertices.flags.writeable


@pytest.mark.parametrize(
    ("corners", "seen", "part"),
    [
        (np.eye(3)[::-1], (1.0, 1.0, 1.0), "counter-clockwise"),
        (np.eye(3), (1.0, 1.0, -0.5), "height above an edge"),
        (np.eye(3), (1.0, 1.0, 0.0), "height above an edge"),
        (np.array([X, X, (0.0, 1.0, 0.0), Z]), (1.0, 1.0, 1.0), "edge of the reach cone"),
        (np.vstack([np.eye(3), np.eye(3)]), (1.0, 1.0, 1.0), "turns of the reach cone"),
    ],
)
def test_a_reach_cone_is_seen_from_its_visible_point_once_around(corners: np.ndarray, seen: tuple, part: str) -> None:
    with pytest.raises(InvalidScene, match=part):
        ReachCone(corners, seen)


def test_a_visible_point_beyond_the_swing_limit_is_refused() -> None:
    cone = ReachCone(np.eye(3), (1.0, 1.0, 1.0))
    with pytest.raises(InvalidScene, match="from the swing centre"):
        Ball(SwingTwist(Z, Z, 0.5, (-1.0, 1.0)), cone)
    assert Ball(SwingTwist(Z, Z, 1.0, (-1.0, 1.0)), cone).cone is cone


def test_a_ball_may_be_free() -> None:
    assert Ball().limits is None
