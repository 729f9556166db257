"""Contact manifolds of touching solids: how many points, where, and how wide the gaps."""

import numpy as np
import pytest

from avatarsim.collision.manifold import FEATURE_ROOM, MANIFOLD_POINTS, make_manifold, manifold
from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Shape, Sphere
from tests.rigid.upper_world import World, slab, thing

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def points_of(shape: Shape, height: float, orientation: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0), at: float = 0.0):
    """Manifold of a body over a slab of 2 m by 2 m: (points on the body, gaps, normal from the body into the slab)."""
    world = World([slab((2.0, 2.0, 1.0)), thing("body", shape, (at, 0.0, height), orientation=orientation)])
    vertices, shapes, found = world.poses.vertices, world.geometry.shapes, make_manifold()
    status, gap, n, on_a, on_b = signed_distance(vertices, shapes, 0, 1, (0.0, 0.0, 0.0), make_scratch())
    assert status == 0
    count, n = manifold(vertices, shapes, 0, 1, n, on_a, on_b, gap, 1e-6, found)
    return found.on_b[:count].copy(), found.gap[:count].copy(), np.array(n)


@pytest.mark.parametrize("gap", [2e-8, 0.0, -2.5e-7, 9e-7])
def test_a_flat_box_has_its_four_corners(gap: float) -> None:
    points, gaps, n = points_of(Box((0.4, 0.2, 0.1)), 0.05 + gap)
    assert {(round(x, 9), round(y, 9)) for x, y, _ in points} == {(x, y) for x in (-0.2, 0.2) for y in (-0.1, 0.1)}
    np.testing.assert_allclose(gaps, gap, atol=1e-15)
    np.testing.assert_allclose(n, [0.0, 0.0, -1.0], atol=1e-12)


@pytest.mark.parametrize("corners", [FEATURE_ROOM, FEATURE_ROOM + 1, 128, 400])
def test_a_disc_of_many_corners_stands_on_all_of_its_rim(corners: int) -> None:
    """With the first 64 corners of 128 it stood on half of its base, and fell over."""
    angles = 2.0 * np.pi * np.arange(corners) / corners
    rim = 0.2 * np.stack([np.cos(angles), np.sin(angles), np.zeros(corners)], axis=1)
    points, gaps, _ = points_of(ConvexHull(np.concatenate([rim - [0.0, 0.0, 0.3], rim + [0.0, 0.0, 0.3]])), 0.3 + 2e-8)
    np.testing.assert_allclose(gaps, 2e-8, atol=1e-15)
    around = np.sort(np.arctan2(points[:, 1], points[:, 0]))
    # eight points, evenly but for what a corner takes
    assert len(points) == MANIFOLD_POINTS
    assert np.diff(np.append(around, around[0] + 2.0 * np.pi)).max() < np.pi / 4.0 + 4.0 * np.pi / FEATURE_ROOM
    assert np.linalg.norm(points[:, :2], axis=1).min() > 0.199


def test_a_box_over_the_edge_is_clipped() -> None:
    points, _, _ = points_of(Box((0.4, 0.2, 0.1)), 0.05, at=1.0)
    assert {(round(x, 9), round(y, 9)) for x, y, _ in points} == {(x, y) for x in (0.8, 1.0) for y in (-0.1, 0.1)}


def test_a_box_on_its_edge_has_two_points_and_on_its_corner_one() -> None:
    half = np.pi / 8.0
    edge, _, _ = points_of(Box((0.2, 0.2, 0.2)), 0.1 * np.sqrt(2.0), (np.cos(half), np.sin(half), 0.0, 0.0))
    assert sorted(round(p[0], 9) for p in edge) == [-0.1, 0.1]
    turn = np.array([0.88047624, 0.27984814, 0.3647052, 0.11591690])
    turn /= np.linalg.norm(turn)
    w, x, y, z = turn
    up = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
    corner, gaps, _ = points_of(Box((0.2, 0.2, 0.2)), 0.1 * np.abs(up).sum(), tuple(turn))
    assert len(corner) == 1 and gaps[0] == pytest.approx(0.0, abs=1e-15)


def test_a_slight_tilt_shows_in_the_gaps() -> None:
    tilt = 1e-6
    _, gaps, _ = points_of(Box((0.4, 0.2, 0.1)), 0.05 + 3e-7, (1.0, 0.0, 0.5 * tilt, 0.0))
    np.testing.assert_allclose(sorted(gaps), [1e-7, 1e-7, 5e-7, 5e-7], atol=1e-12)


def test_a_lying_capsule_has_two_points_on_its_surface() -> None:
    lying = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)
    points, gaps, _ = points_of(Capsule(0.06, 0.2), 0.06 + 5e-8, lying)
    np.testing.assert_allclose(sorted(points[:, 0]), [-0.1, 0.1], atol=1e-12)
    np.testing.assert_allclose(points[:, 2], 5e-8, atol=1e-14)
    np.testing.assert_allclose(gaps, 5e-8, atol=1e-14)


@pytest.mark.parametrize("shape", [Sphere(0.1), Ellipsoid((0.2, 0.15, 0.1))])
def test_smooth_bodies_touch_in_one_point(shape: Shape) -> None:
    points, gaps, _ = points_of(shape, 0.1 + 1e-7)
    assert len(points) == 1
    np.testing.assert_allclose(points[0], [0.0, 0.0, 1e-7], atol=1e-9)
    assert gaps[0] == pytest.approx(1e-7, abs=1e-10)


def test_a_prism_of_many_sides_keeps_eight_far_points() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    ring = np.stack([0.2 * np.cos(angle), 0.2 * np.sin(angle), np.full(24, 0.05)], axis=1)
    points, _, _ = points_of(ConvexHull(np.vstack([ring, ring * [1, 1, -1]])), 0.05)
    assert len(points) == 8
    np.testing.assert_allclose(np.linalg.norm(points[:, :2], axis=1), 0.2, atol=1e-12)
    assert np.abs(points[:, :2].mean(axis=0)).max() < 0.02


def test_crossed_edges_touch_in_one_point() -> None:
    half = np.pi / 8.0
    c, s = np.cos(half), np.sin(half)
    low = thing("low", Box((1.0, 0.2, 0.2)), (0.0, 0.0, 0.0), orientation=(c, s, 0.0, 0.0))
    high = thing("high", Box((0.2, 1.0, 0.2)), (0.03, 0.04, 0.2 * np.sqrt(2.0) + 1e-8), orientation=(c, 0.0, s, 0.0))
    world = World([low, high])
    vertices, shapes, found = world.poses.vertices, world.geometry.shapes, make_manifold()
    _, gap, n, on_a, on_b = signed_distance(vertices, shapes, 0, 1, (0.0, 0.0, 0.0), make_scratch())
    count, _ = manifold(vertices, shapes, 0, 1, n, on_a, on_b, gap, 1e-6, found)
    assert count == 1
    np.testing.assert_allclose(found.on_a[0], [0.03, 0.0, 0.1 * np.sqrt(2.0)], atol=1e-9)
