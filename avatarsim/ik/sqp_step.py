"""One step of sequential quadratic programming: model, QP, certificate (Nocedal and Wright 2006, chapter 18).

A pair that the certificate refuses becomes a row at the trial, a second-order correction, and the QP is solved again. If the step
is still refused its goal is drawn nearer, for all of an avatar by one factor, and the QP is solved with corrections once more
(backtracking with a second-order correction at each trial; section 18.3): a limb that is cut alone leaves the line to the minimum
and the rest of the body makes up for it, frame by frame, to and fro.

Contact forces of the last step, multipliers times normals: forces on each link, and how they bend the Lagrangian.
"""

from avatarsim.ik.certify import carry_trial, certify
from avatarsim.ik.constraints import add_touching, along_row, is_solved_for, keep_touching, touch
from avatarsim.ik.couplings import share_budget
from avatarsim.ik.friction import FRICTION, add_friction
from avatarsim.ik.gaps import least_gap
from avatarsim.ik.inertia import note_step, resist, resist_straight, shorten_own
from avatarsim.ik.kinematics import place_avatar, take_step, tangent_error, try_step
from avatarsim.ik.motion_budget import bound_step, keep_budget, spend
from avatarsim.ik.objective import model, stretch
from avatarsim.ik.qp import CUTS, solve_qp
from avatarsim.ik.state import (
    ADOPTED,
    BACKED,
    FORWARDS,
    HELD,
    OUT_OF_WORK,
    PAIRS,
    PRODUCTS,
    QPS,
    QUERIES,
    ROWS,
    STEPS,
    Avatars,
    ConstraintRows,
    IkScratch,
    IkState,
    Rig,
    RowKind,
)
from avatarsim.ik.target import largest
from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import follow_leaders
from avatarsim.model.geometry import Array, Poses
from avatarsim.model.skeleton import Posture, Skeleton
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import add, put_row, row, scale
from avatarsim.tolerances import FINE

CONTACT = int(RowKind.CONTACT)


@kernel
def forget_forces(avatars: Avatars, avatar: int, state_out: IkState) -> None:
    """Set the contact forces on the links of an avatar to zero."""
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        put_row(state_out.force, link, (0.0, 0.0, 0.0))
        state_out.curvature[link] = 0.0


@kernel
def note_forces(rig: Rig, rows: ConstraintRows, state_out: IkState) -> None:
    """Add the forces of the contact rows of a solved step on each link."""
    s = state_out
    for k in range(rows.used[0]):
        if (rows.kind[k] != CONTACT and rows.kind[k] != FRICTION) or rows.multiplier[k] == 0.0:
            continue
        for side in range(2):
            link = rig.geo.body[rows.pair[k, side]] - rig.skel.first
            if link < 0:
                continue
            push = rows.multiplier[k] / s.tracking.share[rig.avatars.avatar[link]]
            force = scale(row(rows.normal, k), push if side == 0 else -push)
            arm = (rows.arm[k, 3 * side], rows.arm[k, 3 * side + 1], rows.arm[k, 3 * side + 2])
            put_row(s.force, link, add(row(s.force, link), force))
            s.curvature[link] += stretch(force, arm)


BACK_OFF, ATTEMPTS = 0.25, 5
"""Factor by which the goal of a step that is still refused draws nearer, from the third attempt on, and how many attempts there
are before the avatar stays. Fewer, or nearer to 1: it stays more often; more: slowest frames take longer."""


