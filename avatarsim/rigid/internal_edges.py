"""Internal edges (ghost collisions: Catto, box2d.org 2020): contacts at the seam of two flush pieces get the normal of the face.

Just before a seam the closest point of the next piece is its edge, a few nanometres ahead and as many below, and the normal to it
leans. Where the body already has a contact with the normal m of a face, and along m every point of the next piece lies below the
body's lowest one, the edge cannot block it: the contact then gets m as its normal. No adjacency is stored: pieces may be of one
body or of several, boxes or hulls.

A step up to FLUSH is passed over and no higher one, which is within the dip of resting bodies.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import CREEP, DIP, RESTING, follow_both, slowest_touch
from avatarsim.collision.support import foremost, gap_along
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Velocities
from avatarsim.model.geometry import POINTS, Geometry, Poses, Shapes
from avatarsim.rigid.contacts import NORMAL_OF_ANOTHER, NOT_DRIVEN, POINTS_OF_PAIR, SHARP, Contacts, axis, velocity_at
from avatarsim.rigid.rolling import put_radius
from avatarsim.rigid.state import Memory
from avatarsim.spatial.tangent import columns, turned, turned_back
from avatarsim.spatial.vec3 import Rows, Vec3, along, cross, dot, neg, norm, perpendicular, put_row, row, sub
from avatarsim.tolerances import FINE, JUDGED, PROOF, SLIGHT

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FLUSH = -0.5 * JUDGED
"""Gap [m] along a neighbour's normal from which on two pieces count as flush. Must be below the dip of resting bodies, which
slide on at that depth, and above the depth at which positions are corrected."""

SAME = PROOF
"""Normals nearer to each other than this are the same."""

BEHIND = -FINE
"""Normals that point against each other by more than this are of two sides of a body. Nearer to 0: a body that tilts a little is
stopped by the side of the next piece."""

EVEN = SLIGHT
"""Corners within this part of a piece's size below the highest along a normal are of one face."""

LOOKS = 16
"""Most contacts of a body that are tried for a normal. A face on more pieces than that has them all in one plane."""

FASTER = JUDGED
"""[m/s] by which the body must leave a face faster for its normal to replace another one."""

NOTHING, NO_FACE = -1, -2
"""End of a list of contacts; mark of a contact whose normal is not that of a face."""


@kernel
def forget_faces(memory: Memory, a: int, b: int) -> None:
    """Empty the lists of face contacts of bodies a and b."""
    memory.newest[a], memory.newest[b] = NOTHING, NOTHING


@kernel
def is_face(vertices: Rows, shapes: Shapes, s: int, d: Vec3) -> bool:
    """Return True if three corners of shape s or more are farthest in direction d."""
    if shapes.start[s + 1] - shapes.start[s] < 3:
        return False
    count, _, _ = foremost(vertices, shapes, s, d, EVEN * shapes.extent[s])
    return count >= 3


@kernel
def note(geometry: Geometry, poses: Poses, memory: Memory, sa: int, sb: int, k: int) -> None:
    """Add contact k, the first of shapes sa and sb, to the lists of its bodies if its normal is that of a face."""
    contacts, shapes = memory.contacts, geometry.shapes
    memory.older[k, 0] = NO_FACE
    if contacts.driven[k] != NOT_DRIVEN or shapes.kind[sa] != POINTS or shapes.kind[sb] != POINTS:
        return
    n = axis(contacts, k, 0)
    if is_face(poses.vertices, shapes, sb, n) or is_face(poses.vertices, shapes, sa, neg(n)):
        for side in range(2):
            b = contacts.body[k, side]
            memory.older[k, side] = memory.newest[b]
            memory.newest[b] = k


@kernel
def of_pair(memory: Memory, k: int, side: int, j: int) -> Vec3:
    """Return the normal of contact j of the body on this side of contact k, with its sign in the pair of contact k."""
    contacts = memory.contacts
    n = axis(contacts, j, 0)
    return n if contacts.body[j, side] == contacts.body[k, side] else neg(n)


@kernel
def before(memory: Memory, b: int, j: int) -> int:
    """Return the contact of body b listed before j; NOTHING if there is none."""
    return int(memory.older[j, 0] if memory.contacts.body[j, 0] == b else memory.older[j, 1])


