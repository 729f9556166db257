"""Friction of links on fixed bodies: Coulomb's law with last step's normal force, as bounded rows of the QP.

Two rows per contact keep it from slipping, along its slip and across. Their multipliers are bounded by

    |lambda_t| <= min(mu exp(-(v / v_s)^2) lambda_n, D / g)

with lambda_n of the last step, so that the QP stays convex; D the depth of the target's link under the surface, g the compliance
of the row: a contact is held off its slip by no more than its target is deep (friction cone of a god-object, Harwin and Melder
2002, with a half-angle of 45 degrees). v is the speed of the target's link: friction fades as in Stribeck's curve
(Armstrong-Helouvry and others 1994), so that feet that are set down stay and hands that are drawn along a wall follow.
"""

from math import exp

from avatarsim.ik.constraints import add_contact
from avatarsim.ik.qp import SOFTNESS, transform
from avatarsim.ik.state import ConstraintRows, Contacts, IkScratch, IkState, Rig, RowKind
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Array, Poses
from avatarsim.model.skeleton import FREE, SLIDE, Skeleton
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, turned, turned_back
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, cross, dot, norm, perpendicular, row, scale, sub
from avatarsim.tolerances import NOTHING

CONTACT, FRICTION = int(RowKind.CONTACT), int(RowKind.FRICTION)

MOST_CONTACTS = 6
"""Contacts of an avatar that have friction at most, those that press hardest. Fewer: a hand turns about the ones that are left;
more: slowest frames of hands that grip take longer."""


@kernel
def add_friction(rig: Rig, settings: PostureSettings, members: int, poses: Poses, state: IkState, scratch_out: IkScratch) -> None:
    """Append friction rows for the contacts with fixed bodies that press hardest, MOST_CONTACTS for each of so many members.

    The planning avatar has none."""
    rows, count = scratch_out.rows, scratch_out.rows.used[0]
    for k in range(count):
        rows.before[k] = largest_force(rig, k, state, rows)
    for _ in range(MOST_CONTACTS * members):
        hardest = 0
        for k in range(1, count):
            hardest = k if rows.before[k] > rows.before[hardest] else hardest
        if count == 0 or not (rows.before[hardest] > NOTHING):
            return
        hold(rig, settings, hardest, rows.before[hardest], poses, state, scratch_out)
        rows.before[hardest] = 0.0


@kernel
def largest_force(rig: Rig, k: int, state: IkState, rows: ConstraintRows) -> float:
    """Return the largest multiplier of friction that row k has by Coulomb's law, 0 for all but links on fixed bodies."""
    geo, skel, avatars = rig.geo, rig.skel, rig.avatars
    if rows.kind[k] != CONTACT:
        return 0.0
    a, b = rows.pair[k, 0], rows.pair[k, 1]
    link, body = geo.body[a] - skel.first, geo.body[b]
    one, other = avatars.material[geo.body[a]], avatars.material[body]
    if body >= skel.first or other < 0 or one < 0 or state.tracking.keep[avatars.avatar[link]] == 0.0:
        return 0.0
    return float(avatars.friction[one, other] * normal_force(a, b, state.contacts))


@kernel
def normal_force(a: int, b: int, contacts: Contacts) -> float:
    """Return the sum of the multipliers of a pair of pieces in the last step."""
    total = 0.0
    for k in range(contacts.used[0]):
        if contacts.pair[k, 0] == a and contacts.pair[k, 1] == b:
            total += contacts.multiplier[k]
    return total


@kernel
def hold(rig: Rig, settings: PostureSettings, k: int, most: float, poses: Poses, state: IkState, scratch_out: IkScratch) -> None:
    """Append the friction rows of contact row k, for multipliers up to `most`."""
    geo, skel, avatars = rig.geo, rig.skel, rig.avatars
    rows, o = scratch_out.rows, scratch_out.objective
    a, b = rows.pair[k, 0], rows.pair[k, 1]
    body, other, n = geo.body[a], geo.body[b], row(rows.normal, k)
    link, avatar = body - skel.first, avatars.avatar[body - skel.first]
    arm = (rows.arm[k, 0], rows.arm[k, 1], rows.arm[k, 2])
    on_a = add(row(poses.position, body), arm)
    on_b = add(row(poses.position, other), (rows.arm[k, 3], rows.arm[k, 4], rows.arm[k, 5]))
    own = turned_back(columns(poses.rotation, body), arm)
    depth = dot(n, sub(on_b, add(row(o.aim, link), turned(columns(o.frame, link), own))))
    driven = displacement(skel, link, on_a, poses, state.axes, state.inertia.target_motion)
    speed = norm(driven) / state.tracking.frame_time[avatar]
    most *= exp(-((speed / settings.sticking_speed) ** 2))
    if not (most > NOTHING and depth > NOTHING):
        return
    motion = displacement(skel, link, on_a, poses, state.axes, o.newton)
    slip, first = sub(motion, scale(n, dot(n, motion))), rows.used[0]
    along_slip = scale(slip, 1.0 / norm(slip)) if norm(slip) > NOTHING else perpendicular(n)
    for t in (along_slip, cross(n, along_slip)):
        add_contact(rig, a, b, t, on_a, on_b, 0.0, poses, state.axes, scratch_out.still, scratch_out)
    transform(avatars, scratch_out)
    for q in range(first, rows.used[0]):
        limit = depth * state.tracking.share[avatar] / (rows.gram[q, q] + SOFTNESS)
        rows.kind[q], rows.most[q] = FRICTION, min(most, limit)
        rows.least[q] = -rows.most[q]


@kernel
def displacement(skel: Skeleton, link: int, point: Vec3, poses: Poses, axes: Rows, step: Array) -> Vec3:
    """Return the displacement [m] of a point of a link by a step (nd), to first order."""
    total = (0.0, 0.0, 0.0)
    while link >= 0:
        d, last = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == FREE:
            total = add(total, (step[d], step[d + 1], step[d + 2]))
            d += 3
        elif skel.kind[link] == SLIDE:
            total, d = along(total, step[d], row(axes, d)), last
        arm = sub(point, row(poses.position, skel.first + link))
        for j in range(d, last):
            total = along(total, step[j], cross(row(axes, j), arm))
        link = skel.parent[link]
    return total
