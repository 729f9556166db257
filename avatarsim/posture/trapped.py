"""What is done when the avatar comes no nearer to a tracker though it could: search, lead, say so, and jump if asked.

trapped: the tracker's posture overlaps nothing, or its trunk is far off and not because of what that trunk itself is inside of
(`held_off.py`); the shown posture is not near it, and for `trapped_frames` frames in a row it was not a fifth nearer than a few
frames before. walled: besides, something that is no link stands between the shown trunk and the tracker's. Both are said in every
frame that they last, the time included in which the avatar is led out.
"""

from avatarsim.kernel import kernel
from avatarsim.posture.behind import copy_led, count_slow, hold, set_slow, speed_of_led, way_of_led
from avatarsim.posture.goal import aim, measure_way
from avatarsim.posture.look import is_time_to_look, look, only_waits, stay_as_the_tree_began
from avatarsim.posture.meet_tracker import CALM_SPEED
from avatarsim.posture.motion_budget import is_spent
from avatarsim.posture.step import adopt, try_step
from avatarsim.posture.untie import forget
from avatarsim.posture.way_lead import REFUSALS, lead
from avatarsim.posture.way_memory import (
    AT,
    FIRST_REST,
    IDLE,
    LAST,
    LEADING,
    MODE,
    NODE,
    OPEN,
    REFUSED,
    REST,
    RESTED,
    RESTING,
    SEARCHING,
    TRIES,
    Way,
    copy_posture,
)
from avatarsim.posture.way_search import begin_tree, search
from avatarsim.posture.workspace import (
    CLOSE,
    CROSSINGS,
    HELD_STILL,
    LED,
    LED_STEPS,
    PRESSED,
    SLOW,
    STEPPED,
    TRAPPED,
    TRAPPED_FRAMES,
    UNDER_WAY,
    WALLED,
    WALLED_FRAMES,
    Memory,
)
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton

AT_REST = 1e-2
"""[rad or m] an avatar that moves less than this per frame, at a tracker that rests (CALM_SPEED), waits while a way is searched.
Else the tracker is followed meanwhile, and each walk begins where the avatar has got to. With this number for the tracker as
well, an avatar stands still while its user sways."""

CREEPING_TRIES = 2
"""Walks during which an avatar that still moves is not made to wait; 0 stops limbs short of the wall that they press on."""

PLACES = 12
"""Steps along a way for each step of any frame: a path bends, and short steps have as far to go as long ones. Fewer: a leg on the
wrong side of the other, whose way is short, is there frames late; more: such a frame takes many milliseconds."""

LONGEST_REST = 960
"""Most frames that the search rests: a tracker may stay beyond a wall for good, and a trap may open at any time."""


@kernel
def jump_is_due(settings: PostureSettings, memory: Memory) -> bool:
    """Whether the avatar was trapped for as long as the settings say that it is to wait."""
    flags = memory.flags
    patience = settings.walled_jump if flags[WALLED] > 0.0 else settings.trapped_jump
    return flags[TRAPPED] > 0.0 and patience > 0 and flags[SLOW] >= patience


@kernel
def let_go(mode: int, memory_out: Memory, way_out: Way) -> None:
    """The shown avatar follows the tracker again."""
    way_out.state[MODE] = mode
    if memory_out.flags[LED] > 0.0:
        memory_out.flags[LED] = 0.0
        forget(memory_out)


@kernel
def set_free(memory_out: Memory, way_out: Way) -> None:
    """Nobody is trapped, and nothing is searched."""
    let_go(IDLE, memory_out, way_out)
    way_out.state[REST] = FIRST_REST
    memory_out.flags[TRAPPED], memory_out.flags[WALLED] = 0.0, 0.0
    memory_out.goal.led[:] = 0.0
    count_slow(memory_out)


@kernel
def hold_if_at_rest(skel: Skeleton, memory_out: Memory, way: Way) -> None:
    """Let the shown avatar wait where it is: a way begins where it was shown.

    Not before tracker and avatar rest, or only the tracker does and the first walks were in vain: where the avatar creeps to
    is then no better a place to begin from.
    """
    flags = memory_out.flags
    if speed_of_led(skel, memory_out) < CALM_SPEED and (flags[STEPPED] < AT_REST or way.state[TRIES] > CREEPING_TRIES):
        flags[LED] = HELD_STILL


@kernel
def may_search(skel: Skeleton, settings: PostureSettings, memory: Memory) -> bool:
    """Whether a way is searched at all: not without work, nor for those that are never led, and around what walls the avatar off
    only as `around` says."""
    if settings.search_work == 0 or only_waits(skel, settings, memory.goal):
        return False
    return settings.around > 0 or memory.flags[WALLED] == 0.0


