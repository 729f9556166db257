"""Swing and twist against scipy; the projection onto limits is idempotent, inside, and the nearest by dense sampling."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.model.joint_limits import (
    LEFT_ALONE,
    SURELY,
    any_normal,
    cone_excess,
    has_cone,
    inside_cone,
    surely_inside,
    swing_and_twist,
    wrapped,
)
from avatarsim.model.skeleton import Skeleton, skeleton
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free, ReachCone, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from tests.stability.hostile import swing_twist_excess
from tests.worlds.little_worlds import piece

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
SEEDS = st.integers(0, 100_000)
Z = (0.0, 0.0, 1.0)
KINDS = {
    "tilted": SwingTwist(Z, (0.6, 0.0, 0.8), 0.8, (-0.5, 1.0)),
    "wide": SwingTwist((1.0, 2.0, 0.5), (-0.3, 0.4, 0.5), 2.5, (-3.0, 3.0)),
    "opposite": SwingTwist(Z, (0.0, 0.0, -1.0), 1.0, (-1.0, 0.2)),
    "locked twist": SwingTwist(Z, Z, 0.5, (0.1, 0.1)),
    "no swing": SwingTwist(Z, (0.0, 1.0, 0.0), 0.0, (-1.0, 1.0)),
    "one-sided": SwingTwist(Z, Z, 1.2, (0.4, 2.0)),
}


def skel_of(
    limits: SwingTwist | None, cone: ReachCone | None = None, orientation: Any = (1.0, 0.0, 0.0, 0.0)
) -> Skeleton:
    """Return a root and a ball with these limits."""
    mass = solid(piece(), 1.0)
    limb = Link("limb", "root", Ball(limits, cone), piece(), mass, orientation=orientation)
    return skeleton(Scene("s", avatars=(Avatar("a", (Link("root", None, Free(), piece(), mass), limb)),)))


SKELETONS = {name: skel_of(limits) for name, limits in KINDS.items()}


def tuples(turn: Rotation) -> Any:
    """Return columns of a rotation."""
    return tuple(tuple(float(v) for v in column) for column in turn.as_matrix().T)


def from_tuples(c: tuple) -> Rotation:
    """Return the rotation of three columns."""
    return Rotation.from_matrix(np.array(c).T)


def composed(limits: SwingTwist, swing: float, bearing: float, twist: float) -> Rotation:
    """Return a rotation made of a stated swing away from the centre, at a stated bearing, and a stated twist about the centre."""
    centre = np.array(limits.centre)
    side = np.array(any_normal(limits.centre))
    about = Rotation.from_rotvec(bearing * centre).apply(side)
    start = Rotation.from_quat(rotation.between(limits.axis, limits.centre), scalar_first=True)
    return Rotation.from_rotvec(swing * about) * Rotation.from_rotvec(twist * centre) * start


@given(st.sampled_from(sorted(KINDS)), st.floats(0.0, 3.1), st.floats(-3.14, 3.14), st.floats(-3.1, 3.1))
def test_swing_and_twist_are_what_a_rotation_was_made_of(name: str, swing: float, bearing: float, twist: float) -> None:
    limits = KINDS[name]
    found, turned, back = swing_and_twist(SKELETONS[name].balls, 1, tuples(composed(limits, swing, bearing, twist)))
    # close to the centre the swing is a difference of nearly equal directions
    assert found == pytest.approx(swing, abs=1e-11)
    assert wrapped(turned - twist) == pytest.approx(0.0, abs=1e-9 if swing > 1e-6 else 1e-6)
    assert np.linalg.norm(back) == pytest.approx(1.0)


@given(st.sampled_from(sorted(KINDS)), SEEDS)
def test_the_excess_is_scipys(name: str, seed: int) -> None:
    turn = Rotation.random(rng=seed)
    (excess,) = swing_twist_excess([Ball(KINDS[name])], Rotation.concatenate([turn]))
    assert cone_excess(SKELETONS[name].balls, 1, tuples(turn)) == pytest.approx(excess, abs=1e-9)


@given(st.sampled_from(sorted(KINDS)), SEEDS)
def test_the_projection_is_inside_and_idempotent(name: str, seed: int) -> None:
    skel, turn = SKELETONS[name], tuples(Rotation.random(rng=seed))
    once = inside_cone(skel.balls, 1, turn)
    assert np.array(once) @ np.array(once).T == pytest.approx(np.eye(3), abs=1e-13)
    # without room for the safety margin the projection lands on the limit itself, to rounding
    tight = KINDS[name].swing == 0.0 or KINDS[name].twist[0] == KINDS[name].twist[1]
    assert cone_excess(skel.balls, 1, once) <= (1e-12 if tight else 0.0)
    assert np.array(inside_cone(skel.balls, 1, once)) == pytest.approx(np.array(once), abs=1e-9)


@pytest.mark.parametrize("name", ["tilted", "wide", "opposite", "one-sided"])
@pytest.mark.parametrize("seed", range(6))
def test_limb_and_twist_go_to_the_nearest_inside_limits(name: str, seed: int) -> None:
    """Dense sampling: no direction of the cone is nearer to the limb, no angle of the interval to the twist."""
    limits, skel = KINDS[name], SKELETONS[name]
    turn = Rotation.random(rng=seed)
    found = from_tuples(inside_cone(skel.balls, 1, tuples(turn)))
    limb, kept = turn.apply(limits.axis), found.apply(limits.axis)
    cloud = Rotation.random(40_000, rng=1).apply([0.0, 0.0, 1.0])
    cloud = cloud[cloud @ np.array(limits.centre) >= np.cos(limits.swing)]
    reached = np.arctan2(np.linalg.norm(np.cross(limb, kept)), limb @ kept)
    best = np.arctan2(np.linalg.norm(np.cross(limb, cloud), axis=1), cloud @ limb).min()
    assert reached <= best + 1e-6
    _, twist, _ = swing_and_twist(skel.balls, 1, tuples(turn))
    _, after, _ = swing_and_twist(skel.balls, 1, tuples(found))
    angles = np.linspace(*limits.twist, 20_001)
    nearest = np.abs(np.arctan2(np.sin(angles - twist), np.cos(angles - twist))).min()
    assert abs(wrapped(after - twist)) <= nearest + 1e-6


def test_a_ball_without_limits_has_none() -> None:
    assert not has_cone(skel_of(None).balls, 1)
    assert has_cone(SKELETONS["wide"].balls, 1) and not has_cone(SKELETONS["wide"].balls, 0)


def test_a_nan_rotation_is_not_inside_its_limits() -> None:
    nowhere = ((np.nan,) * 3,) * 3
    assert not cone_excess(SKELETONS["tilted"].balls, 1, nowhere) <= 0.0


@given(st.sampled_from(sorted(KINDS)), SEEDS)
def test_surely_inside_has_no_excess_and_is_not_touched(name: str, seed: int) -> None:
    turn = tuples(Rotation.random(random_state=seed))
    excess = cone_excess(SKELETONS[name].balls, 1, turn)
    if excess < -1e-8:
        assert inside_cone(SKELETONS[name].balls, 1, turn) == turn
    if surely_inside(SKELETONS[name].balls, 1, turn, SURELY):
        assert excess <= 0.0
    else:
        assert excess >= -1e-8, "that is asked of the exact angles in vain"


@pytest.mark.parametrize("beyond", [-1e-6, -1e-9, 1e-13, 1e-9, 1e-6])
@given(st.sampled_from(["tilted", "wide", "opposite", "one-sided"]), SEEDS)
def test_at_an_edge_only_who_is_inside_is_surely_inside(beyond: float, name: str, seed: int) -> None:
    limits, rng = KINDS[name], np.random.default_rng(seed)
    low, high = limits.twist
    edge, bearing, middle = rng.integers(3), rng.uniform(-3.0, 3.0), 0.5 * (low + high)
    swing = limits.swing + beyond if edge == 0 else 0.5 * limits.swing
    twist = (middle, low - beyond, high + beyond)[edge]
    turn = tuples(composed(limits, swing, bearing, twist))
    assert surely_inside(SKELETONS[name].balls, 1, turn, SURELY) == (beyond < -1e-10)
    # a value left alone as a target is the value that would be returned to the bit
    assert surely_inside(SKELETONS[name].balls, 1, turn, LEFT_ALONE) == (beyond < -1e-8)
    assert beyond >= -1e-8 or inside_cone(SKELETONS[name].balls, 1, turn) == turn
