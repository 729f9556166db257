"""Reach cones: inside, angle and nearest direction against dense sampling and the judge's own formula."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.model.joint_limits import (
    angle_between,
    cone_excess,
    inside_cone,
    is_in_reach,
    limb_of,
    nearest_in_reach,
    nearest_on_edge,
    reach_excess,
)
from avatarsim.scene.joint import ReachCone, SwingTwist
from scenarios.measure.posture.limits import beyond_cone, swing_twist
from tests.model.test_limits import from_tuples, skel_of, tuples

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
SEEDS = st.integers(0, 100_000)
WHOLE, MOST = 3.1, 0.95 * np.pi


def polygon(*angles: float, centre: tuple[float, float, float] = (0.0, 0.0, 1.0)) -> ReachCone:
    """Return corners at these angles [degrees] from a centre, evenly around it, counter-clockwise seen from outside."""
    tilt, around = np.radians(angles), 2.0 * np.pi * np.arange(len(angles)) / len(angles)
    up = np.stack([np.sin(tilt) * np.cos(around), np.sin(tilt) * np.sin(around), np.cos(tilt)], axis=1)
    turn = Rotation.align_vectors([centre], [(0.0, 0.0, 1.0)])[0]
    return ReachCone(turn.apply(up), centre)


CONES = {
    "convex": polygon(55.0, 40.0, 70.0, 45.0, 60.0),
    "concave": polygon(70.0, 30.0, 65.0, 25.0, 70.0, 35.0),
    "star": polygon(85.0, 15.0, 80.0, 10.0, 60.0, 20.0, 85.0, 12.0, centre=(0.6, 0.0, 0.8)),
    "wider than a hemisphere": polygon(120.0, 110.0, 140.0, 130.0, 100.0, 125.0),
    "small": polygon(1e-3, 2e-3, 1e-3, centre=(0.0, 1.0, 0.0)),
}


SKELETONS = {name: skel_of(None, cone) for name, cone in CONES.items()}


def direction(seed: int) -> tuple[float, float, float]:
    """Return a unit direction; every third one near the north pole, where most polygons are."""
    rng = np.random.default_rng(seed)
    v = rng.normal(size=3) + (np.array([0.0, 0.0, 2.0]) if seed % 3 == 0 else 0.0)
    x, y, z = v / np.linalg.norm(v)
    return float(x), float(y), float(z)


def boundary(cone: ReachCone, count: int = 4000) -> np.ndarray:
    """Return points all along the edges."""
    share = np.linspace(0.0, 1.0, count)[:, None]
    arcs = []
    for a, b in zip(cone.vertices, np.roll(cone.vertices, -1, axis=0), strict=True):
        angle = np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)
        arcs.append((np.sin((1.0 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle))
    return np.concatenate(arcs)


@given(st.sampled_from(sorted(CONES)), SEEDS)
def test_the_excess_is_the_judges(name: str, seed: int) -> None:
    limb = direction(seed)
    found, judged = reach_excess(SKELETONS[name].balls, 1, limb), beyond_cone(CONES[name], np.array([limb]))[0]
    assert found >= 0.0 and is_in_reach(SKELETONS[name].balls, 1, limb) == (found == 0.0)
    assert found == pytest.approx(judged, abs=1e-11)


@given(st.sampled_from(sorted(CONES)), SEEDS)
def test_nothing_inside_is_nearer_than_the_nearest_direction(name: str, seed: int) -> None:
    limb, skel = direction(seed), SKELETONS[name]
    nearest = nearest_in_reach(skel.balls, 1, limb, MOST)
    assert beyond_cone(CONES[name], np.array([nearest])) <= 2e-12
    if is_in_reach(skel.balls, 1, limb):
        assert nearest == limb
    else:
        densely = np.min(np.arccos(np.clip(boundary(CONES[name]) @ limb, -1.0, 1.0)))
        assert angle_between(nearest, limb) == pytest.approx(densely, abs=2e-6)
        assert angle_between(nearest, limb) <= densely + 1e-7
        assert nearest_in_reach(skel.balls, 1, nearest, MOST) == pytest.approx(nearest, abs=1e-12)


@given(st.sampled_from(["convex", "concave", "wider than a hemisphere"]), st.floats(0.4, 2.0), SEEDS)
def test_with_a_swing_cone_the_nearest_direction_is_inside_both(name: str, most: float, seed: int) -> None:
    limits = SwingTwist((0.0, 0.0, 1.0), (0.1, 0.0, 0.995), MOST, (-WHOLE, WHOLE))
    skel, limb, centre = skel_of(limits, CONES[name]), direction(seed), np.array(limits.centre)
    nearest = nearest_in_reach(skel.balls, 1, limb, most)
    assert beyond_cone(CONES[name], np.array([nearest])) <= 2e-12
    assert np.arctan2(np.linalg.norm(np.cross(nearest, centre)), nearest @ centre) <= most + 2e-12
    rng = np.random.default_rng(seed)
    around = np.array(nearest) + angle_between(nearest, limb) * rng.normal(size=(2000, 3))
    around /= np.linalg.norm(around, axis=1)[:, None]
    allowed = [p for p in around[around @ centre >= np.cos(most)] if is_in_reach(skel.balls, 1, tuple(p))]
    assert all(angle_between(tuple(p), limb) >= angle_between(nearest, limb) - 1e-9 for p in allowed)


@given(SEEDS)
def test_the_nearest_point_of_an_arc_is_an_end_beyond_its_ends(seed: int) -> None:
    start, end, limb = (np.array(direction(seed + k)) for k in (1, 7, 13))
    if np.linalg.norm(np.cross(start, end)) < 1e-3:
        return
    normal = np.cross(start, end) / np.linalg.norm(np.cross(start, end))
    nearest = nearest_on_edge(tuple(start), tuple(end), tuple(normal), tuple(limb))
    angle = np.arctan2(np.linalg.norm(np.cross(start, end)), start @ end)
    share = np.linspace(0.0, 1.0, 4000)[:, None]
    arc = (np.sin((1.0 - share) * angle) * start + np.sin(share * angle) * end) / np.sin(angle)
    assert max(arc @ limb) == pytest.approx(np.dot(nearest, limb), abs=1e-6)


@given(st.sampled_from(["convex", "concave"]), SEEDS)
@example("concave", 0)
def test_a_rotation_comes_into_polygon_cone_and_twist_at_once(name: str, seed: int) -> None:
    limits = SwingTwist((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), 0.9, (-0.4, 0.6))
    orientation = tuple(float(q) for q in Rotation.random(rng=seed + 1).as_quat(scalar_first=True))
    skel, turn = skel_of(limits, CONES[name], orientation), Rotation.random(rng=seed)
    inside = inside_cone(skel.balls, 1, tuples(turn))
    assert cone_excess(skel.balls, 1, inside) <= 2e-12
    # the judge's measure: from the link's orientation in its parent
    shown = (Rotation.from_quat(orientation, scalar_first=True) * from_tuples(inside)).as_quat(scalar_first=True)[None]
    swing, twist = swing_twist(limits, shown)
    limb = Rotation.from_quat(shown[0], scalar_first=True).apply(limits.axis)
    assert swing[0] <= limits.swing + 1e-9 and -0.4 - 1e-9 <= twist[0] <= 0.6 + 1e-9
    assert beyond_cone(CONES[name], limb[None]) <= 1e-11
    again = inside_cone(skel.balls, 1, inside)
    assert np.allclose(again, inside, atol=1e-8)


@given(SEEDS)
def test_without_limits_the_limb_points_to_the_visible_point(seed: int) -> None:
    orientation = tuple(float(q) for q in Rotation.random(rng=seed).as_quat(scalar_first=True))
    skel = skel_of(None, CONES["star"], orientation)
    at_zero = limb_of(skel.balls, 1, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    assert Rotation.from_quat(orientation, scalar_first=True).apply(at_zero) == pytest.approx((0.6, 0.0, 0.8), abs=1e-12)


def test_paper_reach_cone_may_be_wider_than_a_hemisphere() -> None:
    skel = SKELETONS["wider than a hemisphere"]
    assert is_in_reach(skel.balls, 1, (1.0, 0.0, -0.2)) and not is_in_reach(skel.balls, 1, (0.0, 0.0, -1.0))
    nearest = nearest_in_reach(skel.balls, 1, (0.0, 0.0, -1.0), MOST)
    # the corner at 140 degrees is 40 from the pole below, and an edge from it passes a little nearer
    densely = np.arccos(np.max(-boundary(CONES["wider than a hemisphere"])[:, 2]))
    assert angle_between(nearest, (0.0, 0.0, -1.0)) == pytest.approx(densely, abs=1e-6) and 0.65 < densely < np.radians(40.0)
