"""Contact manifolds of resting solids against a brute-force twin: both faces as half-planes, every two lines crossed."""

from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import ConvexHull as Qhull
from scipy.spatial.transform import Rotation

from avatarsim.collision.manifold import (
    FEATURE_ROOM,
    MANIFOLD_POINTS,
    clip,
    flat,
    make_manifold,
    manifold,
    slope,
    to_segment,
    wrap,
)
from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.scene.body import Body, simulated, solid
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape
from tests.rigid.upper_world import World, slab, thing

Array = NDArray[np.float64]
pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

BAND = 1e-6
GAPS = (2e-8, 0.0, -2.5e-7, 5e-7)
EXACT = 2e-8
"""Accuracy [m] of points in the face: their heights are good to rounding, their places to that over the gap's own tilt."""


def standing(name: str, shape: Shape, position: Array, turn: Rotation) -> Body:
    """Return a body of one shape, placed."""
    pieces = (Piece(shape),)
    quaternion = tuple(turn.as_quat()[[3, 0, 1, 2]])
    return simulated(name, pieces, "m", solid(pieces, 1.0), tuple(position), quaternion)


def contact(bodies: list[Body]) -> tuple[Array, Array, Array, Array]:
    """Return (points on the first, points on the second, gaps, normal out of the second into the first)."""
    world = World(bodies)
    vertices, shapes, found = world.poses.vertices, world.geometry.shapes, make_manifold()
    status, gap, n, on_a, on_b = signed_distance(vertices, shapes, 0, 1, (0.0, 0.0, 0.0), make_scratch())
    assert status == 0
    count, n = manifold(vertices, shapes, 0, 1, n, on_a, on_b, gap, BAND, found)
    assert 1 <= count <= MANIFOLD_POINTS
    return found.on_a[:count].copy(), found.on_b[:count].copy(), found.gap[:count].copy(), np.array(n)


def half_planes(corners: Array) -> Array:
    """Return rows (a, b, c), a x + b y <= c, of a polygon; of a segment, its line from both sides and both ends."""
    if len(corners) == 2:
        d = (corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0])
        side = np.array([-d[1], d[0]])
        return np.array([
            [*side, side @ corners[0]], [*-side, -side @ corners[0]], [*d, d @ corners[1]], [*-d, -d @ corners[0]],
        ])
    centre, hull = corners.mean(axis=0), Qhull(corners)
    rows = []
    for i, k in hull.simplices:
        d = corners[k] - corners[i]
        side = np.array([-d[1], d[0]]) / np.linalg.norm(d)
        side = -side if side @ (centre - corners[i]) > 0.0 else side
        rows.append([*side, side @ corners[i]])
    return np.array(rows)


def common(one: Array, two: Array) -> tuple[Array, Array]:
    """Return (corners of the common part of two polygons or segments, all their half-planes), by crossing every two lines."""
    planes = np.vstack([half_planes(one), half_planes(two)])
    found: list[np.ndarray] = []
    for i, k in combinations(range(len(planes)), 2):
        m = planes[[i, k], :2]
        if abs(np.linalg.det(m)) > 1e-9:
            p = np.linalg.solve(m, planes[[i, k], 2])
            if np.all(planes[:, :2] @ p <= planes[:, 2] + 1e-9) and all(np.linalg.norm(p - q) > 1e-7 for q in found):
                found.append(p)
    return np.array(found), planes


def area(points: Array) -> float:
    """Return the area of the convex hull of points in the plane."""
    return float(Qhull(points).volume) if len(points) > 2 and np.linalg.matrix_rank(points - points[0], tol=1e-6) == 2 else 0.0


def compare(points: Array, one: Array, two: Array) -> None:
    """Points (k, 2) lie in both faces and span all that these have in common: every corner, or most of the area if many."""
    corners, planes = common(one, two)
    assert np.all(points @ planes[:, :2].T <= planes[:, 2] + EXACT)
    whole = area(corners)
    if len(corners) <= MANIFOLD_POINTS:
        near = np.linalg.norm(corners[:, None] - points, axis=2).min(axis=1)
        assert near.max() <= EXACT
        assert area(points) == pytest.approx(whole, abs=1e-6)
    else:
        # a regular octagon fills 0.9 of the circle around it
        assert area(points) >= 0.75 * whole
    if whole > 1e-5:
        # the centre of an even pressure lies between the points, or a body at rest would topple
        fan = Qhull(corners)
        triangles = [(corners.mean(axis=0), corners[i], corners[k]) for i, k in fan.simplices]
        weight = np.array([abs(np.linalg.det(np.array([q - p, r - p]))) for p, q, r in triangles])
        centroid = (weight[:, None] * np.array([(p + q + r) / 3.0 for p, q, r in triangles])).sum(axis=0) / weight.sum()
        held = Qhull(points).equations
        assert np.all(held[:, :2] @ centroid + held[:, 2] <= 1e-12)


