"""Expanding polytope algorithm (van den Bergen 2003), signed: penetration depth of two convex cores.

The depth is the origin's distance from the surface of A - B. The polytope grows inside A - B; always the face with the smallest
*signed* distance from the origin is pushed out to the support along its normal, until the support lies on the face. Signed, so
that the first tetrahedron need not contain the origin, and an origin that GJK could not place gets its sign here. Every support
is itself an upper bound: moving by it separates.
"""

from math import inf

from avatarsim.collide.gjk import NOWHERE, WHOLE, Balls, add_support
from avatarsim.collide.polytope import cone_to, corners, find_horizon, lowest_face, start_polytope
from avatarsim.collide.scratch import POINTS_CAP, Scratch, number
from avatarsim.collide.simplex import closest_on_triangle, upright
from avatarsim.collide.status import CONVERGED, DEGENERATE, NOT_FINITE, OUT_OF_ITERATIONS
from avatarsim.collide.tetrahedron import grow_tetrahedron
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, along, dot, norm, perpendicular, row, scale, sub
from avatarsim.world.shapes import POINTS, Shapes

EXACT = 1e-12
"""Relative to the shapes' size: support minus face at which a polytope's depth is found. True faces differ by
rounding only."""

SMOOTH = 5e-10
"""The same for ellipsoids, whose surface facets only approach. Tighter: more iterations than the scratch has
points."""

VISIBLE = 1e-14
"""Relative to the shapes' size: a face is removed if the new point is above it by more. Larger: thin slivers
stay as dents; smaller: rounding decides which of several coplanar faces go, and the horizon may tear."""

SAME_FACE = 1e-9
"""Relative height, and one minus cosine: faces this alike are parts of one facet when the witness point is
looked for."""


POINTS_APART = 1e-10
"""Relative to the shapes' size: witness points that differ from depth m by more do not prove the depth from below as m does from
above. Larger: rounding passes for an answer; smaller: it is reported as DEGENERATE where it is as good as coordinates allow."""


@kernel
def epa(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, count: int, scratch: Scratch
) -> tuple[int, Vec3, float, int, int]:
    """Depth of the cores of shapes a and b, from the first ``count`` points that `gjk` left in the scratch.

    Returns:
        (status, m, depth, points, faces). m is the unit normal of A - B at its surface point nearest to the origin:
        moving a by -depth m separates, whatever the status (unless NOT_FINITE). depth < 0: m proves the cores
        apart. A - B flat (two segments, a point and a point): depth 0, m at right angles to it and on the
        side of -seed, faces 0. Otherwise so many points and face slots are in use.
    """
    size = max(shapes.extent[a], shapes.extent[b])
    both_points = shapes.kind[a] == POINTS and shapes.kind[b] == POINTS
    tolerance = (EXACT if both_points else SMOOTH) * size
    status, m, depth, points, faces, _ = epa_to(vertices, shapes, a, b, seed, WHOLE, count, tolerance, scratch)
    return status, m, depth, points, faces


@kernel
def epa_to(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, balls: Balls, count: int, tolerance: float, scratch: Scratch
) -> tuple[int, Vec3, float, int, int, int]:
    """As `epa` of the cores without the balls, to a tolerance [m]; the face that is lowest comes last."""
    size = max(shapes.extent[a], shapes.extent[b])
    points = grow_tetrahedron(vertices, shapes, a, b, balls, count, size, scratch)
    if points < 4:
        return CONVERGED, flat_normal(points, seed, scratch), 0.0, points, 0, 0
    if not start_polytope(scratch):
        m = flat_normal(points - 1, seed, scratch)
        return DEGENERATE, m, dot(add_support(vertices, shapes, a, b, m, balls, points, scratch), m), points, 0, 0
    return expand(vertices, shapes, a, b, balls, points, points, tolerance, scratch)


