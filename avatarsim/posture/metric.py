"""What does each degree of freedom weigh in a step?"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.settings import PostureSettings
from avatarsim.spatial import rotation
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import FREE, Skeleton

Array = NDArray[np.float64]

LEAST_WEIGHT = 1e-6
"""Weights are divided by: 0 would give steps that are no numbers."""


def metric(geo: Geometry, skel: Skeleton, poses: Poses, axes: Array, settings: PostureSettings) -> Array:
    """Weight (nd) of every degree of freedom: mean squared motion of the vertices it moves, at rest.

    Floored at `stiffness_floor` medians, or nearly free joints (wrists, feet) spin to gain a millimetre.
    """
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
    floored: Array = np.maximum(weight / typical, max(settings.stiffness_floor, LEAST_WEIGHT))
    floored[roots] *= max(settings.root_weight, LEAST_WEIGHT)
    return floored
