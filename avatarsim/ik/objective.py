"""Objective of a posture: Huber loss of link origins and squared joint angles; its quadratic model along the kinematic tree.

    f = sum_i v_i h(|o_i - o_i*|) + 1/2 sum_j w_j |a_j - a_j*|^2,   h(r) = r^2 / 2 up to d, d (r - d / 2) beyond

To first order its rates are those of a tree of point masses v_i min(1, d / r) at the link origins whose joints have a rotor of
w_j each, so its Gauss-Newton matrix is that tree's mass matrix: composite masses (Walker and Orin 1982) and a factor M = L^T L
without fill-in (Featherstone 2008, chapter 6). A link that carries a force F at b from its origin bends the Lagrangian by
(F . b) |w|^2 - (F . w) (b . w) when it turns by w, which an inertia of |F| |b| bounds from above. A slide by s in a frame that
turns by w adds 2 F . (w x a) s, at most |F| (L |w|^2 + s^2 / L): an inertia and a mass, L the mean reach. See docs/posture.md.
"""

from math import sqrt

from avatarsim.ik.couplings import fold_metric
from avatarsim.ik.kinematics import parts_of
from avatarsim.ik.state import Avatars, IkState, Objective, Rig, Tracking
from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import fold
from avatarsim.model.geometry import Array, Poses
from avatarsim.model.skeleton import BALL, FREE, HINGES, SLIDE, Posture, translations
from avatarsim.spatial.tangent import about, columns, product, put_columns, turned
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, cross, dot, norm, put_row, row, scale, sub

LOSS_RADIUS = 0.4
"""Distance beyond which an origin pulls no harder, in mean reaches of a link: 0.1 m for a human. Larger: behind a wall limbs
stretch to the target and angles are lost; smaller: origins are farther from the target than they need be."""


@kernel
def locate(rig: Rig, avatar: int, tracker: Posture, tracking_out: Tracking, objective_out: Objective) -> None:
    """Compute origins and rotations of the links at the tracker's posture, once a frame: forward kinematics without shapes."""
    skel, avatars = rig.skel, rig.avatars
    if tracking_out.is_located[avatar] > 0:
        return
    tracking_out.is_located[avatar], target = 1, tracker
    origins, frames = objective_out.origin, objective_out.frame
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        kind, parent = skel.kind[link], skel.parent[link]
        if kind == FREE:
            put_row(origins, link, row(target.root, link))
            put_columns(frames, link, columns(target.turn, link))
            continue
        if parent >= 0:
            carrier = columns(frames, parent)
            put_row(origins, link, add(row(origins, parent), turned(carrier, row(skel.anchor, link))))
            frame = product(carrier, columns(skel.rest, link))
        else:
            put_row(origins, link, row(skel.anchor, link))
            frame = columns(skel.rest, link)
        if kind == BALL:
            frame = product(frame, columns(target.turn, link))
        elif kind == SLIDE:
            d = skel.first_dof[link]
            put_row(origins, link, along(row(origins, link), target.angle[d], turned(frame, row(skel.axis, d))))
        elif kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                axis, angle = turned(frame, row(skel.axis, j)), target.angle[j]
                frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
        put_columns(frames, link, frame)


@kernel
def draw_near(rig: Rig, avatar: int, state: IkState, poses: Poses, objective_out: Objective) -> None:
    """Draw a target whose root is farther than the loss radius from the shown one to that distance, all link origins with it.

    A target beyond a wall, or one that the avatar is still on its way to, is then followed in its posture, and pulls no harder
    than one that is near: limbs do not stretch after it."""
    skel, avatars = rig.skel, rig.avatars
    c, first = objective_out, avatars.first_link[avatar]
    offset = sub(row(c.origin, first), row(poses.position, skel.first + first))
    # the target's latest motion is followed in full
    moved, _ = parts_of(skel, first, c.target_motion)
    far, d = norm(offset), LOSS_RADIUS * state.tracking.reach[avatar] + moved
    share = 1.0 - d / far if far > d else 0.0
    for link in range(first, avatars.first_link[avatar + 1]):
        put_row(c.aim, link, sub(row(c.origin, link), scale(offset, share)))


@kernel
def value_of(rig: Rig, avatar: int, state: IkState, poses: Poses, objective: Objective) -> tuple[float, float]:
    """Return f [m^2] of an avatar at `poses`, whose tangent error is at hand; and the distance [m] of the farthest origin."""
    avatars = rig.avatars
    total, far, d = 0.0, 0.0, LOSS_RADIUS * state.tracking.reach[avatar]
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        r = norm(sub(row(objective.origin, link), row(poses.position, rig.skel.first + link)))
        total += avatars.link_weight[link] * (0.5 * r * r if r <= d else d * (r - 0.5 * d))
        far = max(far, r)
    for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
        total += 0.5 * avatars.turn_weight[j] * objective.error[j] * objective.error[j]
    return total, far


