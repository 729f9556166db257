"""Initial tetrahedron of EPA: four affinely independent points of A - B."""

from avatarsim.collide.gjk import Balls, add_support
from avatarsim.collide.scratch import Scratch
from avatarsim.collide.simplex import upright
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import (
    Rows,
    Vec3,
    along,
    cross,
    dot,
    neg,
    norm,
    perpendicular,
    put_row,
    row,
    scale,
    sub,
)
from avatarsim.world.shapes import Shapes

INDEPENDENT = 1e-3
"""Relative to the shapes' size: a point that GJK left is kept only if it is this far off the others' point,
line or plane. A flat first tetrahedron is legal but gives thin faces; a new support is cheap."""

FLAT = 1e-12
"""Relative to the shapes' size: if no support leaves the others' plane by more, A - B has no inside."""


@kernel
def off_the_others(points: int, w: Vec3, scratch: Scratch) -> float:
    """Distance of w from the point, line or plane through the first 1, 2 or 3 points."""
    from_first = sub(w, row(scratch.w, 0))
    if points == 1:
        return norm(from_first)
    edge = sub(row(scratch.w, 1), row(scratch.w, 0))
    if points == 2:
        return norm(cross(from_first, edge)) / norm(edge)
    n = upright(edge, sub(row(scratch.w, 2), row(scratch.w, 0)))
    return abs(dot(from_first, n)) / norm(n)


@kernel
def outward_try(points: int, k: int, scratch: Scratch) -> Vec3:
    """The k-th direction (of 6) in which to look for a point off the first ``points``."""
    if points == 1:
        sign = 1.0 if k < 3 else -1.0
        axis = k % 3
        return (sign if axis == 0 else 0.0, sign if axis == 1 else 0.0, sign if axis == 2 else 0.0)
    edge = sub(row(scratch.w, 1), row(scratch.w, 0))
    if points == 2:
        # Six directions 60 degrees apart around the edge: 1/2 and sqrt(3)/2.
        edge = scale(edge, 1.0 / norm(edge))
        x = perpendicular(edge)
        y = cross(edge, x)
        third = k % 3
        d = x
        if third == 1:
            d = along(scale(x, 0.5), 0.8660254037844386, y)
        elif third == 2:
            d = along(scale(x, -0.5), 0.8660254037844386, y)
        return d if k < 3 else neg(d)
    n = upright(edge, sub(row(scratch.w, 2), row(scratch.w, 0)))
    return n if k % 2 == 0 else neg(n)


@kernel
def move_point(source: int, target: int, scratch: Scratch) -> None:
    """Copy a point of A - B with all that belongs to it to another slot."""
    put_row(scratch.w, target, row(scratch.w, source))
    put_row(scratch.on_a, target, row(scratch.on_a, source))
    put_row(scratch.on_b, target, row(scratch.on_b, source))
    scratch.rows[target, 0] = scratch.rows[source, 0]
    scratch.rows[target, 1] = scratch.rows[source, 1]


@kernel
def grow_tetrahedron(
    vertices: Rows, shapes: Shapes, a: int, b: int, balls: Balls, count: int, size: float, scratch: Scratch
) -> int:
    """Make four independent points of A - B in the first rows of the scratch, starting from the ``count``
    there.

    Point 3 ends up below the plane 0 1 2 (corners counter-clockwise from above). Returns 4, or fewer if A - B
    is flat: 3 a plane, 2 a line, 1 a point; the points then span it.
    """
    points = 1
    for i in range(1, count):
        if points < 4 and off_the_others(points, row(scratch.w, i), scratch) > INDEPENDENT * size:
            move_point(i, points, scratch)
            points += 1
    while points < 4:
        best = FLAT * size
        found = False
        for k in range(6 if points < 3 else 2):
            # The best candidate so far is in the next slot, the one being tried in the slot after it.
            w = add_support(vertices, shapes, a, b, outward_try(points, k, scratch), balls, points + 1, scratch)
            far = off_the_others(points, w, scratch)
            if far > best:
                best, found = far, True
                move_point(points + 1, points, scratch)
        if not found:
            return points
        points += 1
    p = row(scratch.w, 0)
    n = upright(sub(row(scratch.w, 1), p), sub(row(scratch.w, 2), p))
    if dot(n, sub(row(scratch.w, 3), p)) > 0.0:
        # Points 1 and 2 change places by way of slot 4. Slots are counted from ``points``, which is 4, because every
        # literal argument would make the compiler write the whole function again.
        move_point(points - 3, points, scratch)
        move_point(points - 2, points - 3, scratch)
        move_point(points, points - 2, scratch)
    return points
