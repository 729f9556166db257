"""Polytope of EPA: a closed triangulated surface with adjacency, grown by one point at a time (horizon walk).

Every face has its outward plane and the face beyond each edge, so the faces visible from a new point are found by walking from
one of them; the new faces connect the rim of that patch, the horizon, with the point.
"""

from math import inf

from avatarsim.collide.scratch import FACES_CAP, Scratch, number
from avatarsim.collide.simplex import upright
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, dot, norm, put_row, row, scale, sub


@kernel
def corners(f: int, scratch: Scratch) -> tuple[Vec3, Vec3, Vec3]:
    """The corners of face f."""
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
    """The face with the smallest height among the first slots, and that height: -1 and inf if there is none.

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
