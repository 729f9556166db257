"""Following a path: ordinary tracking of a target that moves along it, a frame's budget ahead of the avatar (pure pursuit)."""

from avatarsim.ik.kinematics import parts_of, tangent_error
from avatarsim.ik.objective import locate
from avatarsim.ik.state import Avatars, IkScratch, IkState, Mode
from avatarsim.kernel import kernel
from avatarsim.planner.state import Plan
from avatarsim.planner.tree import get_node
from avatarsim.world.skeleton import Posture, Skeleton

FOLLOW_PATH = int(Mode.FOLLOW_PATH)

AHEAD = 3.0
"""Budgets of a frame that the target is ahead of the avatar. 1: kinks of the path are shown as shaking limbs; more: corners are
cut until something is in the way, and then one budget is all it is ahead."""


@kernel
def aim_along_paths(
    skel: Skeleton, avatars: Avatars, dt: float, posture: Posture, plan_out: Plan, state_out: IkState, scratch_out: IkScratch
) -> None:
    """The target of avatars that follow a path: its first node that is farther ahead. At the end it is the
    tracker's again. dt = 0: again in the same frame, the same node."""
    t = state_out.tracking
    for avatar in range(avatars.first_link.shape[0] - 1):
        if t.mode[avatar] == FOLLOW_PATH:
            aim_along_path(skel, avatars, avatar, dt, posture, plan_out, state_out, scratch_out)


@kernel
def aim_along_path(
    skel: Skeleton, avatars: Avatars, avatar: int, dt: float, posture: Posture, plan_out: Plan, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """The same of one avatar."""
    s, target = plan_out.searches, scratch_out.target
    place, last = s.place[avatar], s.length[avatar] - 1
    # held up at a corner that it cuts
    ahead = AHEAD if s.held[avatar] < 2.0 * dt else 1.0
    s.held[avatar] += dt
    get_node(skel, avatars, avatar, plan_out.path[avatar, place], plan_out, target)
    while dt > 0.0 and is_near(skel, avatars, avatar, ahead if place < last else 1.0, posture, state_out, scratch_out):
        s.held[avatar] = 0.0
        if place == last:
            break
        place += 1
        get_node(skel, avatars, avatar, plan_out.path[avatar, place], plan_out, target)
    s.place[avatar] = place
    t = state_out.tracking
    t.is_legal[avatar], t.is_located[avatar] = 1, 0
    locate(skel, avatars, avatar, target, t, scratch_out.objective)
    # the tracker's own motion does not lead along the path
    for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
        scratch_out.objective.own[j] = 0.0


@kernel
def is_near(
    skel: Skeleton, avatars: Avatars, avatar: int, ahead: float, posture: Posture, state: IkState, scratch_out: IkScratch
) -> bool:
    """Whether the target of an avatar is within so many budgets of a frame."""
    error = scratch_out.objective.error
    tangent_error(skel, avatars, avatar, posture, scratch_out.target, error)
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        moved, turned = parts_of(skel, link, error)
        if moved > ahead * state.budget.move[link] or turned > ahead * state.budget.turn[link]:
            return False
    return True
