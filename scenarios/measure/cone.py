"""How far a direction is outside a reach cone: a spherical polygon seen from a point inside it."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import ReachCone
from avatarsim.spatial.rotation import cross

Array = NDArray[np.float64]

NO_ARC = 1e-12
"""Length [rad] below which an edge is a point: no plane through the origin holds it and nothing else."""


def _inside(cone: ReachCone, direction: Array) -> bool:
    """Whether `direction` is in one of the spherical triangles (visible point, edge), which together are the polygon."""
    seen, starts = np.array(cone.visible_point), cone.vertices
    ends = np.roll(starts, -1, axis=0)
    # three planes through the origin bound each triangle; counter-clockwise edges have the inside on their left
    first = np.cross(seen, starts) @ direction >= 0.0
    edge = np.cross(starts, ends) @ direction >= 0.0
    second = np.cross(ends, seen) @ direction >= 0.0
    return bool((first & edge & second).any())


def _angle_to_edge(start: Array, end: Array, direction: Array) -> float:
    """Angle [rad] from `direction` to the nearest point of the great arc from start to end."""
    normal = np.cross(start, end)
    length = float(np.linalg.norm(normal))
    if length > NO_ARC:
        normal /= length
        # within the lune of the arc the nearest point is the foot on its great circle, else one of its ends
        if np.cross(normal, start) @ direction >= 0.0 and np.cross(end, normal) @ direction >= 0.0:
            across = float(normal @ direction)
            return abs(float(np.arctan2(across, np.linalg.norm(direction - across * normal))))
    ends = (start, end)
    return min(float(np.arctan2(np.linalg.norm(np.cross(p, direction)), p @ direction)) for p in ends)


def beyond_cone(cone: ReachCone, direction: Array) -> float:
    """Angle [rad] from the unit `direction` (3,), in the parent's frame, to the cone; 0 inside; nan for nan."""
    if not np.isfinite(direction).all():
        return float("nan")
    if _inside(cone, direction):
        return 0.0
    ends = np.roll(cone.vertices, -1, axis=0)
    return min(_angle_to_edge(a, b, direction) for a, b in zip(cone.vertices, ends, strict=True))


def beyond_cone_each(cone: ReachCone, directions: Array) -> Array:
    """(F,) the same for many directions (F, 3) at once; `beyond_cone` is its plain twin."""
    sound = np.asarray(np.isfinite(directions).all(axis=1))
    limbs = np.where(sound[:, None], directions, 0.0)
    seen, starts = np.array(cone.visible_point), cone.vertices
    ends = np.roll(starts, -1, axis=0)
    first, edge, second = (cross(a, b) @ limbs.T >= 0.0 for a, b in ((seen, starts), (starts, ends), (ends, seen)))
    outside = ~(first & edge & second).any(axis=0)
    beyond = np.zeros(len(limbs))
    if outside.any():
        beyond[outside] = _angles_to_edges(starts, ends, limbs[outside]).min(axis=0)
    return np.where(sound, beyond, np.nan)


def _angles_to_edges(starts: Array, ends: Array, limbs: Array) -> Array:
    """(E, F) angles [rad] from directions (F, 3) to the nearest point of each of E great arcs, which make a polygon."""
    to_start = np.arctan2(np.linalg.norm(cross(starts[:, None], limbs), axis=2), starts @ limbs.T)
    apart = np.minimum(to_start, np.roll(to_start, -1, axis=0))
    normals = cross(starts, ends)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    # an arc without length has no lune, and its ends are all there is of it
    normals = np.where(lengths > NO_ARC, normals / np.maximum(lengths, NO_ARC), 0.0)
    within = (cross(normals, starts) @ limbs.T >= 0.0) & (cross(ends, normals) @ limbs.T >= 0.0) & (lengths > NO_ARC)
    across = normals @ limbs.T
    feet = limbs - across[:, :, None] * normals[:, None]
    return np.asarray(np.where(within, np.abs(np.arctan2(across, np.linalg.norm(feet, axis=2))), apart))
