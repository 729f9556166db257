"""One frame of the posture solver, on one screen: target, budgets, islands, steps. See docs/posture.md."""

from avatarsim.ik.broad_phase import forget_near, form_islands, notice_bodies, sweep_all
from avatarsim.ik.gaps import least_gap
from avatarsim.ik.inertia import carry_momentum
from avatarsim.ik.sqp_step import sqp_step, work_done
from avatarsim.ik.state import IkScratch, IkState, Rig
from avatarsim.ik.target import clip_to_limits, open_budgets
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Index
from avatarsim.model.geometry import Poses
from avatarsim.model.skeleton import Posture
from avatarsim.settings import PostureSettings

ARRIVED = 3e-2
"""[rad or m] a step smaller than this ends the frame: the rest is left for the next one. Larger: contacts are followed late;
smaller: second steps that show nothing."""


@kernel
def begin_frame(
    rig: Rig, settings: PostureSettings, tracker: Posture, dt: float, moving: Index, posture: Posture, poses: Poses,
    state_out: IkState, scratch_out: IkScratch,
) -> None:
    """Copy poses of moved bodies, clip the target, and open the budgets of a frame of dt [s].

    dt = 0: once more in the same frame, after loose bodies have moved on; the rest of its budget is used.
    moving (nb): 1 for bodies that may have moved since the last call; empty if that is not known.
    """
    s, state = scratch_out, state_out
    has_changed = notice_bodies(rig.geo, rig.skel, poses, moving, s)
    if has_changed:
        forget_near(state)
    sweep_all(rig, poses, least_gap(settings.stand_off), s)
    clip_to_limits(rig, tracker, state.tracking, s.target)
    if dt > 0.0:
        s.counts[:] = 0
    form_islands(rig, state, s)
    if dt > 0.0:
        open_budgets(rig, settings, tracker, dt, has_changed, state, s)
        carry_momentum(rig, settings, dt, posture, state, s)


@kernel
def solve(
    rig: Rig, settings: PostureSettings, posture_out: Posture, poses_out: Poses, state_out: IkState, scratch_out: IkScratch
) -> None:
    """Move the posture towards the target by certified steps within the rest of the frame's budget."""
    s, state = scratch_out, state_out
    first, count = 0, rig.avatars.first_link.shape[0] - 1
    while first < count:
        last = first + 1
        while last < count and state.tracking.island[s.members[last]] == state.tracking.island[s.members[first]]:
            last += 1
        activate(first, last, s)
        # an island that spends less leaves the rest to those after it
        most_work = work_done(s) + (settings.work - work_done(s)) * (last - first) // (count - first)
        for _ in range(settings.steps):
            moved = sqp_step(rig, settings, posture_out, poses_out, first, last, most_work, state, s)
            if moved < ARRIVED or went_straight(first, last, state, s) or work_done(s) >= most_work:
                break
        first = last


@kernel
def activate(first: int, last: int, scratch_out: IkScratch) -> None:
    """Solve for members first .. last; all other avatars stay where they are meanwhile."""
    scratch_out.is_active[:] = 0
    for m in range(first, last):
        scratch_out.is_active[scratch_out.members[m]] = 1


@kernel
def went_straight(first: int, last: int, state: IkState, scratch: IkScratch) -> bool:
    """Return True if the last step of all members first .. last was straight; a frame has one straight step at most."""
    for m in range(first, last):
        if state.tracking.is_straight[scratch.members[m]] == 0:
            return False
    return True
