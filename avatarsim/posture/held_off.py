"""What holds a trunk off the tracker's: nothing, what the tracker's own trunk is inside of, or something else in between."""

from avatarsim.kernel import kernel
from avatarsim.posture.certify import boxes_meet, certify_pair, sweep_boxes
from avatarsim.posture.untie import apart_at_trial
from avatarsim.posture.workspace import ADDING, Goal, Memory
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import Rows as Boxes
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.pair_filter import may_meet
from avatarsim.world.skeleton import Skeleton

FAR_OFF = 0.5
"""[m] a trunk farther than this from one that is not free may be held off by something that can be walked around. Less, and
those who press into furniture would search a way; more, and they stay behind a table that they could go round."""

CLOSER = 0.5
"""Share of its way that a trunk has to be nearer for the end of a walk to be worth going to, when the tracker's posture is not
free and so cannot be arrived at. Larger: avatars walk about for little."""

NOTHING, INSIDE, BETWEEN = range(3)
"""What `what_holds_off` finds."""


@kernel
def boxes_are_near(boxes: Boxes, a: int, b: int, within: float) -> bool:
    """Whether two axis-aligned boxes are no farther apart than `within` [m] along any axis."""
    for k in range(3):
        if boxes[a, k] > boxes[b, 3 + k] + within or boxes[b, k] > boxes[a, 3 + k] + within:
            return False
    return True


@kernel
def what_holds_off(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, poses: Poses, goal: Goal, memory: Memory
) -> int:
    """What of bodies that are no links keeps a root that is led from going straight from here to the trial.

    BETWEEN: something that the root at the trial is clear of; INSIDE: only what it is inside of there, and near to here; NOTHING:
    also where that is farther away than FAR_OFF, for then limbs are held, or nobody is.
    """
    sweep_boxes(geo, skel, poses, settings.least_gap, memory)
    memory.flags[ADDING], found = 0.0, NOTHING
    for link in range(skel.kind.shape[0]):
        if skel.parent[link] >= 0 or goal.led[link] == 0.0:
            continue
        body = skel.first + link
        for k in range(skel.first):
            if not boxes_meet(memory.swept_hulls, body, k) or not may_meet(geo.wanted, body, k):
                continue
            for a in range(geo.first_shape[body], geo.first_shape[body + 1]):
                for b in range(geo.first_shape[k], geo.first_shape[k + 1]):
                    if boxes_meet(memory.swept, a, b) and not certify_pair(geo, skel, poses, a, b, settings, memory):
                        if apart_at_trial(geo, a, b, settings.least_gap, memory):
                            return BETWEEN
                        if boxes_are_near(poses.boxes, a, b, FAR_OFF):
                            found = INSIDE
    return found
