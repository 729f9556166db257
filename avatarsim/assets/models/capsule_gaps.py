"""Gaps between links made of capsules: closest points of two segments (Ericson, *Real-Time Collision Detection*, 2005, 5.1.9)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.avatar import Link
from avatarsim.scene.shape import Capsule, Sphere
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

TINY = 1e-18
"""Square of a length [m^2] below which a segment is a point: below it the place of the nearest point along it means nothing."""


def link_gaps(links: Sequence[Link], positions: Array, orientations: Array) -> Array:
    """Gaps (links, links) [m] between links at `positions` (links, 3) [m] and `orientations` (links, 4); negative where they
    overlap, infinite for a link with itself or without pieces. All pieces are capsules and spheres."""
    owner, starts, ends, radii = _segments(links, positions, orientations)
    first, second = np.triu_indices(len(owner), 1)
    apart = segment_distances(starts[first], ends[first], starts[second], ends[second]) - radii[first] - radii[second]
    found = np.full((len(links), len(links)), np.inf)
    np.minimum.at(found, (owner[first], owner[second]), apart)
    np.minimum.at(found, (owner[second], owner[first]), apart)
    np.fill_diagonal(found, np.inf)
    return found


def _segments(links: Sequence[Link], positions: Array, orientations: Array) -> tuple[NDArray[np.int64], Array, Array, Array]:
    """Of every piece: the link that has it, both ends of its segment in the world (n, 3) [m], and its radius [m]."""
    owner, starts, ends, radii = [], [], [], []
    for k, link in enumerate(links):
        for piece in link.pieces:
            assert isinstance(piece.shape, Capsule | Sphere)
            half = 0.5 * piece.shape.length if isinstance(piece.shape, Capsule) else 0.0
            along = rotation.rotate(piece.orientation, (0.0, 0.0, half))
            owner.append(k)
            starts.append(positions[k] + rotation.rotate(orientations[k], np.array(piece.position) - along))
            ends.append(positions[k] + rotation.rotate(orientations[k], np.array(piece.position) + along))
            radii.append(piece.shape.radius)
    places = np.array(starts, dtype=np.float64).reshape(-1, 3), np.array(ends, dtype=np.float64).reshape(-1, 3)
    return np.array(owner, dtype=np.int64), *places, np.array(radii, dtype=np.float64)


def segment_distances(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Distances (n,) [m] between the segments from a to b and from c to d, each (n, 3) [m]."""
    u, v, w = b - a, d - c, a - c
    uu, vv, uv = _dot(u, u), _dot(v, v), _dot(u, v)
    uw, vw = _dot(u, w), _dot(v, w)
    slope = uu * vv - uv * uv
    s = np.where(slope > TINY, np.clip((uv * vw - uw * vv) / np.where(slope > TINY, slope, 1.0), 0.0, 1.0), 0.0)
    t = np.where(vv > TINY, (uv * s + vw) / np.where(vv > TINY, vv, 1.0), 0.0)
    t = np.clip(t, 0.0, 1.0)
    s = np.where(uu > TINY, np.clip((uv * t - uw) / np.where(uu > TINY, uu, 1.0), 0.0, 1.0), 0.0)
    return np.asarray(np.linalg.norm(w + s[:, None] * u - t[:, None] * v, axis=1))


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("ij,ij->i", a, b))
