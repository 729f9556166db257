"""A closed surface of triangles in the scratch, to which one point at a time is added.

Every face knows its outward plane and the face beyond each edge, so the faces that a new point can see are
found by walking from one of them, and the rim of that patch, the horizon, is where the new faces begin.
"""

from avatarsim.collide.scratch import FACES_CAP, Scratch
from avatarsim.collide.simplex import upright
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, dot, norm, put_row, row, scale, sub


@kernel
def set_plane(f: int, scratch: Scratch) -> bool:
    """Give the face in slot f the outward plane of its corners; False if they are in line."""
    p = row(scratch.w, scratch.corner[f, 0])
    n = upright(sub(row(scratch.w, scratch.corner[f, 1]), p), sub(row(scratch.w, scratch.corner[f, 2]), p))
    area = norm(n)
    if not (area > 0.0):
        return False
    n = scale(n, 1.0 / area)
    put_row(scratch.normal, f, n)
    scratch.height[f] = dot(n, p)
    scratch.alive[f] = 1
    return True


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
def find_horizon(f: int, point: Vec3, clearance: float, scratch: Scratch) -> int:
    """Mark the faces that ``point`` is above, from f on, and list the edges to those that stay.

    Above means by more than ``clearance`` [m]. Returns the number of edges.
    """
    stack, across, alive = scratch.stack, scratch.across, scratch.alive
    waiting, edges = 1, 0
    stack[0] = f
    alive[f] = 2
    while waiting > 0:
        waiting -= 1
        g = stack[waiting]
        for e in range(3):
            o = across[g, e]
            if alive[o] != 1:
                continue
            if dot(row(scratch.normal, o), point) - scratch.height[o] > clearance:
                alive[o] = 2
                stack[waiting] = o
                waiting += 1
            else:
                scratch.horizon[edges, 0] = scratch.corner[g, e]
                scratch.horizon[edges, 1] = scratch.corner[g, (e + 1) % 3]
                scratch.horizon[edges, 2] = o
                edges += 1
    return edges


@kernel
def cone_to(apex: int, edges: int, faces: int, scratch: Scratch) -> tuple[bool, int]:
    """Replace the marked faces by a cone from the horizon to point ``apex``.

    Returns (whether the surface is whole again, face slots in use).
    """
    horizon, corner, across = scratch.horizon, scratch.corner, scratch.across
    alive, spoke = scratch.alive, scratch.spoke
    for f in range(faces):
        if alive[f] == 2:
            alive[f] = 0
    slot = 0
    for q in range(edges):
        while slot < faces and alive[slot] != 0:
            slot += 1
        if slot >= FACES_CAP:
            return False, faces
        faces = max(faces, slot + 1)
        corner[slot, 0], corner[slot, 1], corner[slot, 2] = horizon[q, 0], horizon[q, 1], apex
        if not set_plane(slot, scratch):
            return False, faces
        outer = horizon[q, 2]
        across[slot, 0] = outer
        for e in range(3):
            if corner[outer, e] == horizon[q, 1] and corner[outer, (e + 1) % 3] == horizon[q, 0]:
                across[outer, e] = slot
        spoke[horizon[q, 0]] = slot
    # Walk once round the horizon: it must close after exactly as many steps as there are edges.
    first = horizon[0, 0]
    at = first
    for q in range(edges):
        f = spoke[at]
        after = corner[f, 1]
        if corner[f, 0] != at or corner[f, 2] != apex or (after == first) != (q == edges - 1):
            return False, faces
        across[f, 1] = spoke[after]
        across[spoke[after], 2] = f
        at = after
    return True, faces
