"""Is it looked in this frame whether a way to the tracker's posture may be sought, and may it be?"""

from avatarsim.kernel import kernel
from avatarsim.posture.behind import is_led, keep_others, speed_of_led, way_of_led
from avatarsim.posture.certify import is_no_pose
from avatarsim.posture.held_off import BETWEEN, FAR_OFF, INSIDE, boxes_are_near, what_holds_off
from avatarsim.posture.jointed import has_joints_of_its_own
from avatarsim.posture.kinematics import forward
from avatarsim.posture.notice import notice_others
from avatarsim.posture.untie import apart_at_trial
from avatarsim.posture.way_memory import (
    BLOCKED,
    BLOCKING,
    IDLE,
    MODE,
    OPEN,
    RESTING,
    SEARCHING,
    TURN,
    Way,
    copy_posture,
    get_node,
)
from avatarsim.posture.workspace import NOW, SLOW, WALLED, Goal, Memory
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.pair_filter import may_meet
from avatarsim.world.skeleton import Posture, Skeleton

LOOK_EVERY = 8
"""Frames after which it is looked again whether the posture of a tracker that rests is free: pressing into a wall is the ordinary
case. While it moves it is looked each frame, for a limb that is found caught eight frames late is far behind by then."""


ONE_BY_ONE = 4
"""Avatars that are asked about alone when it is looked: more, and a hundred that press on things cost milliseconds."""


@kernel
def is_time_to_look(skel: Skeleton, settings: PostureSettings, memory: Memory) -> bool:
    """Whether it is looked in this frame if the tracker's posture is free, the avatar having come no nearer for some frames."""
    late = int(memory.flags[SLOW]) - settings.search_after
    return late >= 0 and (speed_of_led(skel, memory) > 0.0 or late % LOOK_EVERY == 0)


@kernel
def tracker_is_free(geo: Geometry, skel: Skeleton, settings: PostureSettings, goal: Goal, way_out: Way) -> bool:
    """Whether the posture way.goal, whose poses are the trial of the unseen avatar, keeps the gap that a certified step keeps,
    `least_gap`, for those that are led: no path could end at a target that touches something.

    So boxes are asked with that gap too: those of a palm that lies flat on a table from below are 1e-17 m apart."""
    memory, state, least = way_out.memory, way_out.state, settings.least_gap
    trial, nb = memory.trial, geo.first_shape.shape[0] - 1
    a, b = state[BLOCKING], state[BLOCKED]
    asked = is_led(skel, geo.body[a], goal) or is_led(skel, geo.body[b], goal)
    if a != b and asked and boxes_are_near(trial.boxes, a, b, least) and not apart_at_trial(geo, a, b, least, memory):
        # what was in the way when last looked is, as a rule, still in the way
        return False
    for link in range(skel.first, nb):
        for k in range(nb):
            if not (is_led(skel, link, goal) or is_led(skel, k, goal)):
                continue
            if (k >= skel.first and k <= link) or not may_meet(geo.wanted, link, k):
                continue
            if not boxes_are_near(trial.hulls, link, k, least):
                continue
            for a in range(geo.first_shape[link], geo.first_shape[link + 1]):
                for b in range(geo.first_shape[k], geo.first_shape[k + 1]):
                    if boxes_are_near(trial.boxes, a, b, least) and not apart_at_trial(geo, a, b, least, memory):
                        state[BLOCKING], state[BLOCKED] = a, b
                        return False
    return True