@kernel
def expand(
    vertices: Rows, shapes: Shapes, a: int, b: int, balls: Balls, points: int, faces: int, tolerance: float, scratch: Scratch
) -> tuple[int, Vec3, float, int, int, int]:
    """Push out the polytope of ``points`` points and ``faces`` face slots that is in the scratch until its lowest face
    is on the surface of A - B but for ``tolerance`` [m].

    Returns:
        (status, m, depth, points, faces) as `epa`, and the lowest face. Why CONVERGED with depth > 0 holds for *any*
        closed oriented surface whose corners are points of A - B, convex or not: if every face has the origin below its
        plane, each covers a positive solid angle seen from there, so together they cover every direction, and what they
        bound holds a ball of the lowest height; the support says that no larger one fits.
    """
    size = max(shapes.extent[a], shapes.extent[b])
    least, toward = inf, NOWHERE
    while True:
        f, lowest = lowest_face(faces, scratch)
        if f < 0:
            return NOT_FINITE, toward, least, points, faces, f
        m = row(scratch.normal, f)
        slot = min(points, POINTS_CAP - 1)
        w = add_support(vertices, shapes, a, b, m, balls, slot, scratch)
        depth = dot(w, m)
        if depth - lowest <= tolerance or depth < 0.0:
            return CONVERGED, m, depth, points, faces, f
        if depth < least:
            least, toward = depth, m
        if points == POINTS_CAP - 1:
            return OUT_OF_ITERATIONS, toward, least, points, faces, f
        if not (depth < inf):
            return NOT_FINITE, toward, least, points, faces, f
        points += 1
        edges, marked = find_horizon(f, w, VISIBLE * size, scratch)
        whole, faces = cone_to(slot, edges, marked, faces, scratch)
        if not whole:
            return DEGENERATE, toward, least, points, faces, f


@kernel
def flat_normal(points: int, seed: Vec3, scratch: Scratch) -> Vec3:
    """A unit vector at right angles to the first ``points`` (1 to 3) points, as near to -seed as can be."""
    wish = scale(seed, -1.0)
    if points == 3:
        edge = sub(row(scratch.w, 1), row(scratch.w, 0))
        n = upright(edge, sub(row(scratch.w, 2), row(scratch.w, 0)))
        n = scale(n, 1.0 / norm(n))
        return scale(n, -1.0) if dot(n, wish) < 0.0 else n
    if points == 2:
        edge = sub(row(scratch.w, 1), row(scratch.w, 0))
        rest = along(wish, -dot(wish, edge) / dot(edge, edge), edge)
        if norm(rest) > SAME_FACE * norm(wish):
            # Twice, because the first may leave as much along the edge as across it.
            rest = along(rest, -dot(rest, edge) / dot(edge, edge), edge)
            return scale(rest, 1.0 / norm(rest))
        return perpendicular(edge)
    if norm(wish) > 0.0:
        return scale(wish, 1.0 / norm(wish))
    return (0.0, 0.0, -1.0)


@kernel
def points_agree(on_a: Vec3, on_b: Vec3, m: Vec3, depth: float, size: float) -> bool:
    """Whether points of A and of B differ by depth m, as far as it counts. If depth < 0 that proves the distance: m says that it
    is no smaller, the points that it is no larger."""
    return norm(along(sub(on_a, on_b), -depth, m)) <= POINTS_APART * size


@kernel
def deepest_points(m: Vec3, depth: float, faces: int, size: float, scratch: Scratch) -> tuple[Vec3, Vec3]:
    """The points of A and of B that make the surface point depth m of A - B.

    A facet with more than three corners is several faces; the one that holds the point is taken. If the
    polytope was left unfinished, no face has this plane, and the nearest face of all is taken.
    """
    target = scale(m, depth)
    nearest, best, share = inf, 0, (1.0, 0.0, 0.0)
    for alike in range(2):
        if nearest < inf:
            break
        for f in range(faces):
            if scratch.alive[f] != 1:
                continue
            close = abs(scratch.height[f] - depth) <= SAME_FACE * size
            if alike == 0 and not (close and dot(row(scratch.normal, f), m) > 1.0 - SAME_FACE):
                continue
            x, y, z = corners(f, scratch)
            p, s = closest_on_triangle(sub(x, target), sub(y, target), sub(z, target))
            if dot(p, p) < nearest:
                nearest, best, share = dot(p, p), f, s
    on_a, on_b = NOWHERE, NOWHERE
    for c in range(3):
        i = number(scratch.corner[best, c])
        on_a = along(on_a, share[c], row(scratch.on_a, i))
        on_b = along(on_b, share[c], row(scratch.on_b, i))
    return on_a, on_b
