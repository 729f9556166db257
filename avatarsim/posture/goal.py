"""The way from the checked posture to the tracker's, capped to what one step may do (coach and trainee, method `default`)."""

from math import sqrt

from avatarsim.kernel import kernel
from avatarsim.posture.limits import has_cone, inside_cone
from avatarsim.posture.workspace import Goal
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, put_columns, step_between
from avatarsim.spatial.vec3 import norm
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton


@kernel
def clip_to_limits(skel: Skeleton, tracker: Posture, goal_out: Goal) -> None:
    """Copy the tracker's posture into the goal, each joint at the nearest place inside its limits."""
    inside = goal_out.tracker
    for link in range(skel.kind.shape[0]):
        kind = skel.kind[link]
        for k in range(3):
            inside.root[link, k] = tracker.root[link, k]
        turn = columns(tracker.turn, link)
        if kind == BALL and has_cone(skel, link):
            turn = inside_cone(skel, link, turn)
        put_columns(inside.turn, link, turn)
        if kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                inside.angle[j] = min(max(tracker.angle[j], skel.limits[j, 0]), skel.limits[j, 1])


@kernel
def aim(skel: Skeleton, posture: Posture, settings: PostureSettings, goal_out: Goal) -> tuple[float, float]:
    """Fill full, step, low and high of the goal; return the largest rotation [rad] and translation [m] still to go.

    `step` is capped per joint by its trust; `low` and `high` keep a contact from throwing a joint further than
    `stray_turn` off its own way.
    """
    g = goal_out
    farthest_turn, farthest_move = 0.0, 0.0
    for link in range(skel.kind.shape[0]):
        d, kind = skel.first_dof[link], skel.kind[link]
        if kind == FREE:
            for k in range(3):
                g.full[d + k] = g.tracker.root[link, k] - posture.root[link, k]
            way = sqrt(g.full[d] ** 2 + g.full[d + 1] ** 2 + g.full[d + 2] ** 2)
            farthest_move = max(farthest_move, way)
            cap(g, d, d + 3, way, settings.move_cap, settings.stray_move)
            d += 3
        if kind == FREE or kind == BALL:
            turn = step_between(columns(posture.turn, link), columns(g.tracker.turn, link))
            for k in range(3):
                g.full[d + k] = turn[k]
            farthest_turn = max(farthest_turn, norm(turn))
            cap(g, d, d + 3, norm(turn), settings.turn_cap, settings.stray_turn)
        elif kind == HINGES:
            for j in range(d, skel.first_dof[link + 1]):
                g.full[j] = g.tracker.angle[j] - posture.angle[j]
                farthest_turn = max(farthest_turn, abs(g.full[j]))
                cap(g, j, j + 1, abs(g.full[j]), settings.turn_cap, settings.stray_turn)
                g.low[j] = max(g.low[j], skel.limits[j, 0] - posture.angle[j])
                g.high[j] = min(g.high[j], skel.limits[j, 1] - posture.angle[j])
    return farthest_turn, farthest_move


@kernel
def cap(goal_out: Goal, first: int, last: int, way: float, most: float, stray: float) -> None:
    """Shorten `full` to `most` times the joint's trust, together for the degrees first .. last; bounds around it."""
    trust = goal_out.trust[first]
    share = 1.0 if way <= most * trust else most * trust / way
    for j in range(first, last):
        goal_out.step[j] = goal_out.full[j] * share
        goal_out.low[j] = min(0.0, goal_out.step[j]) - stray * trust
        goal_out.high[j] = max(0.0, goal_out.step[j]) + stray * trust


@kernel
def tracker_speed(skel: Skeleton, goal: Goal, goal_before_out: Posture) -> float:
    """Largest change of the tracker's posture since the last frame [rad or m], which is then remembered."""
    before, fastest = goal_before_out, 0.0
    for link in range(skel.kind.shape[0]):
        kind = skel.kind[link]
        if kind == FREE:
            for k in range(3):
                fastest = max(fastest, abs(goal.tracker.root[link, k] - before.root[link, k]))
                before.root[link, k] = goal.tracker.root[link, k]
        if kind == FREE or kind == BALL:
            now = columns(goal.tracker.turn, link)
            fastest = max(fastest, norm(step_between(columns(before.turn, link), now)))
            put_columns(before.turn, link, now)
        elif kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                fastest = max(fastest, abs(goal.tracker.angle[j] - before.angle[j]))
                before.angle[j] = goal.tracker.angle[j]
    return fastest


@kernel
def merit(goal: Goal) -> float:
    """Half the squared distance to the tracker's posture, in the metric of the weights."""
    total = 0.0
    for j in range(goal.full.shape[0]):
        total += 0.5 * goal.full[j] * goal.full[j] / goal.inverse_weight[j]
    return total


@kernel
def farthest(goal: Goal) -> float:
    """Largest part of the way to the tracker's posture [rad or m]."""
    most = 0.0
    for part in goal.full:
        most = max(most, abs(part))
    return most