@kernel
def begin_search(
    skel: Skeleton, settings: PostureSettings, posture: Posture, poses: Poses, memory_out: Memory, way_out: Way
) -> None:
    """Begin with the straight walk from the shown posture, or rest."""
    if not may_search(skel, settings, memory_out):
        let_go(RESTING, memory_out, way_out)
        way_out.state[RESTED] = 0
        return
    begin_tree(posture, poses, way_of_led(skel, memory_out.goal), way_out)
    copy_led(memory_out.goal, way_out.memory.goal)
    way_out.state[MODE], way_out.state[TRIES] = SEARCHING, 0
    hold_if_at_rest(skel, memory_out, way_out)


@kernel
def go_on_searching(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, posture: Posture, poses: Poses, memory_out: Memory, way_out: Way
) -> None:
    """The search of one frame."""
    s, flags = way_out, memory_out.flags
    if speed_of_led(skel, memory_out) >= CALM_SPEED and flags[LED] == HELD_STILL:
        let_go(SEARCHING, memory_out, s)
    if s.state[NODE] < 0:
        copy_posture(memory_out.goal.tracker, s.goal)
        if flags[LED] == 0.0:
            begin_tree(posture, poses, way_of_led(skel, memory_out.goal), s)
            hold_if_at_rest(skel, memory_out, s)
        stay_as_the_tree_began(skel, memory_out.goal, s)
    s.state[MODE] = search(geo, skel, settings, s)
    if s.state[MODE] == RESTING:
        s.state[RESTED] = 0
        let_go(RESTING, memory_out, s)
    elif s.state[MODE] == LEADING:
        # along the way each joint goes its own
        flags[LED], flags[CLOSE] = UNDER_WAY, 0.0
        forget(memory_out)


@kernel
def go_on_leading(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, posture: Posture, poses: Poses, memory_out: Memory, way_out: Way
) -> None:
    """As far along the way as the motion budget of a frame goes; at its end the tracker is followed, and a way that is blocked is
    searched anew."""
    s, user = way_out, way_out.memory.goal.tracker
    # steps go to nodes of the way, and whoever asks afterwards means the user's posture; nobody walks unseen meanwhile
    copy_posture(memory_out.goal.tracker, user)
    for k in range(PLACES * settings.steps):
        if is_spent(skel, settings, memory_out.goal):
            break
        lead(geo, skel, settings, s, posture, poses, memory_out)
        memory_out.counts[LED_STEPS] += 1
        refused = s.state[REFUSED]
        if s.state[AT] == s.state[LAST] or refused > REFUSALS or (refused > 0 and k + 1 >= settings.steps):
            break
    copy_posture(user, memory_out.goal.tracker)
    measure_way(skel, posture, memory_out.goal)
    if s.state[AT] == s.state[LAST]:
        set_slow(0.0, memory_out)
        set_free(memory_out, s)
    elif s.state[REFUSED] > REFUSALS:
        let_go(SEARCHING, memory_out, s)
        begin_search(skel, settings, posture, poses, memory_out, s)


@kernel
def seek_once(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, posture: Posture, poses: Poses, memory_out: Memory, way_out: Way
) -> None:
    """What is searched, or gone, in a frame."""
    s, flags = way_out, memory_out.flags
    mode = s.state[MODE]
    due = mode != IDLE and mode != LEADING and jump_is_due(settings, memory_out)
    if due or (mode != LEADING and is_time_to_look(skel, settings, memory_out)):
        if not look(geo, skel, settings, posture, poses, memory_out, s):
            set_free(memory_out, s)
            flags[PRESSED] = 1.0
            return
        flags[PRESSED] = 1.0 if s.state[OPEN] == 0 else 0.0
        if s.state[MODE] == IDLE:
            begin_search(skel, settings, posture, poses, memory_out, s)
    if s.state[MODE] == IDLE:
        return
    flags[TRAPPED] = 1.0 if flags[SLOW] >= settings.trapped_frames else 0.0
    memory_out.counts[TRAPPED_FRAMES], memory_out.counts[WALLED_FRAMES] = int(flags[TRAPPED]), int(flags[TRAPPED] * flags[WALLED])
    if due and s.state[OPEN] == 1 and jump_is_due(settings, memory_out):
        # that posture was just proved free
        aim(skel, posture, settings, memory_out.goal)
        hold(skel, False, memory_out.goal, memory_out.goal.allowed)
        for j in range(memory_out.rows.x.shape[0]):
            memory_out.rows.x[j] = memory_out.goal.full[j] * memory_out.goal.allowed[j]
        memory_out.goal.allowed[:] = 1.0
        try_step(geo, skel, posture, memory_out)
        adopt(geo, skel, posture, poses, memory_out)
        memory_out.counts[CROSSINGS] += 1
        set_slow(0.0, memory_out)
        set_free(memory_out, s)
    elif s.state[MODE] == RESTING:
        s.state[RESTED] += 1
        if s.state[RESTED] >= s.state[REST]:
            s.state[REST] = min(2 * s.state[REST], LONGEST_REST)
            begin_search(skel, settings, posture, poses, memory_out, s)
    elif s.state[MODE] == SEARCHING:
        go_on_searching(geo, skel, settings, posture, poses, memory_out, s)
    elif s.state[MODE] == LEADING:
        go_on_leading(geo, skel, settings, posture, poses, memory_out, s)
