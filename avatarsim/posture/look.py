"""Is it looked in this frame whether a way to the tracker's posture may be sought, and may it be?"""

from avatarsim.kernel import kernel
from avatarsim.posture.certify import boxes_meet, is_no_pose
from avatarsim.posture.goal import root_way
from avatarsim.posture.held_off import BETWEEN, FAR_OFF, INSIDE, what_holds_off
from avatarsim.posture.kinematics import forward
from avatarsim.posture.notice import notice_others
from avatarsim.posture.untie import apart_at_trial
from avatarsim.posture.way_memory import BLOCKED, BLOCKING, OPEN, Way, copy_posture
from avatarsim.posture.workspace import NOW, SLOW, SPEED, WALLED, Memory
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Array, Geometry, Poses
from avatarsim.world.pair_filter import may_meet
from avatarsim.world.skeleton import Skeleton

LOOK_EVERY = 8
"""Frames after which it is looked again whether the posture of a tracker that rests is free: pressing into a wall is the ordinary
case. While it moves it is looked each frame, for a limb that is found caught eight frames late is far behind by then."""


@kernel
def is_time_to_look(settings: PostureSettings, flags: Array) -> bool:
    """Whether it is looked in this frame if the tracker's posture is free, the avatar having come no nearer for some frames."""
    late = int(flags[SLOW]) - settings.search_after
    return late >= 0 and (flags[SPEED] > 0.0 or late % LOOK_EVERY == 0)


@kernel
def tracker_is_free(geo: Geometry, skel: Skeleton, settings: PostureSettings, way_out: Way) -> bool:
    """Whether the posture way.goal, whose poses are the trial of the unseen avatar, is proved free of every overlap."""
    memory, state = way_out.memory, way_out.state
    trial, nb = memory.trial, geo.first_shape.shape[0] - 1
    a, b = state[BLOCKING], state[BLOCKED]
    if a != b and boxes_meet(trial.boxes, a, b) and not apart_at_trial(geo, a, b, settings.least_gap, memory):
        # what was in the way when last looked is, as a rule, still in the way
        return False
    for link in range(skel.first, nb):
        for k in range(nb):
            if (k >= skel.first and k <= link) or not boxes_meet(trial.hulls, link, k) or not may_meet(geo.wanted, link, k):
                continue
            for a in range(geo.first_shape[link], geo.first_shape[link + 1]):
                for b in range(geo.first_shape[k], geo.first_shape[k + 1]):
                    if boxes_meet(trial.boxes, a, b) and not apart_at_trial(geo, a, b, settings.least_gap, memory):
                        state[BLOCKING], state[BLOCKED] = a, b
                        return False
    return True


@kernel
def look(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, poses: Poses, memory_out: Memory, way_out: Way
) -> bool:
    """Whether a way to the tracker's posture may be sought: it is free, which state[OPEN] says, or the trunk is far off it and
    not because of what the tracker's own trunk is inside of. If so, whether something in between walls the avatar off."""
    s = way_out
    copy_posture(memory_out.goal.tracker, s.goal)
    notice_others(geo, skel, poses, s.memory)
    s.memory.rows.x[:] = 0.0
    forward(geo, skel, s.goal, s.memory.rows.x, s.memory.trial, s.memory.trial_axes)
    if is_no_pose(skel, s.memory):
        return False
    is_open = tracker_is_free(geo, skel, settings, s)
    s.state[OPEN] = int(is_open)
    if not is_open and root_way(skel, memory_out.goal.full) < FAR_OFF:
        return False
    held = what_holds_off(geo, skel, settings, poses, s.memory)
    # the gaps that it noted are those of the shown avatar, and the unseen one goes on from elsewhere
    s.memory.pairs.marks[NOW] += 1
    if not is_open and held == INSIDE:
        return False
    memory_out.flags[WALLED] = 1.0 if held == BETWEEN else 0.0
    return True