@kernel
def level_seams(geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory) -> None:
    """Give contacts at internal edges the normal of the face that continues there; of several, the face left fastest."""
    contacts, shapes, pieces = memory.contacts, geometry.shapes, geometry.body.shape[0]
    for k in range(contacts.used[0]):
        pair = contacts.key[k] // POINTS_OF_PAIR
        if contacts.driven[k] != NOT_DRIVEN or (k > 0 and contacts.key[k - 1] // POINTS_OF_PAIR == pair):
            continue
        sa, sb = pair // pieces, pair % pieces
        if shapes.kind[sa] != POINTS or shapes.kind[sb] != POINTS:
            continue
        n, best, fastest = axis(contacts, k, 0), NOTHING, -inf
        v = velocity_at(contacts, k, velocities.linear, velocities.angular)
        m = n
        if memory.older[k, 0] != NO_FACE:
            fastest = dot(n, v)
        for side in range(2):
            b = contacts.body[k, side]
            j = memory.newest[b] if memory.moving[b] == 1 else NOTHING
            for _ in range(LOOKS):
                if j == NOTHING:
                    break
                other = of_pair(memory, k, side, j)
                if j != k and dot(other, n) > BEHIND and norm(sub(other, n)) > SAME and dot(other, v) > fastest + FASTER:
                    if gap_along(poses.vertices, shapes, sa, sb, other) > FLUSH:
                        best, fastest, m = j, dot(other, v), other
                j = before(memory, b, j)
        if best != NOTHING:
            owner = NOTHING if contacts.face[best] == 0 else contacts.body[best, contacts.face[best] - 1]
            lean(contacts, k, pair, m, shapes.radius[sa], shapes.radius[sb], owner)


@kernel
def lean(contacts: Contacts, first: int, pair: int, m: Vec3, radius_a: float, radius_b: float, owner: int) -> None:
    """Give all contacts of this pair of shapes, from the first on, the normal m, which turns with body ``owner``."""
    for k in range(first, contacts.used[0]):
        if contacts.key[k] // POINTS_OF_PAIR != pair:
            break
        n = axis(contacts, k, 0)
        turned_by = sub(n, m)
        # the points of the cores stay; those on the surface are a radius away along the normal
        contacts.gap[k] -= 0.5 * dot(turned_by, turned_by) * (contacts.gap[k] + radius_a + radius_b)
        put_row(contacts.arm_a, k, along(row(contacts.arm_a, k), radius_a, turned_by))
        put_row(contacts.arm_b, k, along(row(contacts.arm_b, k), -radius_b, turned_by))
        t = perpendicular(m)
        put_row(contacts.frame[k], 0, m)
        put_row(contacts.frame[k], 1, t)
        put_row(contacts.frame[k], 2, cross(m, t))
        put_row(contacts.edge_a, k, (0.0, 0.0, 0.0))
        put_row(contacts.edge_b, k, (0.0, 0.0, 0.0))
        contacts.face[k] = 1 if owner == contacts.body[k, 0] else (2 if owner == contacts.body[k, 1] else 0)
        if contacts.smooth[k] != SHARP:
            put_radius(radius_a, m, contacts.radii_a[k])
            put_radius(radius_b, m, contacts.radii_b[k])
            if contacts.face[k] == 0:
                contacts.smooth[k] |= NORMAL_OF_ANOTHER


@kernel
def least_height(rows: Array, count: int) -> float:
    """Return the height [m] of the lowest vertex over the plane."""
    least = inf
    for i in range(count):
        least = min(least, rows[i, 0])
    return least


@kernel
def depth_to_pass(geometry: Geometry, memory: Memory, sa: int, sb: int, left: float) -> float:
    """Return, for shapes sa and sb that meet at the poses of ``memory.trial``, the gap [m] < 0 below which their contact is an
    event if it is at an internal edge, else 0."""
    contacts, islands, paths, trial = memory.contacts, memory.islands, memory.paths, memory.trial
    pair, slow = sa * geometry.body.shape[0] + sb, RESTING * contacts.pace[0]
    for side in range(2):
        b = geometry.body[sa if side == 0 else sb]
        j = memory.newest[b] if memory.moving[b] == 1 else NOTHING
        for _ in range(LOOKS):
            if j == NOTHING:
                break
            if contacts.key[j] // POINTS_OF_PAIR != pair:
                m = axis(contacts, j, 0)
                m = m if contacts.body[j, side] == b else neg(m)
                if contacts.face[j] > 0 and contacts.body[j, contacts.face[j] - 1] == b:
                    m = turned(columns(trial.rotation, b), turned_back(columns(memory.began.rotation, b), m))
                count_a, count_b, _ = follow_both(
                    geometry, islands.angular, paths, memory.reach, sa, sb, m, left, trial, memory.a_rows, memory.b_rows
                )
                gap = least_height(memory.a_rows, count_a)
                if gap > FLUSH and max(slowest_touch(memory.a_rows, count_a), slowest_touch(memory.b_rows, count_b)) > slow:
                    return min(DIP, gap - CREEP)
            j = before(memory, b, j)
    return 0.0