@kernel
def model(rig: Rig, avatar: int, state: IkState, poses: Poses, objective_out: Objective) -> None:
    """Compute gradient and factored metric of an avatar at `poses`, and the step `newton` (nd) to the least of the model.

    The gradient alone decides where f is least; the metric only how the way there is shared out, and that it does not
    overshoot."""
    avatars = rig.avatars
    locate(rig, avatar, state.tracker_before, state.tracking, objective_out)
    draw_near(rig, avatar, state, poses, objective_out)
    gather(rig, avatar, state, poses, objective_out)
    fall(rig, avatar, state.axes, objective_out)
    note_motions(rig, avatar, poses, state.axes, objective_out)
    fill_metric(rig, avatar, poses, state.axes, state.tracking.reach[avatar], objective_out)
    first, last = avatars.first_dof[avatar], avatars.first_dof[avatar + 1]
    fold(rig.skel, first, last, objective_out.newton)
    fold_metric(rig, avatar, objective_out.factor)
    decompose(avatars, first, last, objective_out.factor)
    solve_up(avatars, first, last, objective_out.factor, objective_out.newton)
    solve_down(avatars, first, last, objective_out.factor, objective_out.newton)


@kernel
def stretch(force: Vec3, arm: Vec3) -> float:
    """Return the inertia [m^2] that bounds how a force at `arm` from a link's origin bends the Lagrangian when the link turns."""
    return norm(force) * norm(arm)


@kernel
def gather(rig: Rig, avatar: int, state: IkState, poses: Poses, objective_out: Objective) -> None:
    """Sum up for each link with all it carries, about its own origin: weight of origins, their first and second moments, the sum
    of their attractions by the target and its moments, contact forces, and the inertia that these and the attractions add."""
    skel, avatars = rig.skel, rig.avatars
    c, d = objective_out, LOSS_RADIUS * state.tracking.reach[avatar]
    low, high, bodies = avatars.first_link[avatar], avatars.first_link[avatar + 1], skel.first
    for link in range(low, high):
        offset = sub(row(c.aim, link), row(poses.position, bodies + link))
        square = dot(offset, offset)
        n = avatars.link_weight[link] * (1.0 if square <= d * d else d / sqrt(square))
        c.number[link], c.inertia[link] = n, state.curvature[link]
        put_row(c.attraction, link, scale(offset, n))
        put_row(c.load, link, row(state.force, link))
        for i in range(3):
            c.first[link, i] = 0.0
            for k in range(3):
                c.second[link, i, k] = 0.0
                c.twist[link, i, k] = 0.0
    for link in range(high - 1, low - 1, -1):
        parent = skel.parent[link]
        if parent < 0:
            continue
        arm, n = sub(row(poses.position, bodies + link), row(poses.position, bodies + parent)), c.number[link]
        first, attraction, load = row(c.first, link), row(c.attraction, link), row(c.load, link)
        c.number[parent] += n
        c.inertia[parent] += c.inertia[link] + stretch(add(attraction, load), arm)
        if skel.kind[link] == SLIDE:
            c.inertia[parent] += norm(add(attraction, load)) * state.tracking.reach[avatar]
        for i in range(3):
            c.first[parent, i] += first[i] + n * arm[i]
            c.attraction[parent, i] += attraction[i]
            c.load[parent, i] += load[i]
            for k in range(3):
                c.twist[parent, i, k] += c.twist[link, i, k] + arm[i] * attraction[k]
                c.second[parent, i, k] += c.second[link, i, k] + arm[i] * first[k] + first[i] * arm[k] + n * arm[i] * arm[k]


@kernel
def fall(rig: Rig, avatar: int, axes: Rows, objective_out: Objective) -> None:
    """Write how fast f falls with each degree of freedom, minus its gradient, into newton (nd)."""
    skel, avatars = rig.skel, rig.avatars
    c, b = objective_out, objective_out.twist
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        d, last = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == FREE:
            for j in range(d, d + 3):
                c.newton[j] = dot(row(axes, j), row(c.attraction, link))
            d += 3
        elif skel.kind[link] == SLIDE:
            c.newton[d] = dot(row(axes, d), row(c.attraction, link)) + avatars.turn_weight[d] * c.error[d]
            continue
        moment = (b[link, 1, 2] - b[link, 2, 1], b[link, 2, 0] - b[link, 0, 2], b[link, 0, 1] - b[link, 1, 0])
        for j in range(d, last):
            c.newton[j] = dot(row(axes, j), moment) + avatars.turn_weight[j] * c.error[j]


