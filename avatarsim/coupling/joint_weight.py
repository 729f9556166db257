"""Weight of each degree of freedom when joints share an impulse: the mass matrix's diagonal for a body of even vertices."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.spatial import rotation
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import FREE, Skeleton

Array = NDArray[np.float64]

LEAST = 3.0
"""[median weights] least weight of a joint: wrists and feet, which move little else, would give way by half a turn for a
millimetre."""

ROOT = 3.0
"""How much more a root weighs than what it moves: a body that a hand could yield for stands still."""


def joint_weights(geo: Geometry, skel: Skeleton, poses: Poses, axes: Array) -> Array:
    """Weight (nd) of every degree of freedom, in medians of them: mean squared motion of the vertices that it moves, at `poses`,
    with world axes (nd, 3) of the degrees."""
    weight = np.zeros(skel.first_dof[-1])
    for link in range(len(skel.kind)):
        b = skel.first + link
        rows = slice(geo.shapes.start[geo.first_shape[b]], geo.shapes.start[geo.first_shape[b + 1]])
        points = poses.vertices[rows]
        if not len(points):
            continue
        for m in range(len(skel.kind)):
            if not skel.related[link, m]:
                continue
            first, end = skel.first_dof[m : m + 2]
            if skel.kind[m] == FREE:
                weight[first : first + 3] += 1.0
                first += 3
            arms = rotation.cross(axes[first:end, None], points - poses.position[skel.first + m])
            weight[first:end] += (arms**2).sum(axis=-1).mean(axis=-1) + 1e-4
    roots = np.zeros(len(weight), dtype=bool)
    for link in np.flatnonzero(skel.kind == FREE).tolist():
        roots[skel.first_dof[link] : skel.first_dof[link + 1]] = True
    # degrees that move no vertex weigh nothing: they are left out of the median and get the floor
    moving = weight > 0.0
    joints = weight[~roots & moving] if (~roots & moving).any() else weight[moving]
    typical = float(np.median(joints)) if len(joints) else 1.0
    floored: Array = np.maximum(weight / typical, LEAST)
    floored[roots] *= ROOT
    return floored
