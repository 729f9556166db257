"""Mass, centre of mass and inertia of bodies; of solid convex pieces in closed form, of hulls by tetrahedra."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidScene
from avatarsim.scene.checks import Vector, each, finite_array, listed, place, positive
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.spatial import rotation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mass:
    """`mass` [kg], `centre` of mass in the body frame [m], `inertia` (3, 3) about it, body axes [kg m^2].

    Raises InvalidScene for an inertia that no solid has: not symmetric, or a moment above the sum of the others."""

    mass: float
    centre: Vector = (0.0, 0.0, 0.0)
    inertia: Array = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        positive("mass", self.mass)
        object.__setattr__(self, "centre", place("centre of mass", self.centre))
        inertia = finite_array("inertia", self.inertia, (3, 3))
        if not np.allclose(inertia, inertia.T, rtol=1e-9, atol=1e-12 * np.abs(inertia).max()):
            raise InvalidScene("inertia", inertia.tolist(), "a symmetric matrix")
        moments = np.linalg.eigvalsh(inertia)
        # a real solid obeys the triangle inequality; 1e-9 leaves room for rounding of thin rods
        if not (moments[0] > 0.0 and moments[0] + moments[1] >= moments[2] * (1.0 - 1e-9)):
            raise InvalidScene("principal moments of inertia", moments.tolist(), "positive, none above the sum of the others")
        inertia.flags.writeable = False
        object.__setattr__(self, "inertia", inertia)


def _moments(shape: Shape) -> tuple[float, Array, Array]:
    """Volume, centroid and covariance integral of x x^T about the centroid, of one shape in its own frame."""
    if isinstance(shape, ConvexHull):
        return _hull_moments(shape.vertices)
    if isinstance(shape, Sphere):
        volume, second = 4.0 / 3.0 * np.pi * shape.radius**3, np.full(3, shape.radius**2 / 5.0)
    elif isinstance(shape, Ellipsoid):
        radii = np.array(shape.radii)
        volume, second = 4.0 / 3.0 * np.pi * float(np.prod(radii)), radii**2 / 5.0
    elif isinstance(shape, Box):
        size = np.array(shape.size)
        volume, second = float(np.prod(size)), size**2 / 12.0
    else:
        volume, second = _capsule_moments(shape)
    return volume, np.zeros(3), volume * np.diag(second)


def _capsule_moments(shape: Capsule) -> tuple[float, Array]:
    r, length = shape.radius, shape.length
    cylinder, ball = np.pi * r * r * length, 4.0 / 3.0 * np.pi * r**3
    volume = cylinder + ball
    across = (cylinder * r * r / 4.0 + ball * r * r / 5.0) / volume
    # each half ball has its centroid 3 r / 8 beyond the end of the segment
    along = (cylinder * length**2 / 12.0 + ball * (r * r / 5.0 + length**2 / 4.0 + 3.0 * r * length / 8.0)) / volume
    return volume, np.array([across, across, along])


def _hull_moments(vertices: Array) -> tuple[float, Array, Array]:
    """Exact volume, centroid and covariance of a convex polytope, as a fan of tetrahedra from an inner point."""
    # qhull comes with scipy, which takes a fifth of a second to import: only scenes with hulls pay for it
    from scipy.spatial import ConvexHull as QuickHull

    inner = vertices.mean(axis=0)
    corners = (vertices - inner)[QuickHull(vertices).simplices]
    volumes = np.abs(np.linalg.det(corners)) / 6.0
    volume = float(volumes.sum())
    sums = corners.sum(axis=1)
    centroid = (volumes[:, None] * sums / 4.0).sum(axis=0) / volume
    # covariance of a tetrahedron (0, a, b, c): V/20 (sum p p^T + s s^T), s = a + b + c
    products = np.einsum("tki,tkj->tij", corners, corners) + np.einsum("ti,tj->tij", sums, sums)
    about_inner = (volumes[:, None, None] * products / 20.0).sum(axis=0)
    return volume, centroid + inner, about_inner - volume * np.outer(centroid, centroid)


def volume(shape: Shape) -> float:
    """Volume [m^3] of one shape."""
    if not isinstance(shape, Shape):
        raise InvalidScene("shape whose volume is asked for", shape, "a Sphere, Capsule, Box, Ellipsoid or ConvexHull")
    return _moments(shape)[0]


def solid(pieces: Sequence[Piece], mass: float) -> Mass:
    """Mass properties of a body of total `mass` [kg], spread evenly over its `pieces` (overlaps count twice).

    Closed forms of the shapes; of hulls, sums over tetrahedra. Raises InvalidScene for no pieces, or a mass that is none."""
    positive("mass", mass)
    given = tuple(listed(pieces))
    each("pieces of a solid", given, Piece, "a Piece(shape)")
    if not given:
        raise InvalidScene("number of pieces of a solid", 0, "at least 1")
    volumes, centres, covariances = [], [], []
    for piece in pieces:
        v, c, s = _moments(piece.shape)
        turn = rotation.to_matrix(piece.orientation)
        volumes.append(v)
        centres.append(turn @ c + np.array(piece.position))
        covariances.append(turn @ s @ turn.T)
    total = sum(volumes)
    centre = sum((v * c for v, c in zip(volumes, centres, strict=True)), np.zeros(3)) / total
    covariance = np.zeros((3, 3))
    for v, c, s in zip(volumes, centres, covariances, strict=True):
        covariance += s + v * np.outer(c - centre, c - centre)
    covariance *= mass / total
    x, y, z = (float(value) for value in centre)
    return Mass(mass, (x, y, z), np.trace(covariance) * np.eye(3) - covariance)
