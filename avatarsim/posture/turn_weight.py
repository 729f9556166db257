"""What the angle of a joint weighs beside the places of link origins, and how far an origin may be to pull harder than others."""

import numpy as np

from avatarsim.posture.jointed import has_joints
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Skeleton

LEAST_SHARE = 1e-3
"""What angles weigh at least: with nothing, a joint that carries no other link's origin would turn for no reason."""

FAR = 4.0
"""Mean reaches of a link beyond which an origin pulls no harder; larger, and limbs stretch to a far tracker."""


def mean_reach(geo: Geometry, skel: Skeleton, poses: Poses) -> float:
    """How far [m] an average link reaches from its joint; 1 where nothing does."""
    reaches = []
    for link in range(len(skel.kind)):
        b = skel.first + link
        far = [
            float(np.linalg.norm(poses.vertices[geo.shapes.start[s] : geo.shapes.start[s + 1]] - poses.position[b], axis=1).max())
            + float(geo.shapes.radius[s])
            for s in range(geo.first_shape[b], geo.first_shape[b + 1])
        ]
        reaches += [max(far)] if far else []
    return float(np.mean(reaches)) if reaches else 1.0


def turn_weight(geo: Geometry, skel: Skeleton, poses: Poses, settings: PostureSettings) -> float:
    """Weight [m^2] of the squared angle of a joint in the measure of nearness (`closeness.py`): with a share of 1 as much as the
    means of angles and of origins are in metres, a radian being a link's mean reach."""
    degrees = np.diff(skel.first_dof)
    share = max(settings.turn_share if has_joints(skel) else settings.turn_alone, LEAST_SHARE)
    return float(share * mean_reach(geo, skel, poses) ** 2 * len(skel.kind) / max(int((degrees > 0).sum()), 1))
