"""Nearest posture without overlap, from one that may overlap: sequential quadratic programming on signed gaps.

min f(x) such that every signed gap g(x) >= margin, f the objective of a frame about a target posture (`ik.objective`). A step
solves the QP of a frame (`ik.qp`) with a row J dx >= margin - g for each near pair, where g of an overlapping pair is minus its
penetration depth along the direction of least depth (van den Bergh 2001). There are two phases (Nocedal and Wright 2006, chapter
18). Restoration takes whole steps, in which the target attracts less from step to step, until the posture is free. Descent
starts at the free posture with the least f and takes steps that keep it free and lower f, with backtracking.

It is outside the frame and needs no free state to start from. The sides of thin bodies are those of least depth.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from avatarsim.collision.manifold import Manifold, make_manifold, manifold
from avatarsim.collision.signed_distance import signed_distance_up_to
from avatarsim.collision.status import NOT_FINITE
from avatarsim.ik.constraints import add_contact, check_limits
from avatarsim.ik.gaps import stand_off_of
from avatarsim.ik.kinematics import carry_avatar, place_avatar, take_step, tangent_error
from avatarsim.ik.make import empty_posture, make_avatars, make_state, make_working
from avatarsim.ik.motion_budget import bound_step
from avatarsim.ik.objective import locate, model, value_of
from avatarsim.ik.qp import solve_qp
from avatarsim.ik.sqp_step import work_done
from avatarsim.ik.state import DROPPED, QUERIES, Array, Avatars, IkScratch, IkState, Index, Rig
from avatarsim.ik.target import clip_avatar, copy_posture, largest
from avatarsim.jit.arena import view_arena
from avatarsim.jit.kernel import entry_kernel, kernel
from avatarsim.jit.layout import IndexLine
from avatarsim.model.geometry import Geometry, Poses, allowed_depth, may_meet
from avatarsim.model.skeleton import FREE, Posture
from avatarsim.model.world import World, WorldParts
from avatarsim.spatial.vec3 import Vec3, put_row, row
from avatarsim.tolerances import FINE, NOTHING

RESTORING, DESCENDING = 24, 12
"""Most steps of the two phases. Fewer: deep starts are given up, or end farther from their target; more: time where none is
found."""

FULL_STEPS, FADING = 8, 0.7
"""Steps of the restoration in which the target attracts fully, and the factor by which it does less in each one after. More, or
nearer to 1: attractions by target and walls take all steps; fewer, or smaller: the first free posture is farther away."""

FARTHEST_STEP = 0.25
"""[rad, m] of a joint or a root in one step. Larger: directions of deep pairs are followed beyond where they hold; smaller: more
steps."""

NEAR = 0.06
"""[m] gap up to which a pair has a row. Larger: more rows; smaller: a step runs into pairs that it has no row of."""

FACE = 6e-3
"""[m] gap or depth up to which a pair has a row at each corner of the face in which it touches. Smaller: boxes that lie flat on
each other turn about the one corner that has a row; larger: more rows."""

SHARES = 4
"""Halvings of a step of the descent before it ends."""

SETTLED = 1e-4
"""[rad, m] a step that is smaller ends a phase."""

FAR = 2.0
"""A search ends where its f is so many times that of a posture that is known. Smaller: it ends on its way to a nearer one."""

GAIN = 1e-3
"""Share of f that a step of the descent has to gain, or it ends. Larger: postures that are farther away; smaller: more steps."""


class FreeSearch(NamedTuple):
    """Memory of a search for free postures: avatars, state and working memory as in a frame; the `best` posture found, and a
    `clipped` one; `points` in which two pieces touch; is_solved (na) 1 for avatars that may move; is_seen (nb) 1 for bodies that
    count."""

    avatars: Avatars
    state: IkState
    scratch: IkScratch
    best: Posture
    clipped: Posture
    points: Manifold
    is_solved: IndexLine
    is_seen: IndexLine


def make_free_search(world: World, weights: Array) -> FreeSearch:
    """Return memory for searches in a world; `weights` (na): cost of moving each avatar relative to the others."""
    geo, skel = world.geometry, world.skeleton
    nl, nd = len(skel.kind), int(skel.first_dof[-1])
    avatars, reach = make_avatars(geo, skel, world.poses)
    avatars.link_weight[:] *= weights[avatars.avatar]
    avatars.turn_weight[:] *= weights[avatars.avatar[avatars.joint_of]]
    state = make_state(geo, skel, avatars, reach, np.zeros((nd, 3)), world.posture)
    return FreeSearch(
        avatars, state, make_working(geo, skel, avatars, world.poses, 0), empty_posture(nl, nd), empty_posture(nl, nd),
        make_manifold(), np.ones(len(reach), dtype=np.int64), np.ones(len(world.scene.names), dtype=np.int64),
    )


@kernel
def place_solved(rig: Rig, posture: Posture, poses_out: Poses, search_out: FreeSearch) -> None:
    """Compute poses of all avatars that are solved for at a posture, and axes of their degrees."""
    for avatar in range(rig.avatars.first_link.shape[0] - 1):
        search_out.scratch.is_active[avatar] = search_out.is_solved[avatar]
        if search_out.is_solved[avatar] > 0:
            carry_avatar(rig, avatar, posture, search_out.scratch.still, poses_out, search_out.state.axes)
            place_avatar(rig, avatar, poses_out)


@kernel
def meet(one: Array, other: Array, i: int, k: int, within: float) -> bool:
    """Return True if two boxes are at most `within` [m] apart along each axis."""
    for axis in range(3):
        if not (one[i, axis] <= other[k, 3 + axis] + within and other[k, axis] <= one[i, 3 + axis] + within):
            return False
    return True


@kernel
def is_looked_at(rig: Rig, search: FreeSearch, b: int, other: int) -> bool:
    """Return True if the pair of a link b that is solved for and another body counts, each pair once."""
    if other == b or search.is_seen[other] == 0 or not may_meet(rig.geo.wanted, b, other):
        return False
    link = other - rig.skel.first
    return other > b or link < 0 or search.is_solved[rig.avatars.avatar[link]] == 0


@kernel
def add_rows(rig: Rig, poses: Poses, margin: float, is_strict: bool, within: float, search_out: FreeSearch) -> float:
    """Begin the rows anew, one per pair at most `within` [m] apart; return the least gap [m], beyond the need of its pair."""
    s, avatars, worst = search_out.scratch, rig.avatars, inf
    s.rows.used[0], s.rows.ready[0] = 0, 0
    for b in range(rig.skel.first, poses.position.shape[0]):
        if search_out.is_solved[avatars.avatar[b - rig.skel.first]] == 0 or search_out.is_seen[b] == 0:
            continue
        for other in range(poses.position.shape[0]):
            if not meet(poses.hulls, poses.hulls, b, other, within) or not is_looked_at(rig, search_out, b, other):
                continue
            for one in range(rig.geo.first_shape[b], rig.geo.first_shape[b + 1]):
                for two in range(rig.geo.first_shape[other], rig.geo.first_shape[other + 1]):
                    if meet(poses.boxes, poses.boxes, one, two, within):
                        worst = min(worst, add_row(rig, poses, one, two, margin, is_strict, within, search_out))
    return worst


@kernel
def gap_of(geo: Geometry, poses: Poses, a: int, b: int, within: float, scratch: IkScratch) -> tuple[float, Vec3, Vec3, Vec3]:
    """Return the gap [m] of two pieces beyond the depth that they may have, -inf if it is not known, with normal and points as
    `signed_distance_up_to`."""
    scratch.counts[QUERIES] += 1
    status, gap, n, on_a, on_b = signed_distance_up_to(poses.vertices, geo.shapes, a, b, (0.0, 0.0, 0.0), within, scratch.narrow)
    if status == NOT_FINITE or not (gap == gap):
        return -inf, n, on_a, on_b
    return gap + allowed_depth(geo, a, b), n, on_a, on_b


@kernel
def excess_of(geo: Geometry, a: int, b: int, gap: float, margin: float, is_strict: bool) -> float:
    """Return by how much [m] a gap is more than two pieces need."""
    if is_strict and allowed_depth(geo, a, b) == 0.0:
        return gap - margin
    return gap + NOTHING


@kernel
def is_alone(rig: Rig, piece: int) -> bool:
    """Return True if a piece is of a free link without others: a loose body, or a hand without joints."""
    avatars = rig.avatars
    link = rig.geo.body[piece] - rig.skel.first
    if link < 0 or rig.skel.kind[link] != FREE:
        return False
    avatar = avatars.avatar[link]
    return bool(avatars.first_link[avatar + 1] == avatars.first_link[avatar] + 1)


@kernel
def pushed_at(rig: Rig, piece: int, gap: float, point: Vec3, poses: Poses) -> Vec3:
    """Return the point at which a piece is pushed: of a deep overlap the origin of a free link without others, which is then not
    turned, since the depth is that of a translation."""
    if gap < -FACE and is_alone(rig, piece):
        return row(poses.position, rig.geo.body[piece])
    return point


@kernel
def add_row(
    rig: Rig, poses: Poses, a: int, b: int, margin: float, is_strict: bool, within: float, search_out: FreeSearch
) -> float:
    """Add rows of pieces a and b, if they are near; return by how much [m] their gap is more than they need.

    A pair that touches without overlap needs no more than that, unless the margin is strict: resting bodies stay at rest."""
    s, allowed = search_out.scratch, allowed_depth(rig.geo, a, b)
    gap, n, on_a, on_b = gap_of(rig.geo, poses, a, b, within, s)
    if -inf < gap <= within + allowed:
        wanted = stand_off_of(rig.geo, margin, a, b)
        needed = (1.0 + FINE) * wanted if is_strict else wanted
        if not is_strict and gap >= -NOTHING:
            needed = min(wanted, max(gap, 0.0))
        points, count = search_out.points, 1
        points.gap[0] = gap - allowed
        put_row(points.on_a, 0, pushed_at(rig, a, gap, on_a, poses))
        put_row(points.on_b, 0, pushed_at(rig, b, gap, on_b, poses))
        # links of a tree are turned by their carriers, and have many rows as it is
        if -FACE <= gap <= FACE and (is_alone(rig, a) or is_alone(rig, b)):
            count, n = manifold(poses.vertices, rig.geo.shapes, a, b, n, on_a, on_b, gap - allowed, FACE, points)
        for k in range(count):
            missing = needed - points.gap[k] - allowed
            add_contact(rig, a, b, n, row(points.on_a, k), row(points.on_b, k), missing, poses, search_out.state.axes, s.still, s)
    return excess_of(rig.geo, a, b, gap, margin, is_strict)


@kernel
def value_at(rig: Rig, posture: Posture, poses: Poses, search_out: FreeSearch) -> float:
    """Return the objective f of all avatars that are solved for, at a posture whose poses are at hand."""
    total, s, state = 0.0, search_out.scratch, search_out.state
    for avatar in range(rig.avatars.first_link.shape[0] - 1):
        if search_out.is_solved[avatar] > 0:
            tangent_error(rig, avatar, posture, s.target, s.objective.error)
            locate(rig, avatar, state.tracker_before, state.tracking, s.objective)
            value, _ = value_of(rig, avatar, state, poses, s.objective)
            total += value
    return total


@kernel
def solve_step(rig: Rig, posture: Posture, poses: Poses, attraction: float, search_out: FreeSearch) -> float:
    """Solve for the QP's step from a posture, `attraction` is the share of the step to the target; return its largest part."""
    s, state, avatars, count = search_out.scratch, search_out.state, rig.avatars, 0
    for avatar in range(avatars.first_link.shape[0] - 1):
        if s.is_active[avatar] == 0:
            continue
        s.members[count], count = avatar, count + 1
        model(rig, avatar, state, poses, s.objective)
        bound_step(rig, avatar, posture, state.budget, s)
        for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
            s.objective.newton[j] *= attraction
    for _ in range(3):
        solve_qp(rig, 0, count, FINE * SETTLED, state, s)
        beyond = 0
        for m in range(count):
            beyond += check_limits(rig, s.members[m], posture, True, s)
        if beyond == 0:
            break
    most = 0.0
    for m in range(count):
        avatar = s.members[m]
        most = max(most, largest(s.step, avatars.first_dof[avatar], avatars.first_dof[avatar + 1]))
    return most


