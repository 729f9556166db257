"""Expanding polytope algorithm (van den Bergen 2003), signed: penetration depth of two convex cores.

The depth is the origin's distance from the surface of A - B. The polytope grows inside A - B; always the face with the smallest
*signed* distance from the origin is pushed out to the support along its normal, until the support lies on the face. Signed, so
that the first tetrahedron need not contain the origin, and an origin that GJK could not place gets its sign here. Every support
is itself an upper bound: moving by it separates.

Polytope of EPA: a closed triangulated surface with adjacency, grown by one point at a time (horizon walk).

Every face has its outward plane and the face beyond each edge, so the faces visible from a new point are found by walking from
one of them; the new faces connect the rim of that patch, the horizon, with the point.

Initial tetrahedron of EPA: four affinely independent points of A - B.
"""

from math import inf

from avatarsim.collision.gjk import NOWHERE, WHOLE, Balls, add_support, closest_on_triangle, upright
from avatarsim.collision.scratch import FACES_CAP, POINTS_CAP, Scratch, number
from avatarsim.collision.status import CONVERGED, DEGENERATE, NOT_FINITE, OUT_OF_ITERATIONS
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Shapes
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
from avatarsim.tolerances import GRAIN, NOTHING, PROOF, ROUNDING, SLIM


@kernel
def corners(f: int, scratch: Scratch) -> tuple[Vec3, Vec3, Vec3]:
    """Return the corners of face f."""
    i, j, k = number(scratch.corner[f, 0]), number(scratch.corner[f, 1]), number(scratch.corner[f, 2])
    return row(scratch.w, i), row(scratch.w, j), row(scratch.w, k)


@kernel
def set_plane(f: int, scratch: Scratch) -> bool:
    """Give the face in slot f the outward plane of its corners; False if they are in line."""
    p, q, r = corners(f, scratch)
    n = upright(sub(q, p), sub(r, p))
    area = norm(n)
    if not (area > 0.0):
        return False
    n = scale(n, 1.0 / area)
    put_row(scratch.normal, f, n)
    scratch.height[f] = dot(n, p)
    scratch.alive[f] = 1
    scratch.settled[f] = 0
    return True


@kernel
def lowest_face(faces: int, scratch: Scratch) -> tuple[int, float]:
    """Return the face with the smallest height among the first slots, and that height: -1 and inf if there is none.

    Four runs, because each comparison waits for the one before it; of equal faces the first.
    """
    height = scratch.height
    f_0, f_1, f_2, f_3 = -1, -1, -1, -1
    h_0, h_1, h_2, h_3 = inf, inf, inf, inf
    fours = faces // 4
    for k in range(fours):
        g = 4 * k
        if height[g] < h_0:
            f_0, h_0 = g, height[g]
        if height[g + 1] < h_1:
            f_1, h_1 = g + 1, height[g + 1]
        if height[g + 2] < h_2:
            f_2, h_2 = g + 2, height[g + 2]
        if height[g + 3] < h_3:
            f_3, h_3 = g + 3, height[g + 3]
    for g in range(4 * fours, faces):
        if height[g] < h_0:
            f_0, h_0 = g, height[g]
    if h_1 < h_0 or (h_1 == h_0 and f_1 < f_0):
        f_0, h_0 = f_1, h_1
    if h_3 < h_2 or (h_3 == h_2 and f_3 < f_2):
        f_2, h_2 = f_3, h_3
    if h_2 < h_0 or (h_2 == h_0 and f_2 < f_0):
        f_0, h_0 = f_2, h_2
    return f_0, h_0


@kernel
def start_polytope(scratch: Scratch) -> bool:
    """Make the four outward faces of the tetrahedron in the first four points; False if one has no area."""
    corner, across = scratch.corner, scratch.across
    # Outward if 3 is below 0 1 2, which `grow_tetrahedron` sees to.
    corner[0, 0], corner[0, 1], corner[0, 2] = 0, 1, 2
    corner[1, 0], corner[1, 1], corner[1, 2] = 0, 3, 1
    corner[2, 0], corner[2, 1], corner[2, 2] = 0, 2, 3
    corner[3, 0], corner[3, 1], corner[3, 2] = 1, 3, 2
    across[0, 0], across[0, 1], across[0, 2] = 1, 3, 2
    across[1, 0], across[1, 1], across[1, 2] = 2, 3, 0
    across[2, 0], across[2, 1], across[2, 2] = 0, 3, 1
    across[3, 0], across[3, 1], across[3, 2] = 1, 2, 0
    whole = True
    for f in range(4):
        whole = set_plane(f, scratch) and whole
    return whole


@kernel
def find_horizon(f: int, point: Vec3, clearance: float, scratch: Scratch) -> tuple[int, int]:
    """Mark and list the faces that ``point`` is above, from f on, and list the edges to those that stay.

    Above means by more than ``clearance`` [m]. Returns (number of edges, number of faces marked).
    """
    stack, across, alive = scratch.stack, scratch.across, scratch.alive
    looked, marked, edges = 0, 1, 0
    stack[0] = f
    alive[f] = 2
    while looked < marked:
        g = number(stack[looked])
        looked += 1
        for e in range(3):
            o = number(across[g, e])
            if alive[o] != 1:
                continue
            if dot(row(scratch.normal, o), point) - scratch.height[o] > clearance:
                alive[o] = 2
                stack[marked] = o
                marked += 1
            else:
                scratch.horizon[edges, 0] = scratch.corner[g, e]
                scratch.horizon[edges, 1] = scratch.corner[g, (e + 1) % 3]
                scratch.horizon[edges, 2] = o
                edges += 1
    return edges, marked


