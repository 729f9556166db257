"""Shapes: each refuses to exist without a volume, and says why."""

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull as QuickHull

from avatarsim.errors import InvalidShape
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere, ellipsoid_hull

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
BAD = [0.0, -0.1, math.nan, math.inf, 1e-200, 1e9]


@pytest.mark.parametrize("value", BAD)
@pytest.mark.parametrize(
    ("make", "thing"),
    [
        (lambda v: Sphere(v), "sphere radius"),
        (lambda v: Capsule(v, 1.0), "capsule radius"),
        (lambda v: Capsule(1.0, v), "capsule length"),
        (lambda v: Box((1.0, v, 1.0)), "box size"),
        (lambda v: Ellipsoid((1.0, 1.0, v)), "ellipsoid radi"),
    ],
)
def test_sizes_must_be_finite_and_positive(make: object, thing: str, value: float) -> None:
    with pytest.raises(InvalidShape) as error:
        make(value)
    assert thing in str(error.value) and str(value) in str(error.value) and "finite number" in str(error.value)


@pytest.mark.parametrize("scale", [1e-200, 1e-7, 1e8, 1e200])
def test_a_hull_too_small_or_too_large_to_have_a_volume_is_refused(scale: float) -> None:
    with pytest.raises(InvalidShape, match="extent of the hull.*1e-06 to 1e[+]07"):
        ConvexHull(CUBE * scale)


def test_a_box_names_the_axis_at_fault() -> None:
    with pytest.raises(InvalidShape, match="along y"):
        Box((1.0, 0.0, 1.0))


@pytest.mark.parametrize(
    "vertices",
    [CUBE * [1, 1, 0], CUBE * [1, 0, 0], CUBE * 0, CUBE * [1, 1, 1e-12], CUBE @ np.array([[1, 0, 1], [0, 1, 1], [0, 0, 0]])],
)
def test_flat_hulls_are_refused_however_they_lie(vertices: np.ndarray) -> None:
    with pytest.raises(InvalidShape, match="thickness of the hull .* flat"):
        ConvexHull(vertices)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_thin_hulls_with_a_volume_are_kept_at_any_scale(scale: float) -> None:
    assert len(ConvexHull(CUBE * [1, 1, 1e-6] * scale).vertices) == 8


@pytest.mark.parametrize(
    ("vertices", "part"), [(CUBE[:3], "number of hull vertices is 3"), (CUBE[:, :2], "(8, 2)"), ([[math.nan] * 3] * 4, "finite")]
)
def test_hull_vertices_must_be_at_least_four_finite_points(vertices: object, part: str) -> None:
    with pytest.raises(InvalidShape) as error:
        ConvexHull(vertices)
    assert part in str(error.value)


def test_a_hull_keeps_its_own_read_only_copy() -> None:
    given = CUBE.copy()
    hull = ConvexHull(given)
    given[:] = 9.0
    assert (hull.vertices == CUBE).all() and not hull.vertices.flags.writeable


@pytest.mark.parametrize("count", [4, 12, 52])
def test_an_ellipsoid_hull_is_convex_and_lies_on_the_ellipsoid(count: int) -> None:
    radii = np.array([0.3, 0.2, 0.1])
    vertices = ellipsoid_hull((0.3, 0.2, 0.1), count).vertices
    assert np.linalg.norm(vertices / radii, axis=1) == pytest.approx(np.ones(count))
    assert len(QuickHull(vertices).vertices) == count
    assert len(QuickHull(vertices).simplices) == 2 * count - 4


def test_an_ellipsoid_hull_needs_four_vertices() -> None:
    with pytest.raises(InvalidShape, match="is 3; valid: a whole number from 4 to "):
        ellipsoid_hull((1.0, 1.0, 1.0), 3)


def test_pieces_check_their_place() -> None:
    with pytest.raises(InvalidShape, match="piece position"):
        Piece(Sphere(1.0), (0.0, math.inf, 0.0))
    with pytest.raises(InvalidShape, match="piece orientation is .*2.0.* length 1"):
        Piece(Sphere(1.0), orientation=(2.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize("radii", [0.1, (0.1, 0.1), (0.1, 0.1, 0.1, 0.1), (0.1, "a", 0.1), [{}, {}, []], None, (0.1, -1.0, 0.1)])
def test_the_hull_of_an_ellipsoid_takes_the_radii_that_one_has(radii: object) -> None:
    with pytest.raises(InvalidShape, match="ellipsoid radi"):
        ellipsoid_hull(radii)  # type: ignore[arg-type]