@kernel
def work_done(scratch: IkScratch) -> int:
    """Return the work of this frame so far, in units of about a microsecond; counted, so that results repeat.

    The weights were fitted to the times of frames of 75 hostile returns of three avatars: within a fifth for half of them."""
    c = scratch.counts
    return int(c[QUERIES] + c[PAIRS] + 3 * c[FORWARDS] + c[ROWS] + c[PRODUCTS] // 32)


@kernel
def sqp_step(
    rig: Rig, settings: PostureSettings, posture_out: Posture, poses_out: Poses, first: int, last: int, most_work: int,
    state_out: IkState, scratch_out: IkScratch,
) -> float:
    """Take one certified step of members first .. last; return its largest part [rad or m]."""
    s, state = scratch_out, state_out
    s.counts[STEPS] += last - first
    state.pairs.step[0] += 1
    failed = 1
    for m in range(first, last):
        avatar = s.members[m]
        state.tracking.has_model[avatar] = 0
        tangent_error(rig, avatar, posture_out, s.target, s.objective.error)
        shorten_own(rig, avatar, state.tracking.reach[avatar], s.objective)
        bound_step(rig, avatar, posture_out, state.budget, s)
    for attempt in range(ATTEMPTS):
        if attempt == 2:
            s.counts[BACKED] += 1
        for m in range(first, last if attempt >= 2 else first):
            if state.tracking.has_failed[s.members[m]] > 0:
                state.tracking.has_arrived[s.members[m]] = 0
                scale_step(rig.avatars, s.members[m], BACK_OFF, s.objective.newton)
        failed = try_qp(rig, settings, posture_out, poses_out, first, last, attempt > 0, most_work, state, s)
        if failed == 0:
            break
        for k in range(s.failed.used[0]):
            touch(s.failed.pair[k, 0], s.failed.pair[k, 1], state.touching)
        if work_done(s) > most_work:
            s.counts[OUT_OF_WORK] += 1
            break
    keep_touching(rig, state, s)
    if failed > 0:
        hold_failed(rig, settings, posture_out, poses_out, first, last, state, s)
    note_contacts(rig, first, last, state, s)
    return commit_step(rig, first, last, posture_out, poses_out, state, s)


@kernel
def try_qp(
    rig: Rig, settings: PostureSettings, posture: Posture, poses: Poses, first: int, last: int, is_soft: bool, most_work: int,
    state_out: IkState, scratch_out: IkScratch,
) -> int:
    """Solve and certify with growing rows; return the number of failures left."""
    s, failed, tolerance = scratch_out, 0, FINE * least_gap(settings.stand_off)
    add_touching(rig, settings, is_soft, poses, state_out, s)
    for round_ in range(CUTS + 1):
        for _ in range(CUTS):
            choose_step(rig, settings, poses, first, last, tolerance, state_out, s)
            s.counts[QPS] += 1
            if not carry_trial(rig, settings, posture, poses, first, last, is_soft, state_out, s):
                break
        for m in range(first, last):
            state_out.tracking.is_certified[s.members[m]] = 0
            place_avatar(rig, s.members[m], s.trial)
        s.counts[FORWARDS] += last - first
        is_last = round_ == CUTS or work_done(s) > most_work
        failed = certify(rig, settings, posture, poses, first, last, not is_last, is_soft, state_out, s)
        if failed == 0 or is_last:
            break
    return failed


@kernel
def choose_step(
    rig: Rig, settings: PostureSettings, poses: Poses, first: int, last: int, tolerance: float, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """Choose the straight way to the target where no row is in its way: there it is the least of the objective, and no metric is
    needed. Else the QP's step."""
    s, state = scratch_out, state_out
    if state.tracking.has_model[s.members[first]] == 0:
        is_legal = True
        for m in range(first, last):
            straight_step(rig, s.members[m], state, s)
            is_legal = is_legal and state.tracking.is_legal[s.members[m]] > 0
            state.tracking.is_straight[s.members[m]] = 1
        if is_legal and not breaks_rows(rig.avatars, s):
            return
        for m in range(first, last):
            model(rig, s.members[m], state, poses, s.objective)
        add_friction(rig, settings, last - first, poses, state, s)
        for m in range(first, last):
            resist(rig, s.members[m], state, s.objective)
            state.tracking.has_model[s.members[m]], state.tracking.has_arrived[s.members[m]] = 1, 0
            state.tracking.is_straight[s.members[m]] = 0
    solve_qp(rig, first, last, tolerance, state, s)


@kernel
def straight_step(rig: Rig, avatar: int, state_out: IkState, scratch_out: IkScratch) -> None:
    """Set the way to the target, with inertia, each joint and root as far along its own as the budget lets it go."""
    skel, avatars = rig.skel, rig.avatars
    step, error, arrives = scratch_out.step, scratch_out.objective.error, state_out.tracking.is_legal[avatar]
    for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
        step[j] = error[j]
    resist_straight(avatars, avatar, state_out, scratch_out)
    first, end = avatars.first_dof[avatar], avatars.first_dof[avatar + 1]
    keep_budget(rig, avatar, state_out.budget, False, step)
    share_budget(skel, first, end, step)
    for j in range(first, end):
        if step[j] != error[j]:
            arrives = 0
    follow_leaders(skel, first, end, step)
    state_out.tracking.has_arrived[avatar] = arrives


@kernel
def breaks_rows(avatars: Avatars, scratch: IkScratch) -> bool:
    """Return True if the step breaks a row."""
    r = scratch.rows
    for k in range(r.used[0]):
        if not (along_row(avatars, k, scratch.step, r.jacobian, r) >= r.bound[k]):
            return True
    return False


@kernel
def scale_step(avatars: Avatars, avatar: int, factor: float, step_out: Array) -> None:
    """Scale the degrees of an avatar in a step (nd)."""
    for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
        step_out[j] *= factor


@kernel
def hold_failed(
    rig: Rig, settings: PostureSettings, posture: Posture, poses: Poses, first: int, last: int, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """Hold avatars that fail where they are, where everything is known to be free, until the trial of the others certifies."""
    avatars = rig.avatars
    s = scratch_out
    for _ in range(last - first):
        for m in range(first, last):
            avatar = s.members[m]
            if state_out.tracking.has_failed[avatar] > 0:
                state_out.tracking.has_arrived[avatar], state_out.tracking.is_certified[avatar] = 0, 0
                s.counts[HELD] += 1
                scale_step(avatars, avatar, 0.0, s.step)
                try_step(rig, avatar, posture, s)
        if certify(rig, settings, posture, poses, first, last, False, False, state_out, s) == 0:
            return
    for m in range(first, last):
        state_out.tracking.has_arrived[s.members[m]] = 0
        scale_step(avatars, s.members[m], 0.0, s.step)
        try_step(rig, s.members[m], posture, s)


@kernel
def note_contacts(rig: Rig, first: int, last: int, state_out: IkState, scratch: IkScratch) -> None:
    """Keep the active contacts of an island, and their forces on its links: for the next step, and for the coupling."""
    c, r, kept = state_out.contacts, scratch.rows, 0
    for k in range(c.used[0]):
        if not is_solved_for(rig, c.pair[k, 0], c.pair[k, 1], scratch):
            c.pair[kept, 0], c.pair[kept, 1], c.multiplier[kept] = c.pair[k, 0], c.pair[k, 1], c.multiplier[k]
            put_row(c.normal, kept, row(c.normal, k))
            kept += 1
    for m in range(first, last):
        forget_forces(rig.avatars, scratch.members[m], state_out)
    for k in range(r.used[0]):
        if r.kind[k] == CONTACT and r.multiplier[k] > 0.0 and kept < c.multiplier.shape[0]:
            c.pair[kept, 0], c.pair[kept, 1], c.multiplier[kept] = r.pair[k, 0], r.pair[k, 1], r.multiplier[k]
            put_row(c.normal, kept, row(r.normal, k))
            kept += 1
    c.used[0] = kept
    note_forces(rig, r, state_out)


@kernel
def commit_step(
    rig: Rig, first: int, last: int, posture_out: Posture, poses_out: Poses, state_out: IkState, scratch_out: IkScratch
) -> float:
    """Make the trial of members first .. last the shown state; return the largest part of their step [rad or m]."""
    avatars = rig.avatars
    s, most = scratch_out, 0.0
    for m in range(first, last):
        avatar = s.members[m]
        low, high = avatars.first_dof[avatar], avatars.first_dof[avatar + 1]
        note_step(avatars, avatar, s.step, s.objective.target_motion, state_out)
        for j in range(low, high):
            s.objective.target_motion[j] = 0.0
        moved = largest(s.step, low, high)
        most = max(most, moved)
        if moved == 0.0:
            continue
        spend(rig, avatar, s.step, state_out.budget)
        take_step(rig, avatar, s.step, posture_out)
        copy_poses(rig, avatar, s.trial, poses_out)
        for j in range(low, high):
            put_row(state_out.axes, j, row(s.axes, j))
    if most > 0.0:
        note_trail(rig.skel, s)
    return most


@kernel
def copy_poses(rig: Rig, avatar: int, trial: Poses, poses_out: Poses) -> None:
    """Copy the poses of an avatar's links, shapes and all."""
    geo, skel, avatars = rig.geo, rig.skel, rig.avatars
    low, high = skel.first + avatars.first_link[avatar], skel.first + avatars.first_link[avatar + 1]
    for b in range(low, high):
        for i in range(3):
            poses_out.position[b, i] = trial.position[b, i]
            for k in range(3):
                poses_out.rotation[b, i, k] = trial.rotation[b, i, k]
        for i in range(6):
            poses_out.hulls[b, i] = trial.hulls[b, i]
    for piece in range(geo.first_shape[low], geo.first_shape[high]):
        for i in range(6):
            poses_out.boxes[piece, i] = trial.boxes[piece, i]
    for v in range(geo.shapes.start[geo.first_shape[low]], geo.shapes.start[geo.first_shape[high]]):
        for i in range(3):
            poses_out.vertices[v, i] = trial.vertices[v, i]


@kernel
def note_trail(skel: Skeleton, scratch_out: IkScratch) -> None:
    """Count the step that was adopted, and keep its poses if the frame is recorded."""
    s = scratch_out
    k = s.counts[ADOPTED]
    s.counts[ADOPTED] = k + 1
    if k >= s.trail.shape[0]:
        return
    for link in range(skel.kind.shape[0]):
        for i in range(3):
            s.trail[k, link, i] = s.trial.position[skel.first + link, i]
            for j in range(3):
                s.trail[k, link, 3 + 3 * i + j] = s.trial.rotation[skel.first + link, i, j]
