"""One frame of method `default`: from the last checked posture towards the tracker's, every state certified."""

from avatarsim.kernel import kernel
from avatarsim.posture.again import leave_the_rest
from avatarsim.posture.body_place import MOST_TURNED, place_bodies
from avatarsim.posture.creep import creeps
from avatarsim.posture.goal import clip_to_limits, farthest, measure_way, merit, tracker_speed
from avatarsim.posture.jointed import has_joints
from avatarsim.posture.leap import hold_who_has_leapt, leap_of, steps_of_leap
from avatarsim.posture.notice import notice_movers, notice_others
from avatarsim.posture.step import budget, step, work_done
from avatarsim.posture.untie import unstick
from avatarsim.posture.way_memory import copy_posture
from avatarsim.posture.workspace import (
    ASTRAY,
    BEYOND,
    CALM,
    CLOSE,
    COUNT,
    COUPLED,
    CROWDED,
    FRAME,
    HELD_STILL,
    LEAP,
    LEAPS,
    LED,
    LISTED,
    MERIT_WINDOW,
    NEAR_BODIES,
    PAST,
    PAST_FRAMES,
    PRESSED,
    RESTED,
    SLOW,
    SOUGHT,
    SPEED,
    STEPPED,
    STIFF,
    TRACKER_SPEED,
    TRAVELS,
    UNDER_WAY,
    UNTIED,
    WORN,
    Memory,
)
from avatarsim.settings import PostureSettings
from avatarsim.world.arena import Index
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import UNLIMITED, Posture, Skeleton

ARRIVED = 5e-3
"""[rad or m] a step smaller than this ends the frame: what is left is left for the next one."""

JUMP = MOST_TURNED + 0.01
"""[rad or m] a tracker that moves more than this within a frame has jumped: whether one comes nearer to it is judged anew. Less,
and a body that comes back from aside counts as a jump in each frame: a way that is sought meanwhile is begun again and again."""

OUTRUN = 0.7
"""[rad] a tracker that turns a joint more than this within a frame, as no joint can in two steps, or a root by a jump, is
elsewhere: it is followed joint by joint until the avatar is there or the tracker's posture is found to be not free, since on a
long way the nearest posture is no guide: limbs that stretch get caught. Who has no joints has none, and is nearest all the way.
0.2: a kick is followed so, and its limbs end twice as far from the user's."""

CROWD, TOUCHING, SPARSE, SPARSE_FRAMES = 9, 5, 4, 3.0
"""Near pairs of bodies in the last trial beyond which each joint goes its own way too, or more than TOUCHING of them and of pairs
in touch: fingers that press on many things spend the budget on rows, are wedged for some frames, and then jump. Six near pairs
alone are arms that fold before a chest, or a human who gets up: going their own way they end a twentieth farther from the user's,
and jump twice as far; 24, and a hand in a corner jumps by 15 mm. It is over once no more than SPARSE were near in so many frames:
with one number for both a body shifted to and fro by 0.2 m, and a hand that grasps came home late."""

ALONE, CHANGE = 1.5, 0.25
"""What angles weigh where nothing but limits is in the way, in units of what they weigh in contact, and the share of the way
there that a frame goes, so that a touch turns no limb at once. 1: joints that are within their limits turn a twentieth more."""

UNREACHED = 0.46
"""The same in contact, of a user who is beyond limits: no posture has those angles, but origins may be where the user's are. 1:
in mocap_dance_a origins are 7.8 mm from the user's and angles 3.8 degrees, in mocap_roll 12.1 and 3.5; here 6.5 and 4.0, 11.3
and 3.7. Less than 0.44: a leg that kicks is caught."""

HURRIED = 0.5
"""A tracker whose root goes farther in a frame than this share of a step is followed by one more step of an avatar without
joints, for which it costs little: without, a hand that lies turned on a wall and is pulled off it is 37 mm short in the first
frame that is free. 0: with `turn_alone` 0.35 a hand that slides along a corner jumps by 11 mm."""

NEAR_ENOUGH = 0.05
"""[rad or m] an avatar nearer than this to the tracker's posture in every joint needs no other way."""