@kernel
def cone_to(apex: int, edges: int, marked: int, faces: int, scratch: Scratch) -> tuple[bool, int]:
    """Replace the marked faces by a cone from the horizon to point ``apex``.

    Returns (whether the surface is whole again, face slots in use). Slots of marked faces are used first. There are two faces
    more than marked ones, less two for every corner that vanishes: so slots never run out before points do.
    """
    horizon, corner, across = scratch.horizon, scratch.corner, scratch.across
    spoke = scratch.spoke
    if faces + edges - marked > FACES_CAP:
        return False, faces
    for q in range(edges, marked):
        gone = number(scratch.stack[q])
        scratch.alive[gone] = 0
        scratch.height[gone] = inf
    new = faces
    for q in range(edges):
        slot = number(scratch.stack[q]) if q < marked else new
        new += 0 if q < marked else 1
        begin, end, outer = number(horizon[q, 0]), horizon[q, 1], number(horizon[q, 2])
        corner[slot, 0], corner[slot, 1], corner[slot, 2] = begin, end, apex
        if not set_plane(slot, scratch):
            return False, faces
        across[slot, 0] = outer
        for e in range(3):
            if corner[outer, e] == end and corner[outer, (e + 1) % 3] == begin:
                across[outer, e] = slot
        spoke[begin] = slot
    faces = new
    # Walk once round the horizon: it must close after exactly as many steps as there are edges.
    first = number(horizon[0, 0])
    at = first
    for q in range(edges):
        f = number(spoke[at])
        after = number(corner[f, 1])
        if corner[f, 0] != at or corner[f, 2] != apex or (after == first) != (q == edges - 1):
            return False, faces
        across[f, 1] = spoke[after]
        across[spoke[after], 2] = f
        at = after
    return True, faces


FLAT = ROUNDING
"""Relative to the shapes' size: if no support leaves the others' plane by more, A - B has no inside."""


@kernel
def off_the_others(points: int, w: Vec3, scratch: Scratch) -> float:
    """Return the distance of w from the point, line or plane through the first 1, 2 or 3 points."""
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
    """Return the k-th direction (of 6) in which to look for a point off the first ``points``."""
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
    """Make four independent points of A - B in the first rows of the scratch, from the ``count`` there.

    Point 3 ends up below the plane 0 1 2 (corners counter-clockwise from above). Returns 4, or fewer if A - B
    is flat: 3 a plane, 2 a line, 1 a point; the points then span it.
    """
    points = 1
    for i in range(1, count):
        # a flat first tetrahedron is legal but gives thin faces; a new support is cheap
        if points < 4 and off_the_others(points, row(scratch.w, i), scratch) > SLIM * size:
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


EXACT = ROUNDING
"""Relative to the shapes' size: support minus face at which a polytope's depth is found. True faces differ by
rounding only."""

SMOOTH = 0.5 * NOTHING
"""EXACT for ellipsoids, whose surface facets only approach; below NOTHING. Tighter: more iterations than the scratch has
points."""

VISIBLE = GRAIN
"""Relative to the shapes' size: a face is removed if the new point is above it by more. Larger: thin slivers
stay as dents; smaller: rounding decides which of several coplanar faces go, and the horizon may tear."""

SAME_FACE = NOTHING
"""Relative height, and one minus cosine: faces this alike are parts of one facet when the witness point is
looked for."""


POINTS_APART = PROOF
"""Relative to the shapes' size: witness points that differ from depth m by more do not prove the depth from below as m does from
above. Larger: rounding passes for an answer; smaller: it is reported as DEGENERATE where it is as good as coordinates allow."""


@kernel
def epa(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, count: int, scratch: Scratch
) -> tuple[int, Vec3, float, int, int]:
    """Return the depth of the cores of shapes a and b, from the first ``count`` points that `gjk` left in the scratch.

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
    """Run `epa` on the cores without the balls, to a tolerance [m]; the face that is lowest comes last."""
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
        plane, each covers a positive solid angle seen from there, so together they cover every direction, and their
        interior holds a ball of the lowest height; by the support no larger one fits.
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
    """Return a unit vector at right angles to the first ``points`` (1 to 3) points, as near to -seed as can be."""
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
    """Return True if points of A and of B differ by depth m, as far as it counts. If depth < 0 that proves the distance: by m it
    is no smaller, by the points no larger."""
    return norm(along(sub(on_a, on_b), -depth, m)) <= POINTS_APART * size


@kernel
def deepest_points(m: Vec3, depth: float, faces: int, size: float, scratch: Scratch) -> tuple[Vec3, Vec3]:
    """Return the points of A and of B that make the surface point depth m of A - B.

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
