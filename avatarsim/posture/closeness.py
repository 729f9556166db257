"""How near a posture is to the tracker's, in the two figures a user sees: link origins [m], and joint angles weighed as metres.

merit = sum of |origin - tracker's origin|^2 / 2 over the links + sum of turn_weight (angle to go)^2 / 2 over the joints;
of avatars without joints that square is weighed by `turned_aside.py`.
The tracker's posture is taken as it is, limits or not: limits are conditions of the step, as contacts are.

To first order its rates are those of a tree of unit masses at the link origins whose joints have a rotor each, so its second
derivatives are that tree's mass matrix: composite masses (Walker and Orin), and a factor without fill-in (Featherstone). What
bends it beyond that, contact forces included, joins the diagonal (`curvature.py`).
"""

from math import sqrt

from avatarsim.kernel import kernel
from avatarsim.posture.curvature import bound_curvature
from avatarsim.posture.turned_aside import bent, cost, rise
from avatarsim.posture.workspace import RIGID, Closeness
from avatarsim.spatial.tangent import about, columns, product, put_columns, turned
from avatarsim.spatial.vec3 import Rows, add, cross, dot, norm, put_row, row, scale, sub
from avatarsim.world.geometry import Array, Index
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton

FREE_DEGREES = 6
"""Degrees of freedom of a free root: three of its place, then three of its turn."""

NEAR = 1.0 - 1e-12
"""Share of the square of `far` below which an origin is nearer than that whatever the rounding, and no root is taken."""


@kernel
def locate(skel: Skeleton, posture: Posture, closeness_out: Closeness) -> None:
    """Where the link origins of the tracker's posture are: forward kinematics without shapes."""
    there, frames = closeness_out.there, closeness_out.frame
    for link in range(skel.kind.shape[0]):
        kind, parent = skel.kind[link], skel.parent[link]
        if kind == FREE:
            put_row(there, link, row(posture.root, link))
            put_columns(frames, link, columns(posture.turn, link))
            continue
        if parent >= 0:
            carrier = columns(frames, parent)
            put_row(there, link, add(row(there, parent), turned(carrier, row(skel.anchor, link))))
            frame = product(carrier, columns(skel.rest, link))
        else:
            put_row(there, link, row(skel.anchor, link))
            frame = columns(skel.rest, link)
        if kind == BALL:
            frame = product(frame, columns(posture.turn, link))
        elif kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                axis, angle = turned(frame, row(skel.axis, j)), posture.angle[j]
                frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
        put_columns(frames, link, frame)


@kernel
def gather(skel: Skeleton, closeness_out: Closeness) -> None:
    """Of each link with all it carries, about its own origin: number of origins, their first and second moments, the sum of
    their ways to the tracker's, and the moments of these ways."""
    c, parents = closeness_out, skel.parent
    here, there, number, firsts, ways = c.here, c.there, c.number, c.first, c.way
    second, moment, far = c.second, c.moment, c.far[0]
    for link in range(parents.shape[0]):
        # a far one pulls no harder than one at `far`, or limbs would stretch
        way = sub(row(there, link), row(here, link))
        n = 1.0 if dot(way, way) < NEAR * far * far else far / max(far, norm(way))
        number[link] = n
        put_row(ways, link, scale(way, n))
        for i in range(3):
            firsts[link, i] = 0.0
            for k in range(3):
                second[link, i, k] = 0.0
                moment[link, i, k] = 0.0
    for link in range(parents.shape[0] - 1, -1, -1):
        parent = parents[link]
        if parent < 0:
            continue
        arm, n = sub(row(here, link), row(here, parent)), number[link]
        first, way = row(firsts, link), row(ways, link)
        number[parent] += n
        for i in range(3):
            firsts[parent, i] += first[i] + n * arm[i]
            ways[parent, i] += way[i]
            for k in range(3):
                moment[parent, i, k] += moment[link, i, k] + arm[i] * way[k]
                second[parent, i, k] += second[link, i, k] + arm[i] * first[k] + first[i] * arm[k] + n * arm[i] * arm[k]