@kernel
def go(rig: Rig, posture_out: Posture, search_out: FreeSearch) -> None:
    """Take the step, and bring the posture back within the limits of its joints."""
    s, avatars = search_out.scratch, rig.avatars
    for avatar in range(avatars.first_link.shape[0] - 1):
        if search_out.is_solved[avatar] > 0:
            take_step(rig, avatar, s.step, posture_out)
            clip_avatar(rig, avatar, posture_out, search_out.state.tracking, search_out.clipped)
            copy_posture(rig, avatar, search_out.clipped, posture_out)


@kernel
def copy_solved(rig: Rig, posture: Posture, posture_out: Posture, search: FreeSearch) -> None:
    """Copy the posture of all avatars that are solved for."""
    for avatar in range(rig.avatars.first_link.shape[0] - 1):
        if search.is_solved[avatar] > 0:
            copy_posture(rig, avatar, posture, posture_out)


@kernel
def is_better(rig: Rig, posture: Posture, poses: Poses, worst: float, least: float, search_out: FreeSearch) -> float:
    """Return the least f of a free posture so far; if this one is free and has less, it is kept as the best."""
    if not (worst >= 0.0):
        return least
    value = value_at(rig, posture, poses, search_out)
    if value < least:
        copy_solved(rig, posture, search_out.best, search_out)
        return value
    return least


