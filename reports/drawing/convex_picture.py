"""Orthographic projection of convex pieces: outlines and faces in a plane, and the order in which they cover each other."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from avatarsim.spatial import rotation
from reports.drawing import mesh
from reports.drawing.mesh import Array, Indices

TOUCHING = 0.01
"""Depth, as a share of the picture's height, up to which two pieces that touch still count as separated by a face."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A convex piece in the world: corners (v, 3); corners and outward normals (f, 3) of its flat faces, none of a round one."""

    corners: Array
    faces: Sequence[Indices]
    normals: Array

    def outline(self, axes: Array) -> Array:
        """Return the corners (k, 2) of its outline along ``axes`` (2, 3), in order."""
        return flat_hull(self.corners @ axes.T)


def flat_hull(points: Array) -> Array:
    """Return the corners (k, 2) of the hull of points (n, 2), counter-clockwise; the points where they span no area."""
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points


def placed(piece: Mapping[str, Any], position: Array, orientation: Array) -> Piece:
    """Return a piece of a scene's file on a body at ``position`` (3,) with ``orientation`` (4,)."""
    own, faces, normals = mesh.corners(piece), list[Indices](), np.zeros((0, 3))
    if not mesh.is_round(piece):
        triangles, equations = mesh.hull(own)
        # triangles of one plane are one face
        planes, which = np.unique(np.round(equations, 5) + 0.0, axis=0, return_inverse=True)
        faces = [np.unique(triangles[which == k]) for k in range(len(planes))]
        normals = rotation.rotate(orientation, planes[:, :3])
    return Piece(position + rotation.rotate(orientation, own), faces, normals)


def order(pieces: Sequence[Piece], outlines: Sequence[Array], towards: Array, size: float) -> list[int]:
    """Return the painter's order, covered pieces first.

    Two pieces that a face of one separates have an order; of others the one with the nearer middle covers.

    Args:
        pieces: of the picture.
        outlines: of the pieces.
        towards: direction (3,) to the eye.
        size: height [m] of the picture.
    """
    low, high = (np.array([getattr(outline, end)(axis=0) for outline in outlines]) for end in ("min", "max"))
    height = [float(piece.corners.mean(axis=0) @ towards) for piece in pieces]
    meets = (low[:, None] < high).all(axis=2)
    covers = [set[int]() for _ in pieces]
    for first, second in np.argwhere(np.triu(meets & meets.T, 1)).tolist():
        nearer = _nearer(pieces, first, second, towards, TOUCHING * size)
        if nearer is not None:
            covers[nearer].add(first + second - nearer)
    left, drawn = set(range(len(pieces))), list[int]()
    while left:
        # pieces that cover each other in a ring have no order: the farthest is drawn first
        drawn.append(min([k for k in left if not covers[k] & left] or left, key=height.__getitem__))
        left.remove(drawn[-1])
    return drawn


def _nearer(pieces: Sequence[Piece], first: int, second: int, towards: Array, slack: float) -> int | None:
    """Return which of two pieces covers the other; None where no face separates them, or faces do so in both ways."""
    found = set()
    for own, other in ((first, second), (second, first)):
        normals = pieces[own].normals
        apart = (pieces[other].corners @ normals.T).min(axis=0) - (pieces[own].corners @ normals.T).max(axis=0) >= -slack
        slopes = normals @ towards
        found |= {other if slope > 0.0 else own for slope in slopes[apart & (np.abs(slopes) > 1e-6)]}
    return found.pop() if len(found) == 1 else None