@kernel
def couple(skel: Skeleton, axes: Rows, full: Array, closeness_out: Closeness) -> None:
    """The step `pull` that would bring the merit to its least if nothing were in the way: M pull = slope.

    full (nd) is the way to the tracker's posture. The slope alone decides where the merit is least, and M only how the way there
    is shared out, and that it does not overshoot.
    """
    c = closeness_out
    gather(skel, c)
    slope(skel, axes, full, c)
    bend(skel, axes, full, c)
    decompose(c.path, c.depth, c.factor)
    solve(c, c.pull)


@kernel
def turned_square(full: Array, first: int) -> float:
    """Square of the angle [rad^2] that a free root whose degrees begin at `first` has to turn."""
    turn = (full[first + 3], full[first + 4], full[first + 5])
    return dot(turn, turn)


@kernel
def slope(skel: Skeleton, axes: Rows, full: Array, closeness_out: Closeness) -> None:
    """How fast the merit falls with each degree of freedom, into pull (nd)."""
    c, kind, first_dof = closeness_out, skel.kind, skel.first_dof
    b, ways, pull, turn_weight, rigid = c.moment, c.way, c.pull, c.turn_weight, c.mode[RIGID] > 0.0
    for m in range(kind.shape[0]):
        first, way = first_dof[m], row(ways, m)
        moves = first + 3 if kind[m] == FREE else first
        twist = (b[m, 1, 2] - b[m, 2, 1], b[m, 2, 0] - b[m, 0, 2], b[m, 0, 1] - b[m, 1, 0])
        weight = rise(turned_square(full, first)) if rigid and kind[m] == FREE else 1.0
        for j in range(first, first_dof[m + 1]):
            if j < moves:
                pull[j] = dot(row(axes, j), way)
            else:
                pull[j] = dot(row(axes, j), twist) + weight * turn_weight[j] * full[j]


@kernel
def note_motions(skel: Skeleton, axes: Rows, closeness_out: Closeness) -> None:
    """Of each degree of freedom the motion of its tree: turning, and velocity of the place where the root is."""
    here, root, motion = closeness_out.here, closeness_out.root, closeness_out.motion
    kind, first_dof = skel.kind, skel.first_dof
    for m in range(kind.shape[0]):
        first = first_dof[m]
        moves = first + 3 if kind[m] == FREE else first
        arm = sub(row(here, root[m]), row(here, m))
        for j in range(first, first_dof[m + 1]):
            turn, way = row(axes, j), cross(row(axes, j), arm)
            for k in range(3):
                motion[j, k] = turn[k] if j >= moves else 0.0
                motion[j, 3 + k] = way[k] if j >= moves else turn[k]


@kernel
def bend(skel: Skeleton, axes: Rows, full: Array, closeness_out: Closeness) -> None:
    """Second derivatives of the merit, a row per degree of freedom, from what its motion asks of the masses that it carries.

    What bends the merit beyond first order joins the diagonal: without it a limb that is pressed together overshoots, step by
    step.
    """
    c = closeness_out
    t, here, root, firsts, number = c.second, c.here, c.root, c.first, c.number
    path, depth, factor, motion, turn_weight = c.path, c.depth, c.factor, c.motion, c.turn_weight
    kind, first_dof, rigid = skel.kind, skel.first_dof, c.mode[RIGID] > 0.0
    note_motions(skel, axes, c)
    bound_curvature(skel, axes, c)
    for m in range(kind.shape[0]):
        first, moved, n = first_dof[m], row(firsts, m), number[m]
        moves = first + 3 if kind[m] == FREE else first
        trace = t[m, 0, 0] + t[m, 1, 1] + t[m, 2, 2]
        out = sub(row(here, m), row(here, root[m]))
        weight = bent(turned_square(full, first)) if rigid and kind[m] == FREE else 1.0
        for j in range(first, first_dof[m + 1]):
            axis, extra = row(axes, j), 0.0
            if j < moves:
                force, torque = scale(axis, n), cross(moved, axis)
            else:
                force = cross(axis, moved)
                torque = (
                    trace * axis[0] - t[m, 0, 0] * axis[0] - t[m, 0, 1] * axis[1] - t[m, 0, 2] * axis[2],
                    trace * axis[1] - t[m, 1, 0] * axis[0] - t[m, 1, 1] * axis[1] - t[m, 1, 2] * axis[2],
                    trace * axis[2] - t[m, 2, 0] * axis[0] - t[m, 2, 1] * axis[1] - t[m, 2, 2] * axis[2],
                )
                extra = weight * turn_weight[j] + c.curvature[j]
            torque = add(torque, cross(out, force))
            for d in range(depth[j] + 1):
                i = path[j, d]
                factor[j, d] = (
                    motion[i, 0] * torque[0] + motion[i, 1] * torque[1] + motion[i, 2] * torque[2]
                    + motion[i, 3] * force[0] + motion[i, 4] * force[1] + motion[i, 5] * force[2]
                )
            factor[j, depth[j]] += extra