NEARER = 0.64
"""Share to which half the squared distance to the tracker must fall within PAST_FRAMES: a fifth of the distance."""

PRESSED_TRUST, PRESSED_GAIN = 0.15, 12.0
"""Trust allowed to limbs that a tracker at rest presses into something, and what each rad or m per frame of its speed adds.
Without it limbs that find a better place to rest at whip there, 47 degrees in a frame; with less they are slow."""

CALM_SPEED, PUSHING = 1e-3, 1e-2
"""[rad or m] a tracker that moves less than the first per frame rests; one that moves more than the second is followed as fast
as one can, whatever limbs are pressed into."""

SETTLED = 0.05
"""[rad or m] a step in contact that moves nothing farther ends the frame of an avatar that came no nearer lately: another one
takes as long and brings a hundredth of the way, which the next frame brings as well. 0.1: limbs rest more than a millimetre short
of a wall that turns them. Where something has just come in the way all steps are taken, or a foot that the floor caught stays
caught."""

SPEED_MEMORY = 0.8
"""Share of the tracker's speed that is remembered from frame to frame: it may rest for one frame and go on."""


@kernel
def stiffen(memory_out: Memory) -> None:
    """Bring the weight of angles nearer to that of a posture in contact, of one beyond limits, or of both: listed pairs press."""
    mode, touches = memory_out.goal.closeness.mode, memory_out.pairs.marks[LISTED] > 0
    if touches or mode[BEYOND] > 0.0:
        wanted = ALONE if not touches else UNREACHED if mode[BEYOND] > 0.0 else 1.0
        mode[STIFF] += CHANGE * (wanted - mode[STIFF])


@kernel
def is_held(memory: Memory) -> bool:
    """Whether the last step was one in contact, towards a posture that the avatar has not come a fifth nearer to of late."""
    return bool(memory.goal.closeness.mode[COUPLED] > 0.0 and memory.flags[SLOW] > 0.0)


@kernel
def walk(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, steps: int, posture_out: Posture, poses_out: Poses,
    memory_out: Memory,
) -> float:
    """At most `steps` certified steps towards the goal that `clip_to_limits` has set; the largest part of the last one."""
    largest = 0.0
    stiffen(memory_out)
    frame, now = int(memory_out.flags[FRAME]), 0.0
    if memory_out.flags[CLOSE] == 0.0:
        # where the nearest posture is sought its merit is known once there is a contact
        measure_way(skel, posture_out, memory_out.goal)
        now = merit(memory_out.goal)
    memory_out.goal.window[frame % MERIT_WINDOW] = now
    memory_out.flags[FRAME] = frame + 1
    for k in range(steps):
        if k >= settings.steps:
            if memory_out.flags[LEAP] > 0.0:
                hold_who_has_leapt(skel, settings, posture_out, memory_out)
            else:
                leave_the_rest(skel, settings, steps - k, posture_out, memory_out.goal)
        if memory_out.flags[PRESSED] > 0.0:
            most = PRESSED_TRUST + PRESSED_GAIN * memory_out.flags[TRACKER_SPEED]
            for j in range(memory_out.goal.trust.shape[0]):
                memory_out.goal.trust[j] = min(memory_out.goal.trust[j], most)
        largest, to_turn, to_move = step(geo, skel, posture_out, poses_out, settings, memory_out)
        there = memory_out.rows.size[COUNT] == 0 and to_turn <= settings.turn_cap and to_move <= settings.move_cap
        enough = SETTLED if is_held(memory_out) else ARRIVED
        if there or largest < enough or creeps(memory_out) or work_done(memory_out) > 0.6 * budget(settings, memory_out):
            break
    memory_out.goal.allowed[:] = 1.0
    return largest


@kernel
def is_crowded(memory_out: Memory) -> bool:
    """Whether many pairs of bodies are near or in touch, or were and there have not yet been frames enough with few."""
    pairs, flags = memory_out.pairs, memory_out.flags
    near, touching = pairs.marks[NEAR_BODIES], pairs.marks[LISTED]
    if near > CROWD or min(near, touching) > TOUCHING:
        flags[CROWDED] = SPARSE_FRAMES
    elif near <= SPARSE:
        flags[CROWDED] = max(0.0, flags[CROWDED] - 1.0)
    return bool(flags[CROWDED] > 0.0)


