"""Distances of points, segments and triangles in closed form, broadcast over leading axes. Plain, not fast."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.spatial import rotation

Array = NDArray[np.float64]

NEARLY_PARALLEL = 1e-12
"""Squared sine of the angle below which two segments count as parallel. There the crossing point of their lines has no
digits left; the ends, which are always tried too, are as near to within 1e-6 of the offset between the lines."""


def _dot(a: Array, b: Array) -> Array:
    return np.asarray((a * b).sum(axis=-1))


def _share(numerator: Array, denominator: Array) -> Array:
    """Return numerator / denominator clamped to [0, 1]; 0 where the denominator vanishes."""
    safe = np.where(denominator > 0.0, denominator, 1.0)
    return np.clip(np.where(denominator > 0.0, numerator / safe, 0.0), 0.0, 1.0)


def point_segment_distance(point: Array, start: Array, end: Array) -> Array:
    """Return the distance [m] of points (..., 3) from segments; a segment may be a point."""
    along = end - start
    share = _share(_dot(point - start, along), _dot(along, along))
    return np.asarray(np.linalg.norm(point - start - share[..., None] * along, axis=-1))


def segment_distance(start_a: Array, end_a: Array, start_b: Array, end_b: Array) -> Array:
    """Return the distance [m] of two segments (..., 3): the least of the four ends and the two inner points, if there are any."""
    nearest = np.minimum(
        np.minimum(point_segment_distance(start_a, start_b, end_b), point_segment_distance(end_a, start_b, end_b)),
        np.minimum(point_segment_distance(start_b, start_a, end_a), point_segment_distance(end_b, start_a, end_a)),
    )
    u, v, w = end_a - start_a, end_b - start_b, start_a - start_b
    uu, vv, uv, uw, vw = _dot(u, u), _dot(v, v), _dot(u, v), _dot(u, w), _dot(v, w)
    across = uu * vv - uv * uv
    crossing = across > NEARLY_PARALLEL * uu * vv
    s = _share(np.where(crossing, uv * vw - vv * uw, 0.0), across)
    t = _share(uv * s + vw, vv)
    s = _share(uv * t - uw, uu)
    inner = np.linalg.norm(w + s[..., None] * u - t[..., None] * v, axis=-1)
    return np.asarray(np.minimum(nearest, inner))


def triangle_distance(point: Array, a: Array, b: Array, c: Array) -> Array:
    """Return the distance [m] of points (..., 3) from triangles: their edges, or their plane where the foot falls inside."""
    edges = np.minimum(
        np.minimum(point_segment_distance(point, a, b), point_segment_distance(point, b, c)),
        point_segment_distance(point, c, a),
    )
    normal = rotation.cross(b - a, c - a)
    inside = np.ones(np.broadcast_shapes(edges.shape), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= _dot(rotation.cross(end - start, point - start), normal) > 0.0
    length = np.linalg.norm(normal, axis=-1)
    height = np.abs(_dot(point - a, normal)) / np.where(length > 0.0, length, 1.0)
    return np.asarray(np.where(inside, height, edges))
