"""Vertices, boxes and centres of every kind of shape, by brute force; the compact pair filter against a matrix."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.model.geometry import ELLIPSOID, OPEN, POINTS, geometry, may_meet, pair_filter, piece_points, place, poses
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.spatial import rotation

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
RNG = np.random.default_rng(4)
SHAPES: list[Shape] = [
    Sphere(0.2), Capsule(0.1, 0.5), Box((0.2, 0.3, 0.6)), Ellipsoid((0.1, 0.2, 0.4)), ConvexHull(RNG.normal(size=(12, 3))),
]
WXYZ = (0.5, -0.1, 0.7, np.sqrt(1 - 0.25 - 0.01 - 0.49))


def surface(shape: Shape, count: int = 4000) -> np.ndarray:
    """Return many points of the shape's surface in its own frame, the extreme ones of a polytope included."""
    rng = np.random.default_rng(0)
    ball = rng.normal(size=(count, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    if isinstance(shape, Sphere):
        return ball * shape.radius
    if isinstance(shape, Capsule):
        return ball * shape.radius + np.array([0.0, 0.0, 0.5 * shape.length]) * np.sign(ball[:, 2:])
    if isinstance(shape, Ellipsoid):
        return ball * shape.radii
    if isinstance(shape, Box):
        return 0.5 * np.array(shape.size) * np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    return shape.vertices


def scene(*shapes: Shape) -> Scene:
    """Return a fixed and a simulated body of all shapes, and a driven one; every piece turned its own way."""
    pieces = tuple(Piece(shape, (0.1 * k, -0.2, 0.3), WXYZ) for k, shape in enumerate(shapes))
    return Scene(
        "s",
        (fixed("fixed", pieces, "wood"), simulated("simulated", pieces, "wood", solid(pieces, 2.0), (1.0, 2.0, 3.0), WXYZ)),
        (rigid_avatar("driven", pieces, solid(pieces, 2.0)),),
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_points_and_radius_describe_the_shape(shape: Shape) -> None:
    """The support function of the arrays is that of a thousand surface points, in any direction."""
    kind, points, radius = piece_points(Piece(shape, (0.3, 0.2, -0.1), WXYZ))
    cloud = rotation.rotate(np.array(WXYZ), surface(shape)) + [0.3, 0.2, -0.1]
    for d in Rotation.random(20, rng=1).apply([0.0, 0.0, 1.0]):
        if kind == ELLIPSOID:
            reach = points[0] @ d + np.linalg.norm(points[1:] @ d)
        else:
            reach = (points @ d).max() + radius
        most = (cloud @ d).max()
        assert most - 1e-12 <= reach <= most + 0.01


def test_arrays_tell_which_piece_belongs_to_whom() -> None:
    geo = geometry(scene(*SHAPES))
    assert geo.first_shape.tolist() == [0, 5, 10, 15] and geo.body.tolist() == [0] * 5 + [1] * 5 + [2] * 5
    assert geo.shapes.kind[:-1].tolist() == [POINTS, POINTS, POINTS, ELLIPSOID, POINTS] * 3
    assert np.diff(geo.shapes.start)[:5].tolist() == [1, 2, 8, 4, 12]
    assert geo.shapes.radius[:5].tolist() == [0.2, 0.1, 0.0, 0.0, 0.0]
    wanted = [[a != b and may_meet(geo.wanted, a, b) for b in range(3)] for a in range(3)]
    assert wanted == scene(*SHAPES).pair_filter.tolist()


@pytest.mark.parametrize("shape", SHAPES)
def test_sizes_are_no_smaller_than_half_the_extent(shape: Shape) -> None:
    """Tolerances are relative to `size`: it must have the order of magnitude of the largest extent."""
    found = geometry(scene(shape)).shapes.extent[0]
    extent = np.ptp(surface(shape), axis=0).max()
    assert 0.5 * extent <= found <= 2.0 * extent


@pytest.mark.parametrize("seed", range(4))
def test_placed_bodies_have_their_boxes_where_they_belong(seed: int) -> None:
    world = scene(*SHAPES)
    geo = geometry(world)
    rng = np.random.default_rng(seed)
    position, orientation = rng.normal(size=(3, 3)), rotation.normalised(rng.normal(size=(3, 4)))
    placed = poses(geo, position, orientation)
    for b in range(3):
        centre = solid(world.bodies[1].pieces, 2.0).centre if b == 1 else np.zeros(3)
        hull = []
        for k, shape in enumerate(SHAPES):
            s = 5 * b + k
            cloud = rotation.rotate(np.array(WXYZ), surface(shape)) + [0.1 * k, -0.2, 0.3] - centre
            cloud = rotation.rotate(orientation[b], cloud) + position[b]
            low, high = placed.boxes[s, :3], placed.boxes[s, 3:]
            # contains every point of the surface, and no face of the box is far from one
            assert (cloud >= low - 1e-12).all() and (cloud <= high + 1e-12).all()
            assert np.abs(cloud.min(axis=0) - low).max() < 0.01 and np.abs(cloud.max(axis=0) - high).max() < 0.01
            if isinstance(shape, Box | ConvexHull):
                assert cloud.min(axis=0) == pytest.approx(low, abs=1e-12) and cloud.max(axis=0) == pytest.approx(high, abs=1e-12)
            hull.append(placed.boxes[s])
        assert placed.hulls[b, :3] == pytest.approx(np.min(hull, axis=0)[:3], abs=0.0)
        assert placed.hulls[b, 3:] == pytest.approx(np.max(hull, axis=0)[3:], abs=0.0)


def test_boxes_of_smooth_shapes_touch_exactly() -> None:
    geo = geometry(scene(Ellipsoid((0.1, 0.2, 0.4)), Sphere(0.2), Capsule(0.1, 0.5)))
    placed = poses(geo, np.zeros((3, 3)), np.tile(rotation.IDENTITY, (3, 1)))
    turn = rotation.to_matrix(WXYZ)
    middle = np.array([0.0, -0.2, 0.3])
    half = np.sqrt(((turn * [0.1, 0.2, 0.4]) ** 2).sum(axis=1))
    assert placed.boxes[0] == pytest.approx(np.concatenate([middle - half, middle + half]), abs=1e-14)
    half = np.abs(turn[:, 2]) * 0.25 + 0.1
    middle = np.array([0.2, -0.2, 0.3])
    assert placed.boxes[2] == pytest.approx(np.concatenate([middle - half, middle + half]), abs=1e-14)


def test_placing_one_body_leaves_the_others_alone() -> None:
    geo = geometry(scene(*SHAPES))
    placed = poses(geo, np.zeros((3, 3)), np.tile(rotation.IDENTITY, (3, 1)))
    before = [array.copy() for array in placed]
    placed.position[1] += 1.0
    place(geo, placed, 1)
    rows = slice(geo.shapes.start[5], geo.shapes.start[10])
    assert (placed.boxes[5:10, :3] == pytest.approx(before[3][5:10, :3] + 1.0))
    for array, old in ((placed.vertices, before[2]), (placed.boxes, before[3])):
        changed = np.flatnonzero((array != old).any(axis=1))
        inside = (rows.start, rows.stop) if len(array) == len(placed.vertices) else (5, 10)
        assert changed.min() >= inside[0] and changed.max() < inside[1]


def test_a_nan_in_a_pose_reaches_every_vertex() -> None:
    geo = geometry(scene(Box((1.0, 1.0, 1.0))))
    placed = poses(geo, np.zeros((3, 3)), np.tile(rotation.IDENTITY, (3, 1)))
    placed.position[2, 1] = np.nan
    place(geo, placed, 2)
    assert np.isnan(placed.vertices[16:, 1]).all() and not np.isnan(placed.vertices[:16]).any()


@given(st.integers(0, 10**6), st.integers(2, 30))
@settings(deadline=None, max_examples=50)
def test_says_what_a_matrix_says(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    family = rng.integers(-1, 3, count)
    skipped = [(int(a), int(b)) for a, b in rng.integers(0, count, (2 * count, 2)) if a != b]
    matrix = (family[:, None] != family) | (family == OPEN)
    for a, b in skipped:
        matrix[a, b] = matrix[b, a] = False
    wanted = pair_filter(family, skipped)
    for a in range(count):
        for b in range(count):
            assert a == b or may_meet(wanted, a, b) == matrix[a, b]


def test_memory_is_linear() -> None:
    wanted = pair_filter([OPEN] * 20000, [(k, k + 1) for k in range(19999)])
    assert sum(array.nbytes for array in wanted) == 8 * (20000 + 20001 + 19999)
    assert not may_meet(wanted, 500, 499) and may_meet(wanted, 500, 498)


def test_the_box_of_a_body_without_pieces_is_its_place() -> None:
    pieces = (Piece(Sphere(0.1)),)
    lone = Scene("s", avatars=(rigid_avatar("ghost", (), solid(pieces, 1.0)),))
    geo = geometry(lone)
    placed = poses(geo, np.array([[1.0, 2.0, 3.0]]), np.array([rotation.IDENTITY]))
    assert geo.local.shape == (0, 3) and placed.hulls[0].tolist() == [1.0, 2.0, 3.0, 1.0, 2.0, 3.0]
