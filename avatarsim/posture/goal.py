"""The way from the checked posture to the tracker's, capped to what one step may do (coach and trainee, method `default`)."""

from math import sqrt

from avatarsim.kernel import kernel
from avatarsim.posture.closeness import merit_of
from avatarsim.posture.limits import LEFT_ALONE, has_cone, inside_cone, surely_inside
from avatarsim.posture.workspace import BEST, BEYOND, LOCATED, Goal
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, put_columns, step_between
from avatarsim.spatial.vec3 import norm, put_row, row, sub
from avatarsim.world.geometry import Array
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton

LEAST_EXCESS = 1e-30
"""[rad^2] what an excess counts at least, so that none is rounded away."""


@kernel
def clip_to_limits(skel: Skeleton, tracker: Posture, goal_out: Goal) -> None:
    """Copy the tracker's posture into the goal: as it is, and each joint at the nearest place inside its limits."""
    g, beyond, joints = goal_out, 0.0, 0
    inside, own, mode = g.tracker, g.own, g.closeness.mode
    for link in range(skel.kind.shape[0]):
        kind = skel.kind[link]
        for k in range(3):
            inside.root[link, k] = tracker.root[link, k]
            own.root[link, k] = tracker.root[link, k]
        turn = columns(tracker.turn, link)
        put_columns(own.turn, link, turn)
        joints += skel.first_dof[link + 1] - skel.first_dof[link] if kind == HINGES else 1
        if kind == BALL and has_cone(skel, link) and not surely_inside(skel, link, turn, LEFT_ALONE):
            kept = inside_cone(skel, link, turn)
            if kept != turn:
                excess = norm(step_between(kept, turn))
                beyond += max(excess * excess, LEAST_EXCESS)
            turn = kept
        put_columns(inside.turn, link, turn)
        if kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                own.angle[j] = tracker.angle[j]
                inside.angle[j] = min(max(tracker.angle[j], skel.limits[j, 0]), skel.limits[j, 1])
                if inside.angle[j] != own.angle[j]:
                    beyond += max((own.angle[j] - inside.angle[j]) ** 2, LEAST_EXCESS)
    mode[BEYOND], mode[LOCATED], mode[BEST] = beyond / max(joints, 1), 0.0, -1.0


@kernel
def ways(skel: Skeleton, start: Posture, end: Posture, way_out: Array) -> tuple[float, float]:
    """The way (nd) from one posture to another in the tangent space; its largest rotation [rad] and translation [m]."""
    farthest_turn, farthest_move = 0.0, 0.0
    for link in range(skel.kind.shape[0]):
        d, kind = skel.first_dof[link], skel.kind[link]
        if kind == FREE:
            way = sub(row(end.root, link), row(start.root, link))
            for k in range(3):
                way_out[d + k] = way[k]
            farthest_move = max(farthest_move, norm(way))
            d += 3
        if kind == FREE or kind == BALL:
            turn = step_between(columns(start.turn, link), columns(end.turn, link))
            for k in range(3):
                way_out[d + k] = turn[k]
            farthest_turn = max(farthest_turn, norm(turn))
        elif kind == HINGES:
            for j in range(d, skel.first_dof[link + 1]):
                way_out[j] = end.angle[j] - start.angle[j]
                farthest_turn = max(farthest_turn, abs(way_out[j]))
    return farthest_turn, farthest_move


@kernel
def aim(skel: Skeleton, posture: Posture, settings: PostureSettings, goal_out: Goal) -> tuple[float, float]:
    """Fill full, step, low and high of the goal, and wanted where it is used; return the largest rotation [rad] and translation
    [m] still to go."""
    to_go = measure_way(skel, posture, goal_out)
    shorten(skel, posture, settings, goal_out.full, goal_out)
    return to_go


@kernel
def measure_way(skel: Skeleton, posture: Posture, goal_out: Goal) -> tuple[float, float]:
    """Fill full, and wanted where it is used; return what `aim` does."""
    to_go = ways(skel, posture, goal_out.tracker, goal_out.full)
    if goal_out.closeness.mode[LOCATED] > 0.0:
        want(skel, posture, goal_out)
    return to_go


@kernel
def want(skel: Skeleton, posture: Posture, goal_out: Goal) -> None:
    """Fill wanted: the way to the tracker's own posture, limits or not."""
    g = goal_out
    for j in range(g.full.shape[0]):
        g.wanted[j] = g.full[j]
    if g.closeness.mode[BEYOND] == 0.0:
        return
    for link in range(skel.kind.shape[0]):
        d, kind = skel.first_dof[link], skel.kind[link]
        if kind == BALL:
            end = columns(g.own.turn, link)
            if end != columns(g.tracker.turn, link):
                turn = step_between(columns(posture.turn, link), end)
                for k in range(3):
                    g.wanted[d + k] = turn[k]
        elif kind == HINGES:
            for j in range(d, skel.first_dof[link + 1]):
                g.wanted[j] = g.own.angle[j] - posture.angle[j]


