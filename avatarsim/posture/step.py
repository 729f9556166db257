"""One step of the checked posture towards the tracker: solve, try, certify, mend, and if all fails stay.

A state is shown only after it was certified from the last certified state, so nothing ever overlaps and nothing is
crossed, whatever the solver does.
"""

from avatarsim.kernel import kernel
from avatarsim.posture.certify import certify
from avatarsim.posture.contact_row import forget_idle_pairs, list_pair, list_rows, rows_of_listed
from avatarsim.posture.creep import creeps, slow_down
from avatarsim.posture.curvature import note_forces
from avatarsim.posture.foreseen import foresee
from avatarsim.posture.goal import aim
from avatarsim.posture.kinematics import forward, place_links, take
from avatarsim.posture.leap import steps_of_leap
from avatarsim.posture.limit_row import beyond_limits
from avatarsim.posture.nearest_step import nearest_step
from avatarsim.posture.trail import note_step
from avatarsim.posture.wanted_step import hindered, keep_limits, loses_merit, scale_step, seek_the_nearest
from avatarsim.posture.workspace import (
    ADDING,
    ASKED,
    BACKED,
    BEYOND,
    CLOSE,
    COUNT,
    COUPLED,
    FAILED,
    FORWARDS,
    HELD,
    ITERATIONS,
    NOW,
    PRESSED,
    QUERIES,
    ROWS,
    SOFT,
    STEPS,
    SUPPORTS,
    SWEEPS,
    TRACKER_SPEED,
    Memory,
)
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Array, Geometry, Index, Poses
from avatarsim.world.skeleton import Posture, Skeleton

SHRINK = 0.25
"""Share of the wanted step that the attempt after one that was refused, or lost merit, takes. Nearer 1: refused once more; nearer
0: avatars hesitate."""

BACK_OFF, BACK_OFFS = 0.5, 6
"""Factor by which a trial that is still refused shrinks, and how often. One share for all of an avatar keeps the step on the line
to where the model's least is; a limb cut alone leaves it, and the rest of the body makes up for it frame by frame, to and fro.
After that the failing joints alone stay: one blocked hand must not freeze the other."""

PAIRS_INCLUDED = 8
"""Near pairs that the budget of settings is made for. A human at a wall has six."""

WORK_PER_PAIR = 10
"""Budget that each further near pair brings: it is asked in every trial, and in a corner it needs a query, a row and a correction
of its own now and then. With a fixed budget a hand of 24 hinges and 80 near pairs was spent after its first trial, and jumped."""

PRESSED_TRUST, PRESSED_GAIN = 0.15, 12.0
"""Trust allowed to limbs that a tracker at rest presses into something, and what each rad or m per frame of its speed adds.
Without it limbs that find a better place to rest at whip there, 47 degrees in a frame; with less they are slow."""

IDLE_STEPS = 3
"""Steps for which a pair stays listed after its last active row; 0 makes contacts flicker."""


