"""Convex shapes and their places on a body. Every shape has a volume or refuses to exist."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidShape
from avatarsim.scene.checks import SHORTEST, Quaternion, Vector, finite_array, instance, length, place, unit_quaternion, vector
from avatarsim.spatial import rotation

FLATTEST_HULL = 1e-9
"""Smallest thickness of a hull relative to its largest extent. Thinner hulls have no reliable face normals
and no volume; they are refused as flat."""


@dataclass(frozen=True)
class Sphere:
    """Ball of `radius` [m] about the origin. Raises InvalidShape for a radius that is no length."""

    radius: float

    def __post_init__(self) -> None:
        length("sphere radius", self.radius, InvalidShape)


@dataclass(frozen=True)
class Capsule:
    """Segment of `length` [m] along z, centred on the origin, swept by a ball of `radius` [m]; InvalidShape for others."""

    radius: float
    length: float

    def __post_init__(self) -> None:
        length("capsule radius", self.radius, InvalidShape)
        length("capsule length", self.length, InvalidShape)


@dataclass(frozen=True)
class Box:
    """Box with edges of `size` (x, y, z) [m], full lengths, centred on the origin. Raises InvalidShape for others."""

    size: Vector

    def __post_init__(self) -> None:
        given: object = self.size
        size = vector("box size", self.size, InvalidShape)
        if not isinstance(given, tuple):
            # an iterator would be empty from here on, and a list could be changed
            object.__setattr__(self, "size", size)
        for axis, edge in zip("xyz", size, strict=True):
            length(f"box size along {axis}", edge, InvalidShape)


@dataclass(frozen=True)
class Ellipsoid:
    """Smooth ellipsoid with semi-axes `radii` (x, y, z) [m], about the origin. Raises InvalidShape for others."""

    radii: Vector

    def __post_init__(self) -> None:
        given: object = self.radii
        radii = vector("ellipsoid radii", self.radii, InvalidShape)
        if not isinstance(given, tuple):
            object.__setattr__(self, "radii", radii)
        for axis, radius in zip("xyz", radii, strict=True):
            length(f"ellipsoid radius along {axis}", radius, InvalidShape)


@dataclass(frozen=True, eq=False)
class ConvexHull:
    """Convex hull of `vertices` (n, 3) [m], n >= 4. Points inside the hull are harmless and cost time. Raises InvalidShape for
    points that are not finite, and for flat hulls, which have no volume."""

    vertices: NDArray[np.float64] = field(repr=False)

    def __post_init__(self) -> None:
        points = finite_array("hull vertices", self.vertices, (-1, 3), InvalidShape)
        if len(points) < 4:
            raise InvalidShape("number of hull vertices", len(points), "at least 4")
        centred = points - points.mean(axis=0)
        spread = np.linalg.svd(centred, compute_uv=False) / np.sqrt(len(points))
        if not spread[2] > FLATTEST_HULL * spread[0]:
            raise InvalidShape(
                "thickness of the hull relative to its extent", float(spread[2] / max(spread[0], 1e-300)),
                f"above {FLATTEST_HULL:g}: a flat hull has no volume",
            )
        length("extent of the hull", float(np.ptp(points, axis=0).max()), InvalidShape)
        points.flags.writeable = False
        object.__setattr__(self, "vertices", points)


Shape = Sphere | Capsule | Box | Ellipsoid | ConvexHull


@dataclass(frozen=True)
class Piece:
    """One convex `shape` at its place on a body or link: `position` [m] and `orientation` (w, x, y, z) in that one's frame.

    Pieces of one body may overlap. Raises InvalidShape for an invalid place."""

    shape: Shape
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = rotation.IDENTITY

    def __post_init__(self) -> None:
        instance("shape of a piece", self.shape, Shape, "a Sphere, Capsule, Box, Ellipsoid or ConvexHull", InvalidShape)
        object.__setattr__(self, "position", place("piece position", self.position, InvalidShape))
        object.__setattr__(self, "orientation", unit_quaternion("piece orientation", self.orientation, InvalidShape))


def capsule_between(start: Iterable[float], end: Iterable[float], radius: float) -> Piece:
    """Return the capsule of `radius` [m] about the segment from `start` to `end` (x, y, z) [m], in its body's frame.

    Its length is that of the segment: the round ends reach a radius beyond both points. Raises InvalidShape for invalid points,
    for two equal points, and for a radius that is no length."""
    a, b = (np.array(place(f"{name} of a capsule", point, InvalidShape)) for name, point in (("start", start), ("end", end)))
    distance = float(np.linalg.norm(b - a))
    if not distance >= SHORTEST:
        raise InvalidShape("distance from start to end of a capsule [m]", distance, f"at least {SHORTEST:g}; a Sphere has none")
    x, y, z = (float(v) for v in 0.5 * (a + b))
    w, i, j, k = (float(v) for v in rotation.between((0.0, 0.0, 1.0), (b - a) / distance))
    return Piece(Capsule(radius, distance), (x, y, z), (w, i, j, k))


def reach(piece: Piece) -> float:
    """Return a bound of the farthest distance [m] of the piece from the origin of its body, exact for spheres at the origin."""
    shape = piece.shape
    if isinstance(shape, Sphere):
        extent = shape.radius
    elif isinstance(shape, Capsule):
        extent = shape.radius + 0.5 * shape.length
    elif isinstance(shape, Box):
        extent = 0.5 * float(np.linalg.norm(shape.size))
    elif isinstance(shape, Ellipsoid):
        extent = max(shape.radii)
    else:
        extent = float(np.linalg.norm(shape.vertices, axis=1).max())
    return extent + float(np.linalg.norm(piece.position))


MOST_VERTICES = 4096
"""Vertices of the hull of an ellipsoid at most, as many as a piece of a mesh may have: it is off by 0.05 % of its size with them,
and support queries, which look at every vertex, take microseconds."""


def ellipsoid_hull(radii: Vector, vertices: int = 52) -> ConvexHull:
    """Return the hull of `vertices` points spread evenly (golden spiral) over an ellipsoid with semi-axes `radii` [m].

    n points in general position span 2 n - 4 triangles, so 52 give the paper's hundred per part of the hand.
    """
    if isinstance(vertices, bool) or not isinstance(vertices, (int, np.integer)) or not 4 <= vertices <= MOST_VERTICES:
        raise InvalidShape("number of vertices of an ellipsoid's hull", vertices, f"a whole number from 4 to {MOST_VERTICES}")
    k = np.arange(vertices) + 0.5
    height = 1.0 - 2.0 * k / vertices
    turn = np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - height * height)
    return ConvexHull(np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=-1) * np.array(Ellipsoid(radii).radii))
