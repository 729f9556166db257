"""Surfaces of shapes as triangles, for the eye: subdivided icosahedra, and hulls by Quickhull (Barber et al. 1996)."""

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull as Quickhull

from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

ROUND = 2
"""How often the faces of an icosahedron are cut in four for a ball: 162 vertices; twice as many are no rounder to an eye."""
CORNERS: Array = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
"""Corners of a box of edge 1."""


@cache
def ball() -> Array:
    """Points (n, 3) on the unit sphere."""
    golden = 0.5 * (1.0 + 5.0**0.5)
    points = np.array([
        turned for y in (-1.0, 1.0) for z in (-golden, golden) for turned in ((0.0, y, z), (y, z, 0.0), (z, 0.0, y))
    ])
    for _ in range(ROUND):
        faces = Quickhull(points).simplices
        middles = np.concatenate([points[faces[:, a]] + points[faces[:, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
        points = np.unique(np.concatenate([points, middles]).round(12), axis=0)
        points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points


def points_of(shape: Shape) -> Array:
    """Points (n, 3) [m] whose convex hull stands for a shape."""
    match shape:
        case Sphere(radius):
            return radius * ball()
        case Ellipsoid(radii):
            return np.asarray(radii, dtype=np.float64) * ball()
        case Box(size):
            return np.asarray(size, dtype=np.float64) * CORNERS
        case Capsule(radius, length):
            ends: list[Array] = [radius * ball() + (0.0, 0.0, end * length) for end in (-0.5, 0.5)]
            return np.concatenate(ends)
        case ConvexHull(vertices):
            return np.asarray(vertices)


def surface(pieces: Sequence[Piece]) -> tuple[Array, Faces]:
    """Vertices (v, 3) [m] in the body's frame and triangles (f, 3), whose fronts look outwards, of all pieces of a body."""
    vertices, faces, count = list[Array](), list[Faces](), 0
    for piece in pieces:
        points = points_of(piece.shape)
        hull = Quickhull(points)
        triangles = hull.simplices.astype(np.int64)
        a, b, c = (points[triangles[:, k]] for k in range(3))
        inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
        triangles[inwards] = triangles[inwards][:, ::-1]
        if isinstance(piece.shape, Box | ConvexHull):
            # corners of their own for each triangle: a renderer rounds off what shares its corners
            points, triangles = points[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
        vertices.append(rotation.rotate(np.tile(piece.orientation, (len(points), 1)), points) + np.asarray(piece.position))
        faces.append(triangles + count)
        count += len(points)
    return np.concatenate(vertices), np.concatenate(faces)