@kernel
def work_done(memory: Memory) -> int:
    """Work of this frame so far, in units of about a microsecond; counted, so that results repeat."""
    c = memory.counts
    return int(c[QUERIES] + 2 * c[FORWARDS] + c[SUPPORTS] // 8 + c[SWEEPS] // 4 + c[ROWS] // 2)


@kernel
def budget(settings: PostureSettings, memory: Memory) -> int:
    """Work that a frame may cost with as many near pairs as the last trial had; each step of a leap may cost as much."""
    frames, more_pairs = 1 + steps_of_leap(settings, memory), max(0, memory.pairs.marks[ASKED] - PAIRS_INCLUDED)
    return int(settings.work * frames + WORK_PER_PAIR * more_pairs)


@kernel
def try_step(geo: Geometry, skel: Skeleton, posture: Posture, memory_out: Memory) -> None:
    """Forward kinematics of the step in rows.x into the trial poses."""
    memory_out.counts[FORWARDS] += 1
    forward(geo, skel, posture, memory_out.rows.x, memory_out.trial, memory_out.trial_axes)


@kernel
def check(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, within: bool, memory_out: Memory
) -> int:
    """Certificates and ball limits of the trial: number of failures; links at fault are touched.

    within: whether the trial is known to be inside the limits.
    """
    memory_out.touched[:] = False
    beyond = 0 if within else beyond_limits(skel, posture, memory_out)
    failed = certify(geo, skel, poses, settings, memory_out)
    for k in range(memory_out.pairs.marks[FAILED]):
        for side in range(2):
            link = geo.body[memory_out.pairs.failed[k, side]] - skel.first
            if link >= 0:
                memory_out.touched[link] = True
    return failed + beyond


@kernel
def moves_failing(skel: Skeleton, memory: Memory, m: int) -> bool:
    """Whether the joint of link m moves a link that failed."""
    for link in range(skel.kind.shape[0]):
        if memory.touched[link] and skel.related[link, m]:
            return True
    return False


@kernel
def shrink_failing(skel: Skeleton, factor: float, roots: Index, values_out: Array, memory: Memory) -> None:
    """Scale values (nd), a step or a share of it, of every avatar of which a link failed; `roots` (nl) of the links' trees."""
    for m in range(skel.kind.shape[0]):
        for link in range(skel.kind.shape[0]):
            if memory.touched[link] and roots[link] == roots[m]:
                for j in range(skel.first_dof[m], skel.first_dof[m + 1]):
                    values_out[j] *= factor
                break


@kernel
def stop_failing(skel: Skeleton, memory_out: Memory) -> None:
    """No step of the joints that move a failing link."""
    for m in range(skel.kind.shape[0]):
        if moves_failing(skel, memory_out, m):
            for j in range(skel.first_dof[m], skel.first_dof[m + 1]):
                memory_out.rows.x[j] = 0.0


@kernel
def list_failing(first: int, memory_out: Memory) -> None:
    """List the failing pairs, so that they have a row in the next attempt before anything fails."""
    for k in range(memory_out.pairs.marks[FAILED]):
        list_pair(memory_out.pairs.failed[k, 0], memory_out.pairs.failed[k, 1], first, memory_out)


@kernel
def attempt(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, memory_out: Memory
) -> tuple[int, bool]:
    """Solve and certify with growing rows; return failures and whether the budget is spent."""
    r = memory_out.rows
    rows_of_listed(geo, skel, poses, settings, memory_out)
    spent, failed, tolerance = False, 0, 0.1 * settings.least_gap
    goal = memory_out.goal
    mode = goal.closeness.mode
    mode[COUPLED] = 0.0
    for round_ in range(settings.corrections + 1):
        # limits are in the way as contacts are: each joint clipped by itself is not the nearest posture
        if mode[COUPLED] == 0.0 and memory_out.flags[CLOSE] > 0.0 and (mode[BEYOND] > 0.0 or hindered(goal.step, r)):
            # where nothing is in the way the straight way is taken: it ends at the tracker's posture, and no metric is needed
            seek_the_nearest(geo, skel, posture, poses, settings, memory_out)
            if mode[BEYOND] > 0.0:
                keep_limits(skel, posture, memory_out)
        memory_out.counts[SWEEPS] += nearest_step(memory_out.goal, r, settings.sweeps, tolerance)
        memory_out.counts[ITERATIONS] += 1
        within = False
        if mode[COUPLED] > 0.0:
            # what pushes one joint turns others, over limits too: known before anything is placed or certified
            memory_out.flags[ADDING] = 1.0
            within = beyond_limits(skel, posture, memory_out) == 0
            if not within:
                memory_out.counts[SWEEPS] += nearest_step(memory_out.goal, r, settings.sweeps, tolerance)
        if foresee(geo, skel, posture, poses, settings, round_ < settings.corrections, memory_out):
            continue
        memory_out.counts[FORWARDS] += 1
        place_links(geo, skel, memory_out.trial)
        if creeps(memory_out):
            slow_down(geo, skel, posture, poses, memory_out)
            within = False
        spent = work_done(memory_out) > budget(settings, memory_out)
        last = spent or round_ == settings.corrections
        memory_out.flags[ADDING] = 0.0 if last else 1.0
        failed = check(geo, skel, posture, poses, settings, within, memory_out)
        if failed == 0 or last:
            break
    return failed, spent


@kernel
def certifies(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, memory_out: Memory
) -> bool:
    """Try a step that was shortened: whether the trial is free, slowed down where it creeps."""
    try_step(geo, skel, posture, memory_out)
    if creeps(memory_out):
        slow_down(geo, skel, posture, poses, memory_out)
    return bool(check(geo, skel, posture, poses, settings, False, memory_out) == 0)


@kernel
def back_off(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, memory_out: Memory
) -> None:
    """Shorten the step of avatars that fail until the trial certifies; at last stay where everything is known to be free."""
    memory_out.counts[BACKED] += 1
    memory_out.flags[ADDING] = 0.0
    for k in range(BACK_OFFS + 2):
        if k < BACK_OFFS:
            shrink_failing(skel, BACK_OFF, memory_out.goal.closeness.root, memory_out.rows.x, memory_out)
        else:
            stop_failing(skel, memory_out)
        if certifies(geo, skel, posture, poses, settings, memory_out):
            return
    stay(geo, skel, posture, memory_out)


@kernel
def go_less_far(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, memory_out: Memory
) -> None:
    """Shorten a step that was certified but loses merit, in the last attempt; stay if that helps nothing."""
    memory_out.flags[ADDING] = 0.0
    for j in range(memory_out.rows.x.shape[0]):
        memory_out.rows.x[j] *= SHRINK
    if not loses_merit(settings, memory_out) and certifies(geo, skel, posture, poses, settings, memory_out):
        return
    stay(geo, skel, posture, memory_out)


@kernel
def stay(geo: Geometry, skel: Skeleton, posture: Posture, memory_out: Memory) -> None:
    """The empty step: the trial is the checked state."""
    memory_out.counts[HELD] += 1
    memory_out.rows.x[:] = 0.0
    try_step(geo, skel, posture, memory_out)


@kernel
def adopt(geo: Geometry, skel: Skeleton, posture_out: Posture, poses_out: Poses, memory_out: Memory) -> None:
    """Make the trial the checked state."""
    memory_out.pairs.marks[NOW] += 1
    note_step(skel, memory_out)
    take(skel, posture_out, memory_out.rows.x)
    trial, here = memory_out.trial, memory_out.goal.closeness.here
    for b in range(skel.first, trial.position.shape[0]):
        for i in range(3):
            poses_out.position[b, i] = trial.position[b, i]
            here[b - skel.first, i] = trial.position[b, i]
            for k in range(3):
                poses_out.rotation[b, i, k] = trial.rotation[b, i, k]
        for i in range(6):
            poses_out.hulls[b, i] = trial.hulls[b, i]
    first = geo.first_shape[skel.first]
    for s in range(first, geo.body.shape[0]):
        for i in range(6):
            poses_out.boxes[s, i] = trial.boxes[s, i]
    for v in range(geo.shapes.start[first], trial.vertices.shape[0]):
        for i in range(3):
            poses_out.vertices[v, i] = trial.vertices[v, i]
    for j in range(memory_out.axes.shape[0]):
        for i in range(3):
            memory_out.axes[j, i] = memory_out.trial_axes[j, i]


@kernel
def step(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, memory_out: Memory
) -> tuple[float, float, float]:
    """One step; return its largest component, and the rotation and translation that were still to go."""
    goal, r = memory_out.goal, memory_out.rows
    first = geo.first_shape[skel.first]
    memory_out.counts[STEPS] += 1
    failed, to_turn, to_move, accepted = 0, 0.0, 0.0, False
    goal.trust[0], goal.share[:] = 1.0, 1.0
    if memory_out.flags[PRESSED] > 0.0:
        goal.trust[0] = min(1.0, PRESSED_TRUST + PRESSED_GAIN * memory_out.flags[TRACKER_SPEED])
    for round_ in range(settings.attempts):
        to_turn, to_move = aim(skel, posture, settings, goal)
        scale_step(goal)
        memory_out.flags[SOFT] = 1.0 if round_ > 0 else 0.0
        failed, spent = attempt(geo, skel, posture, poses, settings, memory_out)
        weighed = settings.merit > 0.0 and (r.size[COUNT] > 0 or goal.closeness.mode[COUPLED] > 0.0)
        if failed == 0 and not (weighed and loses_merit(settings, memory_out)):
            accepted = True
            break
        if failed == 0:
            goal.share[:] = SHRINK
        else:
            list_failing(first, memory_out)
            shrink_failing(skel, SHRINK, goal.closeness.root, goal.share, memory_out)
        if spent:
            break
    list_rows(first, memory_out)
    if not accepted:
        if failed == 0:
            go_less_far(geo, skel, posture, poses, settings, memory_out)
        else:
            back_off(geo, skel, posture, poses, settings, memory_out)
    largest = 0.0
    for j in range(r.x.shape[0]):
        largest = max(largest, abs(r.x[j]))
    note_forces(geo, skel, r, goal.closeness)
    forget_idle_pairs(first, IDLE_STEPS, memory_out)
    adopt(geo, skel, posture, poses, memory_out)
    return largest, to_turn, to_move
