"""Motion budget: how far joints, roots and link origins may move in a frame, beyond what the target itself moves.

A rate limit (slew rate): what the target moved in this frame plus a catch-up speed times the frame time. A person sees a limb that
turns faster than the own one as a jump. The catch-up part halves for every `settle_time` of rest, so whoever holds still is shown
no limb that wanders; what converges at all has then long arrived.
"""

from avatarsim.ik.kinematics import parts_of
from avatarsim.ik.state import Avatars, Budget, IkScratch
from avatarsim.kernel import kernel
from avatarsim.settings import IkSettings
from avatarsim.spatial.vec3 import norm, row, sub
from avatarsim.world.geometry import Array, Poses
from avatarsim.world.skeleton import FREE, HINGES, Posture, Skeleton


@kernel
def catch_up_share(settings: IkSettings, rest: float) -> float:
    """Share of the catch-up speeds that is left after `rest` seconds of rest: a half for each settle time beyond the first."""
    return float(0.5 ** max(0.0, rest / settings.settle_time - 1.0))


@kernel
def open_budget(
    skel: Skeleton, avatars: Avatars, avatar: int, settings: IkSettings, dt: float, rest: float, own: Array, before: Array,
    now: Array, budget_out: Budget,
) -> None:
    """Fill an avatar's budget. own (nd): the target's motion in this frame; before, now (nl, 3): its link origins [m]."""
    b, share = budget_out, catch_up_share(settings, rest) * dt
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        moved, turned = parts_of(skel, link, own)
        b.move[link] = moved + settings.catch_up_move * share
        b.turn[link] = turned + settings.catch_up_turn * share
        b.way[link] = norm(sub(row(now, link), row(before, link))) + settings.catch_up_move * share
        b.moved[link], b.turned[link], b.gone[link] = 0.0, 0.0, 0.0


@kernel
def bound_step(skel: Skeleton, avatars: Avatars, avatar: int, posture: Posture, budget: Budget, scratch_out: IkScratch) -> None:
    """Bounds low, high (nd) of a step: what is left of the budget, and the limits of hinges."""
    low, high = scratch_out.low, scratch_out.high
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        d, last = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == FREE:
            left = max(0.0, budget.move[link] - budget.moved[link])
            for j in range(d, d + 3):
                low[j], high[j] = -left, left
            d += 3
        left = max(0.0, budget.turn[link] - budget.turned[link])
        for j in range(d, last):
            low[j], high[j] = -left, left
        if skel.kind[link] == HINGES:
            for j in range(d, last):
                # a hinge beyond its limit by rounding may stay, and must not be forced
                low[j] = min(0.0, max(low[j], skel.limits[j, 0] - posture.angle[j]))
                high[j] = max(0.0, min(high[j], skel.limits[j, 1] - posture.angle[j]))


@kernel
def share_within(
    skel: Skeleton, avatars: Avatars, avatar: int, budget: Budget, step: Array, poses: Poses, trial: Poses
) -> float:
    """The largest share of an avatar's step (nd), from `poses` to the trial, that the budget holds: of joints, roots and origins."""
    b, share = budget, 1.0
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        moved, turned = parts_of(skel, link, step)
        share = min(share, share_of(b.move[link] - b.moved[link], moved))
        share = min(share, share_of(b.turn[link] - b.turned[link], turned))
        share = min(share, share_of(b.way[link] - b.gone[link], way_of(skel, link, poses, trial)))
    return share


@kernel
def way_of(skel: Skeleton, link: int, poses: Poses, trial: Poses) -> float:
    """How far [m] the origin of a link is carried."""
    return norm(sub(row(trial.position, skel.first + link), row(poses.position, skel.first + link)))


@kernel
def share_of(left: float, wanted: float) -> float:
    """The share of what is wanted that is left."""
    return 1.0 if wanted <= left else max(0.0, left) / wanted


@kernel
def spend(
    skel: Skeleton, avatars: Avatars, avatar: int, step: Array, poses: Poses, trial: Poses, budget_out: Budget
) -> None:
    """Note that an avatar takes a step (nd), from `poses` to the trial."""
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        moved, turned = parts_of(skel, link, step)
        budget_out.moved[link] += moved
        budget_out.turned[link] += turned
        budget_out.gone[link] += way_of(skel, link, poses, trial)