@kernel
def restore(
    rig: Rig, margin: float, is_strict: bool, posture_out: Posture, poses_out: Poses, most: float, search_out: FreeSearch
) -> float:
    """Take whole steps until the posture is free and settled; return the least f of free postures on the way, else infinity."""
    attraction, within, dropped, least = 1.0, NEAR, search_out.scratch.counts[DROPPED], inf
    for k in range(RESTORING):
        place_solved(rig, posture_out, poses_out, search_out)
        worst = add_rows(rig, poses_out, margin, is_strict, within, search_out)
        least = is_better(rig, posture_out, poses_out, worst, least, search_out)
        if search_out.scratch.counts[DROPPED] > dropped:
            dropped, within = search_out.scratch.counts[DROPPED], 0.5 * within
        step = solve_step(rig, posture_out, poses_out, attraction, search_out)
        if worst >= 0.0 and (step < SETTLED or attraction < 1.0):
            break
        if k >= FULL_STEPS and value_at(rig, posture_out, poses_out, search_out) > FAR * most:
            break
        go(rig, posture_out, search_out)
        if k >= FULL_STEPS:
            attraction *= FADING
    return least


@kernel
def descend(
    rig: Rig, margin: float, is_strict: bool, posture_out: Posture, poses_out: Poses, least: float, search_out: FreeSearch
) -> float:
    """Descend from the best posture, which is free, to one with less f by steps that keep it free; return the f reached."""
    for _ in range(DESCENDING):
        copy_solved(rig, search_out.best, posture_out, search_out)
        place_solved(rig, posture_out, poses_out, search_out)
        add_rows(rig, poses_out, margin, is_strict, NEAR, search_out)
        step, before = solve_step(rig, posture_out, poses_out, 1.0, search_out), least
        for _ in range(SHARES):
            if not (step >= SETTLED):
                break
            go(rig, posture_out, search_out)
            place_solved(rig, posture_out, poses_out, search_out)
            worst = add_rows(rig, poses_out, margin, is_strict, margin, search_out)
            least = is_better(rig, posture_out, poses_out, worst, least, search_out)
            if least < before:
                break
            copy_solved(rig, search_out.best, posture_out, search_out)
            for j in range(search_out.scratch.step.shape[0]):
                search_out.scratch.step[j] *= 0.5
            step *= 0.5
        if not (least < (1.0 - GAIN) * before):
            break
    return least