def rectangle(size: Array, yaw: float, at: Array) -> Array:
    """Return corners of a face (4, 2)."""
    c, s = np.cos(yaw), np.sin(yaw)
    corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size[:2]
    return np.asarray(corners @ np.array([[c, s], [-s, c]]) + at)


@pytest.mark.parametrize("gap", GAPS)
def test_box_on_box_at_any_yaw(gap: float) -> None:
    rng = np.random.default_rng(1)
    seen = set()
    for _ in range(30):
        low, high = rng.uniform(0.1, 0.6, size=3), rng.uniform(0.1, 0.6, size=3)
        yaw, at = rng.uniform(-np.pi, np.pi), rng.uniform(-0.15, 0.15, size=2)
        one, two = rectangle(high, yaw, at), rectangle(low, 0.0, np.zeros(2))
        if len(common(one, two)[0]) < 3:
            continue
        bodies = [
            standing("high", Box(tuple(high)), np.array([*at, 0.5 * high[2] + gap]), Rotation.from_euler("z", yaw)),
            standing("low", Box(tuple(low)), np.array([0.0, 0.0, -0.5 * low[2]]), Rotation.identity()),
        ]
        on_a, on_b, gaps, n = contact(bodies)
        compare(on_a[:, :2], one, two)
        seen.add(len(on_a))
        np.testing.assert_allclose(n, [0.0, 0.0, 1.0], atol=1e-8)
        np.testing.assert_allclose(gaps, gap, atol=1e-12)
        np.testing.assert_allclose(on_a[:, 2], gap, atol=1e-8)
        np.testing.assert_allclose(on_b[:, 2], 0.0, atol=1e-8)
    assert len(seen) >= 3


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("capsule", [False, True])
def test_an_edge_or_a_lying_capsule_on_a_face(gap: float, capsule: bool) -> None:
    """The stretch that both have in common, also where one end hangs over."""
    rng = np.random.default_rng(2)
    for _ in range(25):
        length, yaw, at = rng.uniform(0.1, 0.9), rng.uniform(-np.pi, np.pi), rng.uniform(-0.2, 0.2, size=2)
        face = rectangle(np.array([0.5, 0.4]), 0.0, np.zeros(2))
        end = 0.5 * length * np.array([np.cos(yaw), np.sin(yaw)])
        line = np.array([at - end, at + end])
        if capsule:
            radius = rng.uniform(0.01, 0.2)
            shape: Shape = Capsule(radius, length)
            turn, height = Rotation.from_euler("yz", [0.5 * np.pi, yaw]), radius
        else:
            shape = Box((length, 0.2, 0.2))
            turn, height = Rotation.from_euler("xz", [0.25 * np.pi, yaw]), 0.1 * np.sqrt(2.0)
        low = standing("low", Box((0.5, 0.4, 0.3)), np.array([0.0, 0.0, -0.15]), Rotation.identity())
        on_a, on_b, gaps, n = contact([standing("high", shape, np.array([*at, height + gap]), turn), low])
        corners, planes = common(line, face)
        if len(corners) < 2:
            continue
        assert len(on_a) == 2
        assert np.all(on_a[:, :2] @ planes[:, :2].T <= planes[:, 2] + EXACT)
        assert np.linalg.norm(corners[:, None] - on_a[:, :2], axis=2).min(axis=1).max() <= EXACT
        np.testing.assert_allclose(gaps, gap, atol=1e-12)
        np.testing.assert_allclose(n, [0.0, 0.0, 1.0], atol=1e-8)


