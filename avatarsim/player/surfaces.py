"""Triangles of convex pieces for drawing; round pieces are polyhedra of a few hundred triangles."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull as Hull
from scipy.spatial import QhullError

from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Surface = tuple[Array, Indices]
"""Vertices (v, 3) [m] and triangles (t, 3), counter-clockwise from outside."""

RINGS, SECTORS = 10, 18
"""Fineness of round surfaces: twice as many look the same on a screen and make a page of 200 balls twice as large."""
CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def _ball() -> Array:
    """Return the corners (v, 3) of a ball of radius 1 with its axis along z."""
    height, turn = np.meshgrid(np.linspace(-0.5, 0.5, RINGS + 1)[1:-1] * np.pi, np.arange(SECTORS) * (2.0 * np.pi / SECTORS))
    rings = np.stack([np.cos(height) * np.cos(turn), np.cos(height) * np.sin(turn), np.sin(height)], axis=-1).reshape(-1, 3)
    return np.concatenate([rings, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])


BALL = _ball()


def is_round(shape: Shape) -> bool:
    """Return True if a shape has a curved surface."""
    return isinstance(shape, Sphere | Capsule | Ellipsoid)


def corners(piece: Piece, most: int | None = None) -> Array:
    """Return the points (n, 3) [m] whose hull is drawn for a piece, in the frame of its body; of a hull about ``most``."""
    own = _corners(piece.shape, most)
    return np.asarray(rotation.rotate(np.array(piece.orientation), own) + np.array(piece.position))


def _corners(shape: Shape, most: int | None) -> Array:
    match shape:
        case Box(size):
            return np.asarray(CUBE * np.array(size))
        case Sphere(radius):
            return np.asarray(radius * BALL)
        case Ellipsoid(radii):
            return np.asarray(np.array(radii) * BALL)
        case Capsule(radius, length):
            half = np.array([0.0, 0.0, 0.5 * length])
            return np.concatenate([radius * BALL[BALL[:, 2] > -1e-9] + half, radius * BALL[BALL[:, 2] < 1e-9] - half])
        case ConvexHull(vertices):
            if most is None or len(vertices) <= most:
                return np.asarray(vertices)
            return np.asarray(vertices[np.unique(np.argmax(vertices @ _directions(most).T, axis=0))])


def _directions(count: int) -> Array:
    """Return unit vectors spread evenly over the sphere: the spiral of the golden angle (Vogel 1979)."""
    k = np.arange(count) + 0.5
    height, turn = 1.0 - 2.0 * k / count, np.pi * (1.0 + 5.0**0.5) * k
    across = np.sqrt(1.0 - height**2)
    return np.stack([across * np.cos(turn), across * np.sin(turn), height], axis=1)


def hull(points: Array) -> tuple[Indices, Array]:
    """Return triangles (t, 3) and outward planes (t, 4) of the hull of points (v, 3); none of points in a plane."""
    try:
        found = Hull(points)
    except QhullError:
        return np.zeros((0, 3), dtype=np.int64), np.zeros((0, 4))
    a, b, c = (points[found.simplices[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), found.equations[:, :3]) < 0.0
    return np.where(inwards[:, None], found.simplices[:, ::-1], found.simplices).astype(np.int64), found.equations


def surface(parts: Sequence[Piece | Surface], most: int | None = None) -> Surface:
    """Return the surface of a body, hulls by ``most`` corners; flat faces share no corners, so that their edges are sharp."""
    vertices, triangles, count = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0
    for part in parts:
        points, found = part if isinstance(part, tuple) else _of_piece(part, most)
        vertices.append(points)
        triangles.append(found + count)
        count += len(points)
    return np.concatenate(vertices), np.concatenate(triangles)


def _of_piece(piece: Piece, most: int | None) -> Surface:
    points = corners(piece, most)
    found, _ = hull(points)
    if is_round(piece.shape):
        return points, found
    return points[found].reshape(-1, 3), np.arange(found.size).reshape(-1, 3)