@kernel
def decompose(path: Index, depth: Index, factor_out: Array) -> None:
    """M = L^T L in place, from the leaves to the roots: entries exist only between a degree and those that carry it."""
    f = factor_out
    for k in range(depth.shape[0] - 1, -1, -1):
        deep = depth[k]
        root = sqrt(f[k, deep])
        f[k, deep] = root
        for d in range(deep):
            f[k, d] /= root
        for d in range(deep):
            i, part = path[k, d], f[k, d]
            for e in range(d + 1):
                f[i, e] -= part * f[k, e]


@kernel
def solve(closeness: Closeness, vector_out: Array) -> None:
    """Replace vector (nd) by M^-1 vector."""
    solve_up(closeness, vector_out)
    solve_down(closeness, vector_out)


@kernel
def solve_up(closeness: Closeness, vector_out: Array) -> None:
    """Replace vector (nd) by L^-T vector: from the leaves to the roots, only along the limbs that the vector is of."""
    path, depth, factor = closeness.path, closeness.depth, closeness.factor
    for k in range(depth.shape[0] - 1, -1, -1):
        if vector_out[k] != 0.0:
            deep = depth[k]
            part = vector_out[k] / factor[k, deep]
            vector_out[k] = part
            for d in range(deep):
                vector_out[path[k, d]] -= factor[k, d] * part


@kernel
def solve_down(closeness: Closeness, vector_out: Array) -> None:
    """Replace vector (nd) by L^-1 vector: from the roots to the leaves."""
    path, depth, factor = closeness.path, closeness.depth, closeness.factor
    for k in range(depth.shape[0]):
        deep = depth[k]
        left = vector_out[k]
        for d in range(deep):
            left -= factor[k, d] * vector_out[path[k, d]]
        vector_out[k] = left / factor[k, deep]


@kernel
def gain_of(closeness: Closeness, wish: Array, step: Array) -> tuple[float, float]:
    """By how much a step (nd) lowers the merit, to second order, and its squared length: y . z - y . y / 2 with y = L step,
    z = L wish, the wish being the unhindered step."""
    path, depth, factor, gain, square = closeness.path, closeness.depth, closeness.factor, 0.0, 0.0
    for k in range(depth.shape[0]):
        y, z = 0.0, 0.0
        for d in range(depth[k] + 1):
            i = path[k, d]
            y += factor[k, d] * step[i]
            z += factor[k, d] * wish[i]
        gain += y * (z - 0.5 * y)
        square += y * y
    return gain, square


@kernel
def merit_of(closeness: Closeness, here: Rows, full: Array) -> float:
    """Half the squared distance [m^2] to the tracker's posture of one with link origins `here` that is `full` (nd) away.

    See the head of this file; an origin farther than `far` counts by its distance and not by the square."""
    c, total = closeness, 0.0
    there, turn_weight, far = c.there, c.turn_weight, c.far[0]
    for link in range(here.shape[0]):
        way = sub(row(there, link), row(here, link))
        square = dot(way, way)
        total += 0.5 * square if square <= far * far else far * (sqrt(square) - 0.5 * far)
    if c.mode[RIGID] > 0.0:
        for first in range(0, full.shape[0], FREE_DEGREES):
            total += 0.5 * turn_weight[first + 3] * cost(turned_square(full, first))
        return total
    for j in range(full.shape[0]):
        total += 0.5 * turn_weight[j] * full[j] * full[j]
    return total