@kernel
def note_motions(rig: Rig, avatar: int, poses: Poses, axes: Rows, objective_out: Objective) -> None:
    """Write the motion of the tree by each degree of freedom: its turning, and the velocity of the place where the root is."""
    skel, avatars = rig.skel, rig.avatars
    motion, root = objective_out.motion, avatars.first_link[avatar]
    for link in range(root, avatars.first_link[avatar + 1]):
        d = skel.first_dof[link]
        moves = d + translations(skel, link)
        arm = sub(row(poses.position, skel.first + root), row(poses.position, skel.first + link))
        for j in range(d, skel.first_dof[link + 1]):
            axis = row(axes, j)
            velocity = cross(axis, arm) if j >= moves else axis
            for k in range(3):
                motion[j, k] = axis[k] if j >= moves else 0.0
                motion[j, 3 + k] = velocity[k]


@kernel
def fill_metric(rig: Rig, avatar: int, poses: Poses, axes: Rows, reach: float, objective_out: Objective) -> None:
    """Fill the metric M before it is factored: a row per degree, from its motion and the masses that it carries."""
    skel, avatars = rig.skel, rig.avatars
    c, t, root = objective_out, objective_out.second, avatars.first_link[avatar]
    path, depth, factor, motion = avatars.path, avatars.depth, objective_out.factor, objective_out.motion
    for link in range(root, avatars.first_link[avatar + 1]):
        first, moved, n = skel.first_dof[link], row(c.first, link), c.number[link]
        moves = first + translations(skel, link)
        trace = t[link, 0, 0] + t[link, 1, 1] + t[link, 2, 2] + c.inertia[link]
        out = sub(row(poses.position, skel.first + link), row(poses.position, skel.first + root))
        for j in range(first, skel.first_dof[link + 1]):
            axis = row(axes, j)
            if j < moves:
                force, torque = scale(axis, n), cross(moved, axis)
            else:
                force = cross(axis, moved)
                torque = (
                    trace * axis[0] - t[link, 0, 0] * axis[0] - t[link, 0, 1] * axis[1] - t[link, 0, 2] * axis[2],
                    trace * axis[1] - t[link, 1, 0] * axis[0] - t[link, 1, 1] * axis[1] - t[link, 1, 2] * axis[2],
                    trace * axis[2] - t[link, 2, 0] * axis[0] - t[link, 2, 1] * axis[1] - t[link, 2, 2] * axis[2],
                )
            torque = add(torque, cross(out, force))
            for d in range(depth[j] + 1):
                i = path[j, d]
                factor[j, d] = (
                    motion[i, 0] * torque[0] + motion[i, 1] * torque[1] + motion[i, 2] * torque[2]
                    + motion[i, 3] * force[0] + motion[i, 4] * force[1] + motion[i, 5] * force[2]
                )
            factor[j, depth[j]] += avatars.turn_weight[j]
        if skel.kind[link] == SLIDE:
            factor[first, depth[first]] += norm(add(row(c.attraction, link), row(c.load, link))) / reach


@kernel
def decompose(avatars: Avatars, first: int, last: int, factor_out: Array) -> None:
    """Factor M = L^T L in place, from the leaves to the roots: entries exist only between a degree and those that carry it."""
    f, path, depth = factor_out, avatars.path, avatars.depth
    for k in range(last - 1, first - 1, -1):
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
def solve_up(avatars: Avatars, first: int, last: int, factor: Array, vector_out: Array) -> None:
    """Replace degrees first .. last of a vector by L^-T vector: from the leaves to the roots, along the limbs that it is of."""
    path, depth = avatars.path, avatars.depth
    for k in range(last - 1, first - 1, -1):
        if vector_out[k] != 0.0:
            deep = depth[k]
            part = vector_out[k] / factor[k, deep]
            vector_out[k] = part
            for d in range(deep):
                vector_out[path[k, d]] -= factor[k, d] * part


@kernel
def solve_down(avatars: Avatars, first: int, last: int, factor: Array, vector_out: Array) -> None:
    """Replace degrees first .. last of a vector by L^-1 vector: from the roots to the leaves."""
    path, depth = avatars.path, avatars.depth
    for k in range(first, last):
        deep = depth[k]
        left = vector_out[k]
        for d in range(deep):
            left -= factor[k, d] * vector_out[path[k, d]]
        vector_out[k] = left / factor[k, deep]