@kernel
def judge_progress(memory_out: Memory) -> None:
    """Count the frames in a row in which the avatar is not a fifth nearer to the tracker than PAST_FRAMES before.

    After `unstick`, which has measured the way from where the frame ends.
    """
    flags, goal = memory_out.flags, memory_out.goal
    now, place, far = merit(goal), PAST + int(flags[FRAME]) % PAST_FRAMES, farthest(goal) > NEAR_ENOUGH
    flags[SLOW] = flags[SLOW] + 1.0 if far and now > NEARER * flags[place] else 0.0
    if not far:
        flags[TRAVELS] = 0.0
    flags[place] = now


@kernel
def follow(
    geo: Geometry, skel: Skeleton, tracker: Posture, settings: PostureSettings, again: bool, moving: Index,
    posture_out: Posture, poses_out: Poses, memory_out: Memory,
) -> None:
    """Bring the posture towards the tracker's by `settings.steps` certified steps at most, more after one that leaps or hurries;
    the work adds to the counts.

    again: whether it is the second time in this frame, which then goes on from where it began (`again.py`).
    moving (nb): 1 for bodies that may have moved since the last call; empty if nobody knows.
    """
    if moving.shape[0] > 0:
        changed = notice_movers(geo, skel, poses_out, moving, memory_out)
    else:
        changed = notice_others(geo, skel, poses_out, memory_out)
    clip_to_limits(skel, tracker, memory_out.goal)
    place_bodies(skel, memory_out.goal)
    if not again:
        copy_posture(posture_out, memory_out.goal.begun)
    speed, moved = tracker_speed(skel, memory_out.goal)
    memory_out.flags[TRACKER_SPEED] = max(speed, SPEED_MEMORY * memory_out.flags[TRACKER_SPEED])
    flags = memory_out.flags
    flags[UNTIED], flags[SPEED], flags[LEAP] = 0.0, speed, 0.0
    if speed > JUMP:
        # whoever jumps wants to go elsewhere
        flags[LED] = 0.0
        flags[PAST : PAST + PAST_FRAMES] = UNLIMITED
    if (speed > OUTRUN or moved > JUMP) and has_joints(skel):
        flags[TRAVELS] = 1.0
    if flags[LED] == UNDER_WAY:
        flags[SLOW] += 1.0
        flags[RESTED], flags[CLOSE] = 0.0, 0.0
        return
    memory_out.goal.closeness.mode[WORN] += speed
    # to a posture known to be free, and to one that is far, each joint goes its own way: limbs that stretch get caught
    lost = is_crowded(memory_out) or memory_out.goal.closeness.mode[ASTRAY] > 0.0
    close = 1.0 if flags[TRAVELS] == 0.0 and flags[SOUGHT] == 0.0 and not lost else 0.0
    if close != flags[CLOSE]:
        flags[CLOSE] = close
        memory_out.goal.window[:] = 0.0
    flags[CALM] = flags[CALM] + 1.0 if speed < CALM_SPEED else 0.0
    flags[RESTED] = flags[RESTED] + 1.0 if speed < CALM_SPEED and not changed else 0.0
    if speed >= PUSHING:
        flags[PRESSED] = 0.0
    if flags[LED] != HELD_STILL:
        flags[LEAP] = leap_of(settings, moved)
        memory_out.counts[LEAPS] += 1 if flags[LEAP] > 0.0 else 0
        steps = settings.steps + steps_of_leap(settings, memory_out)
        if moved > HURRIED * settings.move_cap and not has_joints(skel):
            steps = max(steps, settings.steps + 1)
        if again:
            leave_the_rest(skel, settings, settings.steps, posture_out, memory_out.goal)
        flags[STEPPED] = walk(geo, skel, settings, steps, posture_out, poses_out, memory_out)
    unstick(geo, skel, settings, posture_out, poses_out, memory_out)
    if flags[LEAP] > 0.0:
        # whoever had steps for all of the way and is not there is held up by something
        flags[SLOW], flags[PAST : PAST + PAST_FRAMES] = 0.0, merit(memory_out.goal)
    judge_progress(memory_out)