@kernel
def may_seek(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, posture: Posture, poses: Poses, memory_out: Memory, way_out: Way
) -> bool:
    """Whether a way may be sought for those that are led: see `look`."""
    s, goal = way_out, memory_out.goal
    copy_posture(goal.tracker, s.goal)
    keep_others(skel, posture, goal, s.goal)
    notice_others(geo, skel, poses, s.memory)
    s.memory.rows.x[:] = 0.0
    forward(geo, skel, s.goal, s.memory.rows.x, s.memory.trial, s.memory.trial_axes)
    if is_no_pose(skel, s.memory):
        return False
    is_open = tracker_is_free(geo, skel, settings, goal, s)
    s.state[OPEN] = int(is_open)
    if not is_open and way_of_led(skel, goal) < FAR_OFF:
        return False
    held = what_holds_off(geo, skel, settings, poses, goal, s.memory)
    # the gaps that it noted are those of the shown avatar, and the unseen one goes on from elsewhere
    s.memory.pairs.marks[NOW] += 1
    if not is_open and held == INSIDE:
        return False
    memory_out.flags[WALLED] = 1.0 if held == BETWEEN else 0.0
    return True


@kernel
def may_be_led(skel: Skeleton, settings: PostureSettings, root: int, goal: Goal) -> bool:
    """Whether the avatar that begins at link `root` is led along planned paths: one without joints only if `around` says so."""
    return bool(settings.around == 2 or has_joints_of_its_own(skel, root, goal.closeness.root))


@kernel
def only_waits(skel: Skeleton, settings: PostureSettings, goal: Goal) -> bool:
    """Whether those that `look` has found are never led; it finds none together with one that is."""
    for root in range(goal.led.shape[0]):
        if goal.led[root] > 0.0:
            return not may_be_led(skel, settings, root, goal)
    return False


@kernel
def look(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, posture: Posture, poses: Poses, memory_out: Memory, way_out: Way
) -> bool:
    """Whether a way to the tracker's posture may be sought: it is free, which state[OPEN] says, or the trunk is far off it and
    not because of what the tracker's own trunk is inside of. If so, whether something in between walls the avatar off.

    Before a search all are asked about that came no nearer, and if that is in vain each of them alone: one that presses on a wall
    keeps no other in its trap, and a few at a time are asked. goal.led says for which. Those that are never led come last, and
    only until another needs a way: they wait, and are said to be trapped.
    """
    s, goal = way_out, memory_out.goal
    if s.state[MODE] == RESTING and only_waits(skel, settings, goal):
        s.state[MODE] = IDLE
    if s.state[MODE] != IDLE:
        found = may_seek(geo, skel, settings, posture, poses, memory_out, s)
        if found and s.state[MODE] == SEARCHING:
            stay_as_the_tree_began(skel, goal, s)
        return found
    for led in (True, False):
        asked = 0
        for root in range(skel.kind.shape[0]):
            goal.led[root] = 1.0 if is_slow(skel, settings, root, led, goal) else 0.0
            asked += int(goal.led[root])
        if asked > 0 and may_seek(geo, skel, settings, posture, poses, memory_out, s):
            return True
        for _ in range(min(asked, ONE_BY_ONE) if asked > 1 else 0):
            goal.led[:] = 0.0
            goal.led[whose_turn(skel, settings, led, goal, s)] = 1.0
            if may_seek(geo, skel, settings, posture, poses, memory_out, s):
                return True
    return False


@kernel
def is_slow(skel: Skeleton, settings: PostureSettings, root: int, led: bool, goal: Goal) -> bool:
    """Whether link `root` begins an avatar that came no nearer of late, and is one of those that may be led, or of the others."""
    slow = skel.parent[root] < 0 and goal.slow[root] >= settings.search_after
    return bool(slow and may_be_led(skel, settings, root, goal) == led)


@kernel
def whose_turn(skel: Skeleton, settings: PostureSettings, led: bool, goal: Goal, way_out: Way) -> int:
    """The next of those that `is_slow` names, of which there is one."""
    root, links = way_out.state[TURN], skel.kind.shape[0]
    for _ in range(links):
        root = (root + 1) % links
        if is_slow(skel, settings, root, led, goal):
            break
    way_out.state[TURN] = root
    return int(root)


@kernel
def stay_as_the_tree_began(skel: Skeleton, goal: Goal, way_out: Way) -> None:
    """Leave those for whom no way is sought where they are in all of the tree, whatever they do meanwhile."""
    get_node(way_out, 0, way_out.waypoint)
    keep_others(skel, way_out.waypoint, goal, way_out.goal)
