"""Contact manifolds of two convex shapes: their touching features clipped against each other, at most eight points.

Clipping is that of Sutherland and Hodgman (1974), see `collision.manifold`.

Convex polygons in a plane: hull by gift wrapping, clipping of one by another (Sutherland and Hodgman 1974).

Rows are (u, v, height).
"""

from math import cos, inf, pi, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexLine, Line, Vectors
from avatarsim.model.geometry import POINTS, Shapes
from avatarsim.spatial.vec3 import (
    Rows,
    Vec3,
    add,
    along,
    cross,
    dot,
    perpendicular,
    put_row,
    row,
    scale,
    sub,
    unit,
)
from avatarsim.tolerances import NOTHING, ROUNDING, SAME_DIRECTION

Array = NDArray[np.float64]

SLIVER = 1e-5
"""Polygons of less area than this part of their squared perimeter are taken as segments: their plane is noise. Larger: narrow
faces count as edges; smaller: the noise tilts contact normals."""


@kernel
def copy_row(source: Array, i: int, out: Array, k: int) -> None:
    """Set out[k] = source[i], three numbers."""
    out[k, 0], out[k, 1], out[k, 2] = source[i, 0], source[i, 1], source[i, 2]


@kernel
def left_of(ax: float, ay: float, bx: float, by: float, px: float, py: float) -> float:
    """Return twice the area of the triangle a, b, p: positive if p is left of the line from a to b."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel
def wrap(points: Array, count: int, equal: float, out: Array) -> int:
    """Write the convex hull of the first ``count`` points, counter-clockwise, into ``out``; return its number of corners.

    Points closer than ``equal`` are one. Points on an edge are left out.
    """
    first = 0
    for i in range(1, count):
        if points[i, 0] < points[first, 0] or (points[i, 0] == points[first, 0] and points[i, 1] < points[first, 1]):
            first = i
    at, corners = first, 0
    for _ in range(count):
        copy_row(points, at, out, corners)
        corners += 1
        best, far = -1, 0.0
        x, y = points[at, 0], points[at, 1]
        for i in range(count):
            dx, dy = points[i, 0] - x, points[i, 1] - y
            square = dx * dx + dy * dy
            if i == at or square <= equal * equal:
                continue
            if best < 0:
                best, far = i, square
                continue
            side = left_of(x, y, points[best, 0], points[best, 1], points[i, 0], points[i, 1])
            # i right of the present candidate: it is nearer to the hull; in line with it: the farther one
            if side < -equal * far**0.5 or (side <= equal * far**0.5 and square > far):
                best, far = i, square
        if best < 0:
            break
        dx, dy = points[best, 0] - points[first, 0], points[best, 1] - points[first, 1]
        if dx * dx + dy * dy <= equal * equal:
            break
        at = best
    return corners


@kernel
def flat(corner: Array, count: int) -> bool:
    """Return True if a polygon is a sliver, or no polygon at all."""
    if count < 3:
        return True
    area, perimeter = 0.0, 0.0
    for i in range(count):
        k = (i + 1) % count
        area += 0.5 * left_of(corner[0, 0], corner[0, 1], corner[i, 0], corner[i, 1], corner[k, 0], corner[k, 1])
        perimeter += ((corner[k, 0] - corner[i, 0]) ** 2 + (corner[k, 1] - corner[i, 1]) ** 2) ** 0.5
    return not (area > SLIVER * perimeter * perimeter)


@kernel
def to_segment(corner: Array, count: int) -> int:
    """Keep the two corners that are farthest apart; return how many are left."""
    if count <= 2:
        return count
    p, q, far = 0, 1, -1.0
    for i in range(count):
        for k in range(i + 1, count):
            square = (corner[i, 0] - corner[k, 0]) ** 2 + (corner[i, 1] - corner[k, 1]) ** 2
            if square > far:
                p, q, far = i, k, square
    # p < q, so q is still in its place after p was moved
    copy_row(corner, p, corner, 0)
    copy_row(corner, q, corner, 1)
    return 2


@kernel
def slope(corner: Array, count: int) -> tuple[float, float, float]:
    """Return (c, p, q) with height = c + p u + q v over a polygon (Newell's normal) or along a segment."""
    if count < 2:
        return corner[0, 2], 0.0, 0.0
    if count == 2:
        du, dv, dh = corner[1, 0] - corner[0, 0], corner[1, 1] - corner[0, 1], corner[1, 2] - corner[0, 2]
        square = du * du + dv * dv
        p, q = dh * du / square, dh * dv / square
        return corner[0, 2] - p * corner[0, 0] - q * corner[0, 1], p, q
    nu, nv, nh, mu, mv, mh = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(count):
        k = (i + 1) % count
        nu += (corner[i, 1] - corner[k, 1]) * (corner[i, 2] + corner[k, 2])
        nv += (corner[i, 2] - corner[k, 2]) * (corner[i, 0] + corner[k, 0])
        nh += (corner[i, 0] - corner[k, 0]) * (corner[i, 1] + corner[k, 1])
        mu, mv, mh = mu + corner[i, 0] / count, mv + corner[i, 1] / count, mh + corner[i, 2] / count
    p, q = -nu / nh, -nv / nh
    return mh - p * mu - q * mv, p, q


@kernel
def cut(points: Array, count: int, a: float, b: float, c: float, out: Array) -> int:
    """Cut a polygon (or segment, given as two corners) to its part with a u + b v <= c; return its number of corners."""
    kept = 0
    for i in range(count):
        k = (i + 1) % count
        here, there = a * points[i, 0] + b * points[i, 1] - c, a * points[k, 0] + b * points[k, 1] - c
        if here <= 0.0:
            copy_row(points, i, out, kept)
            kept += 1
        # the way back along a segment would only find the same point again
        if (here < 0.0 < there or there < 0.0 < here) and not (count == 2 and i == 1) and kept < out.shape[0]:
            s = here / (here - there)
            for x in range(3):
                out[kept, x] = points[i, x] + s * (points[k, x] - points[i, x])
            kept += 1
    return kept


@kernel
def clip(subject: Array, count: int, window: Array, sides: int, other: Array) -> int:
    """Clip ``subject`` in place by a counter-clockwise convex ``window`` of 3 or more sides, or by the strip across a segment.

    ``other`` is working memory as large as ``subject``. Returns the number of corners left.
    """
    for i in range(sides):
        k = (i + 1) % sides
        du, dv = window[k, 0] - window[i, 0], window[k, 1] - window[i, 1]
        # outside is right of a side; of a segment (there and back), beyond its ends
        a, b = (dv, -du) if sides > 2 else (-du, -dv)
        c = a * window[i, 0] + b * window[i, 1]
        left = cut(subject, count, a, b, c, other)
        for x in range(left):
            copy_row(other, x, subject, x)
        count = left
        if count == 0:
            break
    return count


MANIFOLD_POINTS = 8
"""Most contact points of two convex shapes; an octagon of support is as good as the whole face. Fewer: discs rest on less; more:
contacts of faces take longer to solve."""

FEATURE_ROOM = 64
"""Vertices of one touching feature; the face of a hull rarely has ten. Of one with more, those stay that are farthest in so many
directions all around: a disc of a thousand corners rests on all of its rim but a thousandth of its radius."""

PARALLEL = SAME_DIRECTION
"""Sine of the angle below which two edges touch along a stretch and not in a point."""

EQUAL = ROUNDING
"""Relative to the shapes' size: points closer than this are the same point."""


LEANING = 1e-2
"""Rise of a face over its own size up to which it counts as lying on another, and not as resting on its edge. Larger: faces that
rest on an edge get more points than touch; smaller: corners beyond the crossing of two edges are missed."""

EVEN = NOTHING
"""Corners that leave their common plane by more than this part of the shapes' size are of several faces."""

NO_FACE, FACE_OF_A, FACE_OF_B = 0, 1, 2
"""Face that a contact normal belongs to and turns with: none, one of A, one of B."""


class Manifold(NamedTuple):
    """Working memory and result: points on A and on B (8, 3) [m], their gaps (8) [m], the face that the normal belongs to (1):
    0 for none, FACE_OF_A or FACE_OF_B; the rest are polygons (u, v, height)."""

    on_a: Vectors
    on_b: Vectors
    gap: Line
    face: IndexLine
    loose: Vectors
    face_a: Vectors
    face_b: Vectors
    cut: Vectors
    other: Vectors


def make_manifold() -> Manifold:
    """Allocate; one per thread."""
    room, both = (FEATURE_ROOM, 3), (2 * FEATURE_ROOM + 8, 3)
    return Manifold(
        np.zeros((MANIFOLD_POINTS, 3)), np.zeros((MANIFOLD_POINTS, 3)), np.zeros(MANIFOLD_POINTS),
        np.zeros(1, np.int64), np.zeros(room), np.zeros(room),
        np.zeros(room), np.zeros(both), np.zeros(both),
    )


@kernel
def feature(
    vertices: Rows, shapes: Shapes, s: int, side: float, n: Vec3, u: Vec3, v: Vec3, origin: Vec3, band: float, loose: Array,
    out: Array,
) -> int:
    """Write the hull, in (u, v), of vertices of shape s within ``band`` of its farthest along side n; return its corners."""
    first, last = shapes.start[s], shapes.start[s + 1]
    top = side * dot(n, sub(row(vertices, first), origin))
    for i in range(first + 1, last):
        top = max(top, side * dot(n, sub(row(vertices, i), origin)))
    count = 0
    for i in range(first, last):
        d = sub(row(vertices, i), origin)
        height = dot(n, d)
        if side * height >= top - band:
            if count < loose.shape[0]:
                loose[count, 0], loose[count, 1], loose[count, 2] = dot(u, d), dot(v, d), height
            count += 1
    if count > loose.shape[0]:
        farthest_around(vertices, shapes, s, side, n, u, v, origin, top - band, loose)
        count = loose.shape[0]
    corners = wrap(loose, count, EQUAL * shapes.extent[s], out)
    return to_segment(out, corners) if flat(out, corners) else corners


@kernel
def farthest_around(
    vertices: Rows, shapes: Shapes, s: int, side: float, n: Vec3, u: Vec3, v: Vec3, origin: Vec3, least: float, loose: Array
) -> None:
    """Write, of the vertices of shape s at least ``least`` high, the farthest in as many directions as there is room for."""
    room = loose.shape[0]
    for k in range(room):
        turn, most = 2.0 * pi * k / room, -inf
        for i in range(shapes.start[s], shapes.start[s + 1]):
            d = sub(row(vertices, i), origin)
            height, x, y = dot(n, d), dot(u, d), dot(v, d)
            far = cos(turn) * x + sin(turn) * y
            if side * height >= least and far > most:
                most = far
                loose[k, 0], loose[k, 1], loose[k, 2] = x, y, height


@kernel
def beyond_edge(
    vertices: Rows, shapes: Shapes, s: int, side: float, n: Vec3, u: Vec3, v: Vec3, origin: Vec3, size: float, loose: Array,
    out: Array,
) -> int:
    """Write the face behind an edge that lies on a face, in place of the edge, if it is tilted against that by less than LEANING.

    Where the edges of two faces cross at a small angle, the touching corner beyond the crossing is one of the other face, and no
    point of the edge. ``out`` holds the edge; returns its new number of corners.
    """
    first, second = row(out, 0), row(out, 1)
    corners = feature(vertices, shapes, s, side, n, u, v, origin, LEANING * shapes.extent[s], loose, out)
    if corners >= 3:
        c, p, q = slope(out, corners)
        even = True
        for i in range(corners):
            even = even and abs(out[i, 2] - (c + p * out[i, 0] + q * out[i, 1])) <= EVEN * size
        if even:
            return corners
    put_row(out, 0, first)
    put_row(out, 1, second)
    return 2


@kernel
def only_witness(found: Manifold, on_a: Vec3, on_b: Vec3, gap: float) -> int:
    """Return the closest points alone."""
    put_row(found.on_a, 0, on_a)
    put_row(found.on_b, 0, on_b)
    found.gap[0] = gap
    return 1


@kernel
def manifold(
    vertices: Rows, shapes: Shapes, a: int, b: int, n: Vec3, on_a: Vec3, on_b: Vec3, gap: float, band: float, found: Manifold
) -> tuple[int, Vec3]:
    """Return contact points of shapes a and b whose gap is below ``band`` [m].

    Args:
        n, on_a, on_b, gap: from `signed_distance`.

    Returns:
        (count, n): points in the first rows of ``found``, at least the closest pair, and the normal, taken from a face where one
        takes part (exact, while that of two points a stand-off apart has eight digits).
    """
    lone_a = shapes.kind[a] != POINTS or shapes.start[a + 1] - shapes.start[a] == 1
    lone_b = shapes.kind[b] != POINTS or shapes.start[b + 1] - shapes.start[b] == 1
    found.face[0] = NO_FACE
    if lone_a or lone_b:
        if lone_a != lone_b:
            found.face[0] = FACE_OF_B if lone_a else FACE_OF_A
        return only_witness(found, on_a, on_b, gap), n
    size = max(shapes.extent[a], shapes.extent[b])
    # everything nearer than the band takes part, however deep the deepest point has dipped
    tolerance = band - min(gap, 0.0) + NOTHING * size
    u = perpendicular(n)
    v = cross(n, u)
    origin = scale(add(on_a, on_b), 0.5)
    corners_a = feature(vertices, shapes, a, -1.0, n, u, v, origin, tolerance, found.loose, found.face_a)
    corners_b = feature(vertices, shapes, b, 1.0, n, u, v, origin, tolerance, found.loose, found.face_b)
    if corners_a >= 3 or corners_b >= 3:
        found.face[0] = FACE_OF_B if corners_b >= 3 else FACE_OF_A
    if corners_a < 2 or corners_b < 2:
        return lone_corner(n, u, v, on_a, on_b, gap, corners_a, corners_b, found)
    face_b = corners_b >= 3
    if face_b and corners_a == 2:
        corners_a = beyond_edge(vertices, shapes, a, -1.0, n, u, v, origin, size, found.loose, found.face_a)
    elif corners_a >= 3 and corners_b == 2:
        corners_b = beyond_edge(vertices, shapes, b, 1.0, n, u, v, origin, size, found.loose, found.face_b)
    subject, window = found.face_a, found.face_b
    corners, sides = corners_a, corners_b
    if corners_b == 2 and corners_a > 2:
        subject, window = found.face_b, found.face_a
        corners, sides = corners_b, corners_a
    if corners == 2 and sides == 2:
        eu, ev = subject[1, 0] - subject[0, 0], subject[1, 1] - subject[0, 1]
        fu, fv = window[1, 0] - window[0, 0], window[1, 1] - window[0, 1]
        if abs(eu * fv - ev * fu) > PARALLEL * ((eu * eu + ev * ev) * (fu * fu + fv * fv)) ** 0.5:
            return only_witness(found, on_a, on_b, gap), n
    for i in range(corners):
        copy_row(subject, i, found.cut, i)
    count = clip(found.cut, corners, window, sides, found.other)
    kept = spread_points(found, count, corners_a, corners_b, shapes.radius[a] + shapes.radius[b], band, EQUAL * size)
    if kept == 0:
        return only_witness(found, on_a, on_b, gap), n
    better = n
    if face_b:
        better = tilted(n, u, v, found.face_b, corners_b)
    elif corners_a >= 3:
        better = tilted(n, u, v, found.face_a, corners_a)
    place_points(kept, origin, u, v, n, shapes.radius[a], shapes.radius[b], found)
    return kept, better


@kernel
def place_points(
    count: int, origin: Vec3, u: Vec3, v: Vec3, n: Vec3, radius_a: float, radius_b: float, found_out: Manifold
) -> None:
    """Write the points on both surfaces from their places in the plane, and from the heights of the cores over it."""
    for i in range(count):
        p = along(along(origin, found_out.other[i, 0], u), found_out.other[i, 1], v)
        put_row(found_out.on_a, i, along(p, found_out.on_a[i, 2] - radius_a, n))
        put_row(found_out.on_b, i, along(p, found_out.on_b[i, 2] + radius_b, n))


@kernel
def lone_corner(
    n: Vec3, u: Vec3, v: Vec3, on_a: Vec3, on_b: Vec3, gap: float, corners_a: int, corners_b: int, found: Manifold
) -> tuple[int, Vec3]:
    """Return `manifold` of a corner and a face, whose normal is exact, or of a corner and an edge or corner."""
    if corners_a < 3 and corners_b < 3:
        return only_witness(found, on_a, on_b, gap), n
    n = tilted(n, u, v, found.face_b, corners_b) if corners_b >= 3 else tilted(n, u, v, found.face_a, corners_a)
    along_n = dot(n, sub(on_a, on_b))
    # the closest point of the lone corner stays; its partner is straight across
    if corners_a < 2:
        return only_witness(found, on_a, along(on_a, -along_n, n), along_n), n
    return only_witness(found, along(on_b, along_n, n), on_b, along_n), n


@kernel
def tilted(n: Vec3, u: Vec3, v: Vec3, face: Array, corners: int) -> Vec3:
    """Return the normal of a face given as heights over (u, v), on the side of n."""
    _, p, q = slope(face, corners)
    return unit(sub(n, add(scale(u, p), scale(v, q))))


@kernel
def spread_points(
    found: Manifold, count: int, corners_a: int, corners_b: int, radii: float, band: float, equal: float
) -> int:
    """Keep the clipped points whose gap is below ``band``, at most eight: those that reach farthest in eight directions.

    Leaves (u, v) in ``found.other``, the heights of A and B in the third column of on_a and on_b, and the gaps.
    """
    ca, pa, qa = slope(found.face_a, corners_a)
    cb, pb, qb = slope(found.face_b, corners_b)
    near = 0
    for i in range(count):
        x, y = found.cut[i, 0], found.cut[i, 1]
        gap = ca + pa * x + qa * y - (cb + pb * x + qb * y) - radii
        fresh = gap < band
        for k in range(near):
            if abs(found.cut[k, 0] - x) <= equal and abs(found.cut[k, 1] - y) <= equal:
                fresh = False
        if fresh:
            found.cut[near, 0], found.cut[near, 1], found.cut[near, 2] = x, y, 0.0
            near += 1
    if near > MANIFOLD_POINTS:
        for turn in range(MANIFOLD_POINTS):
            # eight directions, none along an edge of an axis-aligned face
            angle = 0.3 + 0.25 * np.pi * turn
            c, s = np.cos(angle), np.sin(angle)
            best = 0
            for i in range(1, near):
                if c * found.cut[i, 0] + s * found.cut[i, 1] > c * found.cut[best, 0] + s * found.cut[best, 1]:
                    best = i
            found.cut[best, 2] = 1.0
    kept = 0
    for i in range(near):
        if near > MANIFOLD_POINTS and found.cut[i, 2] == 0.0:
            continue
        x, y = found.cut[i, 0], found.cut[i, 1]
        found.other[kept, 0], found.other[kept, 1] = x, y
        found.on_a[kept, 2], found.on_b[kept, 2] = ca + pa * x + qa * y, cb + pb * x + qb * y
        found.gap[kept] = found.on_a[kept, 2] - found.on_b[kept, 2] - radii
        kept += 1
    return kept