@kernel
def shorten(skel: Skeleton, posture: Posture, settings: PostureSettings, way: Array, goal_out: Goal) -> None:
    """Fill step, low and high for a way (nd): it is capped per joint, and a contact does not throw a joint further
    than `stray_turn` off it."""
    g = goal_out
    for link in range(skel.kind.shape[0]):
        d, kind = skel.first_dof[link], skel.kind[link]
        if kind == FREE:
            cap(way, g.trust[0] * g.allowed[d], d, d + 3, settings.move_cap, settings.stray_move, g.step, g.low, g.high)
            d += 3
        if kind == FREE or kind == BALL:
            cap(way, g.trust[0] * g.allowed[d], d, d + 3, settings.turn_cap, settings.stray_turn, g.step, g.low, g.high)
        elif kind == HINGES:
            for j in range(d, skel.first_dof[link + 1]):
                trust = g.trust[0] * g.allowed[j]
                cap(way, trust, j, j + 1, settings.turn_cap, settings.stray_turn, g.step, g.low, g.high)
                g.low[j] = max(g.low[j], skel.limits[j, 0] - posture.angle[j])
                g.high[j] = min(g.high[j], skel.limits[j, 1] - posture.angle[j])


@kernel
def cap(
    way: Array, trust: float, first: int, last: int, most: float, stray: float, step_out: Array, low_out: Array, high_out: Array
) -> None:
    """Shorten a way to `most` times the joint's trust, together for the degrees first .. last; bounds around it."""
    square = 0.0
    for j in range(first, last):
        square += way[j] * way[j]
    far = sqrt(square)
    share = 1.0 if far <= most * trust else most * trust / far
    for j in range(first, last):
        step_out[j] = way[j] * share
        low_out[j] = min(0.0, step_out[j]) - stray * trust
        high_out[j] = max(0.0, step_out[j]) + stray * trust


@kernel
def link_way(skel: Skeleton, link: int, start: Posture, end: Posture) -> tuple[float, float]:
    """How far a root goes [m], and how far a joint turns [rad], from one posture to another; hinges of one joint together."""
    kind, moved, turn = skel.kind[link], 0.0, 0.0
    if kind == FREE:
        moved = norm(sub(row(end.root, link), row(start.root, link)))
    if kind == FREE or kind == BALL:
        turn = norm(step_between(columns(start.turn, link), columns(end.turn, link)))
    elif kind == HINGES:
        for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
            turn += (end.angle[j] - start.angle[j]) ** 2
        turn = sqrt(turn)
    return moved, turn


@kernel
def tracker_speed(skel: Skeleton, goal_out: Goal) -> tuple[float, float]:
    """Largest change of the tracker's posture since the last frame [rad or m], which is then remembered; that of a root's place
    alone [m]. Fills `leapt`."""
    g, fastest, moved = goal_out, 0.0, 0.0
    before, leapt = g.before, g.leapt
    leapt[:] = 0.0
    for link in range(skel.kind.shape[0]):
        way, turn = link_way(skel, link, before, g.tracker)
        root, kind = g.closeness.root[link], skel.kind[link]
        leapt[root, 0], leapt[root, 1] = max(leapt[root, 0], way), max(leapt[root, 1], turn)
        moved = max(moved, way)
        if kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                fastest = max(fastest, abs(g.tracker.angle[j] - before.angle[j]))
                before.angle[j] = g.tracker.angle[j]
        else:
            fastest = max(fastest, turn)
            put_row(before.root, link, row(g.tracker.root, link))
            put_columns(before.turn, link, columns(g.tracker.turn, link))
    return max(fastest, moved), moved


@kernel
def root_way(skel: Skeleton, way: Array) -> float:
    """How far the farthest root goes [m] on a way (nd) in the tangent space; 0 without a root that moves."""
    most = 0.0
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] == FREE:
            d = skel.first_dof[link]
            most = max(most, norm((way[d], way[d + 1], way[d + 2])))
    return most


@kernel
def merit(goal: Goal) -> float:
    """Half the squared distance to the tracker's posture, in the metric of the weights."""
    total = 0.0
    for j in range(goal.full.shape[0]):
        total += 0.5 * goal.full[j] * goal.full[j] / goal.inverse_weight[j]
    return total


@kernel
def largest_part(way: Array) -> float:
    """Largest part [rad or m] of a way (nd)."""
    most = 0.0
    for part in way:
        most = max(most, abs(part))
    return most


@kernel
def farthest(goal: Goal) -> float:
    """Largest part of the way to the tracker's posture inside the limits [rad or m]; nothing where that was found to be no nearer
    to the tracker's own than what is shown."""
    c = goal.closeness
    if c.mode[BEYOND] > 0.0 and c.mode[BEST] >= 0.0 and merit_of(c, c.here, goal.wanted) <= c.mode[BEST]:
        return 0.0
    return largest_part(goal.full)
