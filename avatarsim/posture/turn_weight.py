"""What the angle of a joint weighs beside the places of link origins, and how far an origin may be to pull harder than others."""

import numpy as np

from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import FREE, Skeleton

TURN_SHARE = 1.0
"""What angles weigh beside link origins; 1: as their means in metres, a radian being a link's mean reach. 0.7: offsets a tenth
smaller where limbs are pressed on, angles larger, and limbs get caught more often. 1.4: the other way round, and chains lag."""

TURN_ALONE = 0.55
"""The same for avatars without joints: the mean square of the distances of a hand's points from its origin is half of that of its
reach. 1: in a bowl and behind a wall its place is a tenth farther from the user's, for angles smaller than need be; 0.4: in a
corner it turns by ten degrees more for its place to come 3 mm nearer."""

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


def turn_weight(geo: Geometry, skel: Skeleton, poses: Poses) -> float:
    """Weight [m^2] of the squared angle of a joint in the measure of nearness (`closeness.py`)."""
    degrees = np.diff(skel.first_dof)
    jointed = bool((degrees[skel.kind != FREE] > 0).any())
    share = TURN_SHARE if jointed else TURN_ALONE
    return float(share * mean_reach(geo, skel, poses) ** 2 * len(skel.kind) / max(int((degrees > 0).sum()), 1))
