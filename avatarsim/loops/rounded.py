"""Curvature at contacts: radii of curvature of both surfaces, and edges across which the normal stays."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.smooth import gathered, stretched
from avatarsim.impact.contacts import ROUND_A, ROUND_B, Contacts, axis
from avatarsim.jit.kernel import kernel
from avatarsim.loops.foremost import foremost
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, dot, neg, norm, put_row, row, scale, sub
from avatarsim.world.geometry import Poses
from avatarsim.world.shapes import POINTS, Shapes

Array = NDArray[np.float64]

EVEN = 1e-7
"""Corners that are lower along a normal than the farthest by no more than this part of a shape's size touch as well. Larger:
balls near a corner count as on its edge; smaller than what the normal is accurate to: balls on a face count as on its edge."""

INSIDE = 1e-6
"""A point of a segment that is farther from both of its ends than this part of its length is no end."""

CORNER, EDGE, FACE = 1, 2, 3
"""How many corners are farthest; three stand for all more."""


@kernel
def is_smooth(shapes: Shapes, s: int) -> bool:
    """Whether the surface of shape s has radii of curvature."""
    return bool(shapes.kind[s] != POINTS or shapes.radius[s] > 0.0)


@kernel
def facing(vertices: Rows, shapes: Shapes, s: int, m: Vec3, touching: Vec3) -> tuple[int, Vec3]:
    """(CORNER, EDGE or FACE of shape s that is farthest along m, direction of the edge) where it touches at ``touching``.

    Where an edge ends it is a corner, and its direction is given all the same. The ball around the points does not matter.
    """
    none = (0.0, 0.0, 0.0)
    if shapes.kind[s] != POINTS:
        return CORNER, none
    count, p, q = foremost(vertices, shapes, s, m, EVEN * shapes.extent[s])
    if count == 1:
        return CORNER, none
    if count > 2:
        return FACE, none
    edge = sub(q, p)
    length = norm(edge)
    place = dot(sub(touching, p), edge) / (length * length)
    return EDGE if INSIDE < place < 1.0 - INSIDE else CORNER, edge


@kernel
def is_lone(shapes: Shapes, s: int) -> bool:
    """Whether shape s touches in one point whatever it touches: a ball or an ellipsoid."""
    return bool(shapes.kind[s] != POINTS or shapes.start[s + 1] - shapes.start[s] == 1)


@kernel
def put_radius(radius: float, m: Vec3, out: Array) -> None:
    """`put_radii` of points swept by a ball."""
    for i in range(3):
        e = (1.0 if i == 0 else 0.0, 1.0 if i == 1 else 0.0, 1.0 if i == 2 else 0.0)
        put_row(out, i, scale(along(e, -m[i], m), radius))


@kernel
def put_radii(vertices: Rows, shapes: Shapes, s: int, m: Vec3, out: Array) -> None:
    """Second derivative of the support function of shape s at the unit normal m [m], (3, 3): how far its point moves per turn."""
    if shapes.kind[s] == POINTS:
        put_radius(shapes.radius[s], m, out)
        return
    weights = stretched(vertices, shapes, s, m)
    length = norm(weights)
    point = gathered(vertices, shapes, s, scale(weights, 1.0 / length))
    first = shapes.start[s]
    for i in range(3):
        squares = gathered(vertices, shapes, s, (vertices[first + 1, i], vertices[first + 2, i], vertices[first + 3, i]))
        put_row(out, i, scale(along(squares, -point[i], point), 1.0 / length))


@kernel
def note_smooth(
    vertices: Rows, shapes: Shapes, contacts: Contacts, poses: Poses, sa: int, sb: int, raw: Vec3, first: int
) -> None:
    """Fill what `impact.rolling` needs for the contacts of shapes sa and sb, from ``first`` on; ``raw``: normal of the query.

    Two points that are of no face are those of edges along each other: both count as edges to their very ends. The manifold takes
    whatever a ball touches for a face; it may be an edge or a corner.
    """
    smooth = (ROUND_A if is_smooth(shapes, sa) else 0) + (ROUND_B if is_smooth(shapes, sb) else 0)
    lone, several = is_lone(shapes, sa) or is_lone(shapes, sb), contacts.used[0] - first > 1
    for k in range(first, contacts.used[0]):
        n = axis(contacts, k, 0)
        contacts.smooth[k] = smooth
        put_radii(vertices, shapes, sa, neg(n), contacts.radii_a[k])
        put_radii(vertices, shapes, sb, n, contacts.radii_b[k])
        if contacts.face[k] != 0 and not lone:
            continue
        on_a = add(row(poses.position, contacts.body[k, 0]), row(contacts.arm_a, k))
        on_b = add(row(poses.position, contacts.body[k, 1]), row(contacts.arm_b, k))
        kind_a, e = facing(vertices, shapes, sa, neg(raw), on_a)
        kind_b, f = facing(vertices, shapes, sb, raw, on_b)
        contacts.face[k] = 1 if kind_a == FACE else (2 if kind_b == FACE else 0)
        if kind_a == EDGE or (kind_a == CORNER and several):
            put_row(contacts.edge_a, k, e)
        if kind_b == EDGE or (kind_b == CORNER and several):
            put_row(contacts.edge_b, k, f)