def footed(rng: np.random.Generator, corners: int) -> tuple[ConvexHull, Array]:
    """Return a hull with a flat foot at z = 0 (corners, 2) and a smaller top."""
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, size=corners))
    foot = np.stack([0.3 * np.cos(angle), 0.2 * np.sin(angle)], axis=1)
    top = np.column_stack([0.5 * foot + 0.02 * rng.normal(size=foot.shape), rng.uniform(0.1, 0.2, size=corners)])
    return ConvexHull(np.vstack([np.column_stack([foot, np.zeros(corners)]), top])), foot


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("corners", [3, 5, 8, 20])
def test_the_foot_of_a_hull_on_a_face(corners: int, gap: float) -> None:
    rng = np.random.default_rng(corners)
    for _ in range(8):
        shape, foot = footed(rng, corners)
        if area(foot) < 0.02:
            continue
        yaw, at = rng.uniform(-np.pi, np.pi), rng.uniform(-0.2, 0.2, size=2)
        c, s = np.cos(yaw), np.sin(yaw)
        face = rectangle(np.array([0.5, 0.4]), 0.0, np.zeros(2))
        placed = foot @ np.array([[c, s], [-s, c]]) + at
        turn = Rotation.from_euler("z", yaw)
        # the little world of the tests places centres of mass
        centre = turn.apply(solid((Piece(shape),), 1.0).centre)
        high = standing("high", shape, np.array([*at, gap]) + centre, turn)
        low = standing("low", Box((0.5, 0.4, 0.3)), np.array([0.0, 0.0, -0.15]), Rotation.identity())
        on_a, _, gaps, _ = contact([high, low])
        compare(on_a[:, :2], placed, face)
        assert np.all(gaps < BAND)


@pytest.mark.parametrize("gap", [2e-8, -2.5e-7])
def test_an_ellipsoid_rests_on_one_point(gap: float) -> None:
    rng = np.random.default_rng(6)
    for _ in range(10):
        radii, turn = rng.uniform(0.05, 0.3, size=3), Rotation.random(random_state=int(rng.integers(1 << 30)))
        up = turn.inv().apply([0.0, 0.0, 1.0])
        reach = float(np.linalg.norm(radii * up))
        low = standing("low", Box((2.0, 2.0, 0.3)), np.array([0.0, 0.0, -0.15]), Rotation.identity())
        on_a, on_b, gaps, n = contact([standing("egg", Ellipsoid(tuple(radii)), np.array([0.0, 0.0, reach + gap]), turn), low])
        assert len(on_a) == 1
        lowest = turn.apply(-(radii**2) * up / reach) + [0.0, 0.0, reach + gap]
        np.testing.assert_allclose(on_a[0], lowest, atol=1e-5)
        assert on_b[0, 2] == pytest.approx(0.0, abs=1e-9)
        assert gaps[0] == pytest.approx(gap, abs=1e-9)
        np.testing.assert_allclose(n, [0.0, 0.0, 1.0], atol=1e-4)


@pytest.mark.parametrize("gap", [2e-8, -2.5e-7, 3e-7])
def test_the_same_manifold_from_everywhere(gap: float) -> None:
    """Turned and shifted worlds, and A and B changed over: the same points in some order."""
    rng = np.random.default_rng(9)
    for _ in range(12):
        low, high = rng.uniform(0.1, 0.6, size=3), rng.uniform(0.1, 0.6, size=3)
        yaw, at = rng.uniform(-np.pi, np.pi), rng.uniform(-0.05, 0.05, size=2)
        places = [(np.array([*at, 0.5 * high[2] + gap]), Rotation.from_euler("z", yaw)),
                  (np.array([0.0, 0.0, -0.5 * low[2]]), Rotation.identity())]
        shapes = [Box(tuple(high)), Box(tuple(low))]

        points, _, gaps, n = contact([standing(str(i), shapes[i], *places[i]) for i in (0, 1)])
        for order in (1, -1):
            about, shift = Rotation.random(random_state=int(rng.integers(1 << 30))), rng.normal(size=3)
            bodies = [standing(str(i), shapes[i], about.apply(places[i][0]) + shift, about * places[i][1]) for i in (0, 1)]
            on_a, on_b, other_gaps, m = contact(bodies[::order])
            others, m = about.inv().apply((on_a if order == 1 else on_b) - shift), about.inv().apply(m) * order
            assert len(others) == len(points)
            apart = np.linalg.norm(points[:, None] - others, axis=2)
            assert apart.min(axis=1).max() <= EXACT and apart.min(axis=0).max() <= EXACT
            np.testing.assert_allclose(other_gaps, gaps[0], atol=1e-12)
            np.testing.assert_allclose(m, n, atol=1e-7)


def over_slab(shape: Shape, height: float, orientation: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)) -> tuple[Array, Array]:
    """Return manifold of a body over a slab of 2 m by 2 m: points on the body, gaps."""
    body = thing("body", shape, (0.0, 0.0, height), orientation=orientation)
    return contact([slab((2.0, 2.0, 1.0)), body])[1:3]


