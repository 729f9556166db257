"""Curvature of the Lagrangian: by how much pulls and contact forces bend the objective beyond Gauss and Newton.

A step minimises a quadratic model of the objective f under linear rows of the gaps g. Where it ends, the pulls on the links are
balanced by the contact forces, multipliers lambda times normals, and the matrix that says how far a step may go is the second
derivative of f - sum lambda g: Gauss and Newton's M and, from all forces F at points r that joint i carries,

    R_ij = -sum F . (a_j x (a_i x r)) = tr(B_i) a_i . a_j - a_j . B_i a_i,    B_i = sum r F^T about the origin of i,

for each axis a_j of a joint that carries i or is i. Far beyond a wall lambda is large, and steps of M alone overshoot the
minimum frame by frame, to and fro. With d_j = sum_i |R_ij| on the diagonal M + diag(d) is at least M + R (Gershgorin), so the
model lies above the Lagrangian to second order and its steps descend: majorise and minimise (Hunter and Lange 2004), with the
damping of Levenberg and Marquardt taken from the forces. Where nothing presses and no pull is left d is zero.
"""

from avatarsim.ik.state import Avatars, ConstraintRows, IkState, Objective, RowKind
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, add, cross, row, sub
from avatarsim.world.geometry import Array, Geometry, Poses
from avatarsim.world.skeleton import FREE, HINGES, Skeleton

CONTACT = int(RowKind.CONTACT)


@kernel
def forget_forces(avatars: Avatars, avatar: int, state_out: IkState) -> None:
    """Nothing presses on the links of an avatar."""
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        for i in range(3):
            state_out.force[link, i] = 0.0
            for j in range(3):
                state_out.moment[link, i, j] = 0.0


@kernel
def note_forces(geo: Geometry, skel: Skeleton, rows: ConstraintRows, state_out: IkState) -> None:
    """Add what the contact rows of a solved step press on each link with: force, and its moment about the link's origin."""
    s = state_out
    for k in range(rows.count[0]):
        if rows.kind[k] != CONTACT or not (rows.multiplier[k] > 0.0):
            continue
        for side in range(2):
            link = geo.body[rows.pair[k, side]] - skel.first
            if link < 0:
                continue
            push = rows.multiplier[k] if side == 0 else -rows.multiplier[k]
            for i in range(3):
                s.force[link, i] += push * rows.normal[k, i]
                for j in range(3):
                    s.moment[link, i, j] += rows.arm[k, 3 * side + i] * push * rows.normal[k, j]


@kernel
def add_moments(skel: Skeleton, avatars: Avatars, avatar: int, state: IkState, poses: Poses, objective_out: Objective) -> None:
    """Of each link with all it carries: the contact forces on it, and B, the moments of these and of the pulls about its origin."""
    c, low, high = objective_out, avatars.first_link[avatar], avatars.first_link[avatar + 1]
    for link in range(low, high):
        for i in range(3):
            c.load[link, i] = state.force[link, i]
            for j in range(3):
                c.bending[link, i, j] = state.moment[link, i, j]
    for link in range(high - 1, low - 1, -1):
        parent = skel.parent[link]
        if parent >= 0:
            arm = sub(row(poses.position, skel.first + link), row(poses.position, skel.first + parent))
            for i in range(3):
                c.load[parent, i] += c.load[link, i]
                for j in range(3):
                    c.bending[parent, i, j] += c.bending[link, i, j] + arm[i] * c.load[link, j]
    for link in range(low, high):
        for i in range(3):
            for j in range(3):
                c.bending[link, i, j] += c.twist[link, i, j]


@kernel
def bent_by(moments: Array, link: int, a: Vec3) -> Vec3:
    """tr(B) a - B a with B the moments of a link."""
    b = moments
    trace = b[link, 0, 0] + b[link, 1, 1] + b[link, 2, 2]
    return (
        trace * a[0] - b[link, 0, 0] * a[0] - b[link, 0, 1] * a[1] - b[link, 0, 2] * a[2],
        trace * a[1] - b[link, 1, 0] * a[0] - b[link, 1, 1] * a[1] - b[link, 1, 2] * a[2],
        trace * a[2] - b[link, 2, 0] * a[0] - b[link, 2, 1] * a[1] - b[link, 2, 2] * a[2],
    )


@kernel
def bound_curvature(
    skel: Skeleton, avatars: Avatars, avatar: int, state: IkState, poses: Poses, objective_out: Objective
) -> None:
    """Fill curvature (nd) with d of the head of this file; the moments and motions of this step are at hand.

    The three turns of a ball have no order: of them the symmetric part of B counts."""
    c, axes = objective_out, state.axes
    b, path, depth, motion, curvature = c.bending, avatars.path, avatars.depth, c.motion, c.curvature
    add_moments(skel, avatars, avatar, state, poses, c)
    for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
        curvature[j] = 0.0
    for m in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        first = skel.first_dof[m]
        skewed = (0.5 * (b[m, 2, 1] - b[m, 1, 2]), 0.5 * (b[m, 0, 2] - b[m, 2, 0]), 0.5 * (b[m, 1, 0] - b[m, 0, 1]))
        for j in range(first + 3 if skel.kind[m] == FREE else first, skel.first_dof[m + 1]):
            carried = bent_by(b, m, row(axes, j))
            own = carried if skel.kind[m] == HINGES else add(carried, cross(skewed, row(axes, j)))
            for d in range(depth[j] + 1):
                i = path[j, d]
                v = own if i >= first else carried
                bent = abs(motion[i, 0] * v[0] + motion[i, 1] * v[1] + motion[i, 2] * v[2])
                curvature[j] += bent
                if i != j:
                    curvature[i] += bent

