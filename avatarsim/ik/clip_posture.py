"""A recorded posture within the limits of its joints, and with followers where their leaders have them."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.motion_ccd import MotionSegment
from avatarsim.jit.arena import view_arena
from avatarsim.jit.kernel import entry_kernel
from avatarsim.model.conversion import read_sample
from avatarsim.model.couplings import set_followers
from avatarsim.model.joint_limits import cone_excess, has_cone, inside_cone
from avatarsim.model.skeleton import BALL, SLIDE, has_angles
from avatarsim.model.world import WorldParts
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.tolerances import ROUNDING

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@entry_kernel
def clip_posture(world: Index, segment: Index, positions: Array, rotations: Array, angles: Array) -> tuple[float, float]:
    """Clip a posture to its joint limits, into `MotionSegment.end`; return the largest excess of an angle [rad] and of a slide
    [m], or a follower's distance from its leader."""
    w, c = view_arena(world, WorldParts), view_arena(segment, MotionSegment)
    skel, turned, slid = w.skeleton, 0.0, 0.0
    read_sample(positions, rotations, angles, c.hinges, c.start)
    read_sample(positions, rotations, angles, c.hinges, c.end)
    for link in range(skel.kind.shape[0]):
        if has_angles(skel, link):
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                c.end.angle[j] = min(max(c.start.angle[j], skel.limits[j, 0]), skel.limits[j, 1])
        elif skel.kind[link] == BALL and has_cone(skel.balls, link):
            turn = columns(c.start.turn, link)
            excess = cone_excess(skel.balls, link, turn)
            if excess > 0.0:
                put_columns(c.end.turn, link, inside_cone(skel.balls, link, turn))
                turned = max(turned, excess)
    set_followers(skel, 0, c.step.shape[0], ROUNDING, c.end)
    for link in range(skel.kind.shape[0]):
        for j in range(skel.first_dof[link], skel.first_dof[link + 1] if has_angles(skel, link) else skel.first_dof[link]):
            excess = abs(c.end.angle[j] - c.start.angle[j])
            if skel.kind[link] == SLIDE:
                slid = max(slid, excess)
            else:
                turned = max(turned, excess)
    return turned, slid
