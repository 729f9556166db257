"""Surfaces of convex pieces for drawing: triangles of balls, capsules, boxes, ellipsoids and hulls, few enough for a browser."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull as Hull
from scipy.spatial import QhullError

from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

AROUND, RINGS = 12, 6
"""Corners of a ring of a round piece, and rings from pole to pole. More: a body of twenty capsules takes a browser too long."""
CORNERS = 64
"""Corners of a hull that are drawn, those farthest in as many directions."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles (t, 3) of vertices (n, 3) [m] in the frame of a body, their normals outwards."""

    vertices: Array
    triangles: NDArray[np.int64]


def surface_of(pieces: Sequence[Piece], most: int = CORNERS) -> Surface:
    """The surface of a body or link, piece after piece, hulls by `most` corners."""
    vertices: list[Array] = [np.zeros((0, 3))]
    triangles: list[NDArray[np.int64]] = [np.zeros((0, 3), dtype=np.int64)]
    first = 0
    for piece in pieces:
        points = corners(piece.shape, most)
        found = _hull(points)
        if found is None:
            continue
        vertices.append(rotation.rotate(np.array(piece.orientation), found.vertices) + np.array(piece.position))
        triangles.append(found.triangles + first)
        first += len(found.vertices)
    return Surface(np.concatenate(vertices), np.concatenate(triangles))


def corners(shape: Shape, most: int = CORNERS) -> Array:
    """Points (n, 3) whose hull is drawn for a shape; of a hull about `most`."""
    if isinstance(shape, Box):
        return np.asarray(0.5 * np.array(shape.size) * _signs())
    if isinstance(shape, Sphere):
        return np.asarray(shape.radius * _ball(RINGS))
    if isinstance(shape, Ellipsoid):
        return np.asarray(np.array(shape.radii) * _ball(RINGS))
    if isinstance(shape, Capsule):
        ball = shape.radius * _ball(RINGS)
        half = np.array([0.0, 0.0, 0.5 * shape.length])
        return np.concatenate([ball[ball[:, 2] >= -1e-12] + half, ball[ball[:, 2] <= 1e-12] - half])
    assert isinstance(shape, ConvexHull)
    points: Array = np.asarray(shape.vertices)
    if len(points) <= most:
        return points
    farthest = np.unique(np.argmax(points @ _directions(most).T, axis=0))
    return np.asarray(points[farthest])


def _signs() -> Array:
    return np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


def _ball(rings: int) -> Array:
    """Points of the unit sphere: both poles, and rings of equal latitude, one of them the equator."""
    found = [np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])]
    for k in range(1, rings):
        polar = np.pi * k / rings
        around = 2.0 * np.pi * np.arange(AROUND) / AROUND
        ring = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.full(AROUND, np.cos(polar))], axis=1)
        found.append(ring)
    return np.concatenate(found)


def _directions(count: int) -> Array:
    """Unit vectors spread evenly over the sphere: the spiral of the golden angle (Vogel 1979)."""
    k = np.arange(count) + 0.5
    height, turn = 1.0 - 2.0 * k / count, np.pi * (1.0 + 5.0**0.5) * k
    across = np.sqrt(1.0 - height**2)
    return np.stack([across * np.cos(turn), across * np.sin(turn), height], axis=1)


def _hull(points: Array) -> Surface | None:
    """The hull of points with its triangles turned outwards; None of points in a plane."""
    try:
        found = Hull(points)
    except QhullError:
        return None
    used = np.unique(found.simplices)
    place = np.full(len(points), -1)
    place[used] = np.arange(len(used))
    triangles = place[found.simplices]
    vertices = points[used]
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), found.equations[:, :3]) < 0.0
    triangles[inwards] = triangles[inwards][:, [0, 2, 1]]
    return Surface(vertices, triangles)
