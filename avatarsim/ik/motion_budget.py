"""Motion budget: how far joints and roots may move in a frame, beyond the motion of the target itself.

A rate limit (slew rate): the target's motion in this frame plus a catch-up speed times the frame time. A person sees a limb that
turns faster than the own one as a jump. The catch-up speed falls with the target's own, low-passed: at a target at rest no limb
wanders; a limb that converges at all has then long arrived.
"""

from math import inf

from avatarsim.ik.couplings import fold_bounds
from avatarsim.ik.kinematics import longest_part, parts_of
from avatarsim.ik.state import Budget, IkScratch, Rig
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Array
from avatarsim.model.skeleton import FREE, SLIDE, Posture, has_angles
from avatarsim.settings import PostureSettings

AT_REST = 0.06
"""[rad/s or m/s] a target that is slower holds still, and the catch-up speed falls in proportion; an avatar that is slower and on
its straight way ends at its target. A millimetre in a frame of 1/60 s, the tremble of a hand that is kept still."""


SLACK = 0.15
"""Share of the catch-up motion by which a ball or a root may leave its budget in a QP before a plane cuts that off: each is one
more solve. A step that still exceeds it is shortened at the end."""


@kernel
def open_budget(
    rig: Rig, avatar: int, settings: PostureSettings, dt: float, speed: float, tracker_motion: Array, target_motion_out: Array,
    budget_out: Budget,
) -> None:
    """Fill an avatar's budget; speed [rad/s or m/s] is the low-passed one of the fastest target.

    tracker_motion, target_motion (nd) are those of the tracker and of the clipped target in this frame. Joints of the latter turn
    no farther than those of the tracker: beyond a cone a small turn of the tracker may send the clipped target around it."""
    skel, avatars = rig.skel, rig.avatars
    b, share = budget_out, min(1.0, speed / AT_REST) * dt
    b.slack[0], b.slack[1] = SLACK * settings.catch_up_move * dt, SLACK * settings.catch_up_turn * dt
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        moved, turned = parts_of(skel, link, target_motion_out)
        _, turned_by_tracker = parts_of(skel, link, tracker_motion)
        if turned > turned_by_tracker:
            first = skel.first_dof[link] + (3 if skel.kind[link] == FREE else 0)
            scale_by(first, skel.first_dof[link + 1], turned_by_tracker / turned, target_motion_out)
            turned = turned_by_tracker
        b.move[link] = moved + settings.catch_up_move * share
        b.turn[link] = turned + settings.catch_up_turn * share
        b.moved[link], b.turned[link] = 0.0, 0.0


@kernel
def bound_step(rig: Rig, avatar: int, posture: Posture, budget: Budget, scratch_out: IkScratch) -> None:
    """Compute bounds low, high (nd) of a step: the rest of the budget, and the limits of hinges and slides."""
    skel, avatars = rig.skel, rig.avatars
    low, high = scratch_out.low, scratch_out.high
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        d, last = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == FREE:
            left = max(0.0, budget.move[link] - budget.moved[link])
            for j in range(d, d + 3):
                low[j], high[j] = -left, left
            d += 3
        left = max(0.0, budget.turn[link] - budget.turned[link])
        if skel.kind[link] == SLIDE:
            left = max(0.0, budget.move[link] - budget.moved[link])
        for j in range(d, last):
            low[j], high[j] = -left, left
        if has_angles(skel, link):
            for j in range(d, last):
                # a joint beyond its limit by rounding may stay, and must not be forced
                low[j] = min(0.0, max(low[j], skel.limits[j, 0] - posture.angle[j]))
                high[j] = max(0.0, min(high[j], skel.limits[j, 1] - posture.angle[j]))
    fold_bounds(skel, avatars.first_dof[avatar], avatars.first_dof[avatar + 1], scratch_out)


@kernel
def spend(rig: Rig, avatar: int, step: Array, budget_out: Budget) -> None:
    """Note that an avatar has taken a step (nd)."""
    avatars = rig.avatars
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        moved, turned = parts_of(rig.skel, link, step)
        budget_out.moved[link] += moved
        budget_out.turned[link] += turned


@kernel
def keep_budget(rig: Rig, avatar: int, budget: Budget, has_slack: bool, step_out: Array) -> None:
    """Shorten a step (nd) to the rest of the budget, or to its slack beyond: root and joints each by a factor of their own."""
    skel, avatars = rig.skel, rig.avatars
    b, slack = budget, 1.0 if has_slack else 0.0
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        moved, turned = parts_of(skel, link, step_out)
        d, last = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == FREE:
            scale_by(d, d + 3, share_of(b.move[link] - b.moved[link] + slack * b.slack[0], moved), step_out)
            d += 3
        elif skel.kind[link] == SLIDE:
            scale_by(d, last, share_of(b.move[link] - b.moved[link] + slack * b.slack[0], moved), step_out)
            continue
        scale_by(d, last, share_of(b.turn[link] - b.turned[link] + slack * b.slack[1], turned), step_out)


@kernel
def share_of(left: float, wanted: float) -> float:
    """Return the share of the wanted motion that is left."""
    return 1.0 if wanted <= max(left, 0.0) else max(left, 0.0) / wanted


@kernel
def scale_by(first: int, last: int, factor: float, step_out: Array) -> None:
    """Scale degrees first .. last of a step."""
    if factor < 1.0:
        for j in range(first, last):
            step_out[j] *= factor


@kernel
def time_of(rig: Rig, settings: PostureSettings, avatar: int, step: Array) -> float:
    """Return the time [s] that the catch-up speeds take for a step (nd)."""
    return longest_part(rig, avatar, step, settings.catch_up_move, settings.catch_up_turn)


@kernel
def budgets_of(rig: Rig, avatar: int, step: Array, budget: Budget) -> float:
    """Return how many budgets of a frame a step (nd) is long: of the joint or root of which it is most."""
    avatars = rig.avatars
    most = 0.0
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        moved, turned = parts_of(rig.skel, link, step)
        if moved > 0.0:
            most = max(most, moved / budget.move[link] if budget.move[link] > 0.0 else inf)
        if turned > 0.0:
            most = max(most, turned / budget.turn[link] if budget.turn[link] > 0.0 else inf)
    return most
