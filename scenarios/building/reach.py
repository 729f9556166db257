"""Reach of an avatar's shapes in a direction, for putting obstacles in its way. Plain and slow."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.spatial import rotation

Array = NDArray[np.float64]


def reach(avatars: tuple[Avatar, ...], samples: Iterable[TrackerSample], direction: ArrayLike) -> Array:
    """Return the largest coordinate [m] of any point of the avatars along the unit `direction`, per sample."""
    d = np.asarray(direction, dtype=np.float64)
    pieces = [(k, piece) for k, link in enumerate(link for a in avatars for link in a.links) for piece in link.pieces]
    distances = []
    for sample in samples:
        positions, orientations = link_poses(avatars, sample)
        distances.append(max(_piece_reach(piece, positions[k], orientations[k], d) for k, piece in pieces))
    return np.array(distances)


def _piece_reach(piece: Piece, position: Array, orientation: Array, d: Array) -> float:
    centre = position + rotation.rotate(orientation, piece.position)
    local = rotation.rotate(rotation.conjugate(rotation.multiply(orientation, piece.orientation)), d)
    return float(centre @ d) + extent(piece.shape, local)


def extent(shape: Shape, d: Array) -> float:
    """Return the support function of one shape: its largest coordinate [m] along the unit vector `d`, in its own frame."""
    if isinstance(shape, Capsule):
        return shape.radius + 0.5 * shape.length * abs(float(d[2]))
    if isinstance(shape, Box):
        return 0.5 * float(np.abs(d) @ np.array(shape.size))
    if isinstance(shape, Ellipsoid):
        return float(np.linalg.norm(d * np.array(shape.radii)))
    if isinstance(shape, ConvexHull):
        return float((shape.vertices @ d).max())
    return shape.radius