@pytest.mark.parametrize("corners", [FEATURE_ROOM, FEATURE_ROOM + 1, 128, 400])
def test_a_disc_of_many_corners_stands_on_all_of_its_rim(corners: int) -> None:
    """With the first 64 corners of 128 it rested on half of its base, and fell over."""
    angles = 2.0 * np.pi * np.arange(corners) / corners
    rim = 0.2 * np.stack([np.cos(angles), np.sin(angles), np.zeros(corners)], axis=1)
    points, gaps = over_slab(ConvexHull(np.concatenate([rim - [0.0, 0.0, 0.3], rim + [0.0, 0.0, 0.3]])), 0.3 + 2e-8)
    np.testing.assert_allclose(gaps, 2e-8, atol=1e-15)
    around = np.sort(np.arctan2(points[:, 1], points[:, 0]))
    # eight points, evenly but for those that a corner takes
    assert len(points) == MANIFOLD_POINTS
    assert np.diff(np.append(around, around[0] + 2.0 * np.pi)).max() < np.pi / 4.0 + 4.0 * np.pi / FEATURE_ROOM
    assert np.linalg.norm(points[:, :2], axis=1).min() > 0.199


def test_a_box_on_its_corner_has_one_point() -> None:
    turn = np.array([0.88047624, 0.27984814, 0.3647052, 0.11591690])
    w, x, y, z = turn = turn / np.linalg.norm(turn)
    up = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
    corner, gaps = over_slab(Box((0.2, 0.2, 0.2)), 0.1 * np.abs(up).sum(), tuple(turn))
    assert len(corner) == 1 and gaps[0] == pytest.approx(0.0, abs=1e-15)


def test_a_slight_tilt_shows_in_the_gaps() -> None:
    tilt = 1e-6
    _, gaps = over_slab(Box((0.4, 0.2, 0.1)), 0.05 + 3e-7, (1.0, 0.0, 0.5 * tilt, 0.0))
    np.testing.assert_allclose(sorted(gaps), [1e-7, 1e-7, 5e-7, 5e-7], atol=1e-12)


def test_crossed_edges_touch_in_one_point() -> None:
    half = np.pi / 8.0
    c, s = np.cos(half), np.sin(half)
    low = thing("low", Box((1.0, 0.2, 0.2)), (0.0, 0.0, 0.0), orientation=(c, s, 0.0, 0.0))
    high = thing("high", Box((0.2, 1.0, 0.2)), (0.03, 0.04, 0.2 * np.sqrt(2.0) + 1e-8), orientation=(c, 0.0, s, 0.0))
    on_a = contact([low, high])[0]
    assert len(on_a) == 1
    np.testing.assert_allclose(on_a[0], [0.03, 0.0, 0.1 * np.sqrt(2.0)], atol=1e-9)


def rows(points: np.ndarray, room: int = 40) -> np.ndarray:
    """Return points (n, 2) as rows (u, v, 0) with room to grow."""
    out = np.zeros((room, 3))
    out[: len(points), :2] = points
    return out


def test_wrap_leaves_out_points_on_edges_and_copies() -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.25], [0, 0], [0.5, 0.5]], dtype=float)
    out = np.zeros((40, 3))
    assert wrap(rows(square), len(square), 1e-12, out) == 4
    assert area(out[:4, :2]) == pytest.approx(1.0)


def test_clip_of_a_segment_by_another_keeps_the_common_stretch() -> None:
    subject = rows(np.array([[0.0, 0.0], [4.0, 0.0]]))
    assert clip(subject, 2, rows(np.array([[5.0, 0.1], [1.0, 0.1]])), 2, np.zeros((40, 3))) == 2
    assert sorted(subject[:2, 0]) == [1.0, 4.0]


def test_slope_is_the_plane() -> None:
    points = rows(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]))
    points[:4, 2] = 3.0 + 0.5 * points[:4, 0] - 0.25 * points[:4, 1]
    assert slope(points, 4) == pytest.approx((3.0, 0.5, -0.25))
    assert slope(points, 2) == pytest.approx((3.0, 0.5, 0.0))


def test_a_sliver_becomes_a_segment() -> None:
    points = rows(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1e-6], [0.0, 1e-6]]))
    assert flat(points, 4)
    assert to_segment(points, 4) == 2
    assert np.ptp(points[:2, 0]) == 1.0