@entry_kernel
def aim(world: Index, search: Index) -> None:
    """Make the posture of the world, where all avatars are placed, the target of the search."""
    w, own = view_arena(world, WorldParts), view_arena(search, FreeSearch)
    rig = Rig(w.geometry, w.skeleton, own.avatars)
    budget = own.state.budget
    budget.move[:], budget.turn[:], budget.moved[:], budget.turned[:] = FARTHEST_STEP, FARTHEST_STEP, 0.0, 0.0
    for avatar in range(own.avatars.first_link.shape[0] - 1):
        clip_avatar(rig, avatar, w.posture, own.state.tracking, own.scratch.target)
        copy_posture(rig, avatar, w.posture, own.state.tracker_before)
        copy_posture(rig, avatar, w.posture, own.best)
        own.state.tracking.is_located[avatar] = 0
        carry_avatar(rig, avatar, w.posture, own.scratch.still, w.poses, own.state.axes)
        place_avatar(rig, avatar, w.poses)


@kernel
def is_apart(rig: Rig, poses: Poses, margin: float, is_strict: bool, search: FreeSearch) -> bool:
    """Return True if all pairs have the gaps that they need; it ends at the first one that does not."""
    avatars = rig.avatars
    for b in range(rig.skel.first, poses.position.shape[0]):
        if search.is_solved[avatars.avatar[b - rig.skel.first]] == 0 or search.is_seen[b] == 0:
            continue
        for other in range(poses.position.shape[0]):
            if not meet(poses.hulls, poses.hulls, b, other, margin) or not is_looked_at(rig, search, b, other):
                continue
            for one in range(rig.geo.first_shape[b], rig.geo.first_shape[b + 1]):
                for two in range(rig.geo.first_shape[other], rig.geo.first_shape[other + 1]):
                    if meet(poses.boxes, poses.boxes, one, two, margin):
                        gap, _, _, _ = gap_of(rig.geo, poses, one, two, margin, search.scratch)
                        if not (excess_of(rig.geo, one, two, gap, margin, is_strict) >= 0.0):
                            return False
    return True


@entry_kernel
def is_free_at(world: Index, search: Index, margin: float, is_strict: bool) -> bool:
    """Return True if the posture of the world is free; its poses are left in the world."""
    w, own = view_arena(world, WorldParts), view_arena(search, FreeSearch)
    rig = Rig(w.geometry, w.skeleton, own.avatars)
    place_solved(rig, w.posture, w.poses, own)
    return is_apart(rig, w.poses, margin, is_strict, own)


@entry_kernel
def value_of_posture(world: Index, search: Index) -> float:
    """Return the f of the posture of the world, whose poses are at hand."""
    w, own = view_arena(world, WorldParts), view_arena(search, FreeSearch)
    rig = Rig(w.geometry, w.skeleton, own.avatars)
    return value_at(rig, w.posture, w.poses, own)


@entry_kernel
def search_from(world: Index, search: Index, margin: float, is_strict: bool, most: float) -> tuple[float, int]:
    """Return the f of the free posture that is found from the posture of the world, and left in `best`; infinite where none is
    with less than about `most`. And the work, in units of about a microsecond, counted so that results repeat."""
    w, own = view_arena(world, WorldParts), view_arena(search, FreeSearch)
    rig = Rig(w.geometry, w.skeleton, own.avatars)
    own.scratch.counts[:] = 0
    least = restore(rig, margin, is_strict, w.posture, w.poses, most, own)
    if least < FAR * most:
        least = descend(rig, margin, is_strict, w.posture, w.poses, least, own)
    return least, work_done(own.scratch)
