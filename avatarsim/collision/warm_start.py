"""Warm-start cache of the signed distance of a pair: last normal, and the simplex of GJK or the polytope of EPA.

Vertices are kept by number, so they move with the shapes: the simplex of a pair that was apart, or the whole polytope around the
origin of a pair that overlapped. The cache is a hint: it is always checked when it is read.
"""

from math import inf, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.epa import corners, set_plane
from avatarsim.collision.gjk import NOWHERE, closest_on_triangle, upright
from avatarsim.collision.scratch import Scratch, number
from avatarsim.jit.kernel import kernel
from avatarsim.jit.record import known_as_table
from avatarsim.model.geometry import Shapes
from avatarsim.spatial.vec3 import Rows, Vec3, along, dot, put_row, row, scale, sub

POINTS_KEPT = 64
"""Most corners of a cached polytope. Two hulls of 52 vertices, concentric, need under 50; a polytope with more is not cached,
and the next query starts cold."""

FACES_KEPT = 2 * POINTS_KEPT - 4
"""Faces of a closed triangulated surface with as many corners."""

EDGES = 4
"""Numbers of edges per face: three are used, and a power of two is divided by in no time."""


PAIR = np.dtype(
    [
        ("axis", np.float64, (3,)),
        ("used", np.int64, (2,)),
        ("rows", np.uint32, (POINTS_KEPT, 2)),
        ("corner", np.uint16, (FACES_KEPT, 3)),
        ("twin", np.uint16, (FACES_KEPT, 3)),
    ],
    align=True,
)
"""One row of PairMemory, about 2 kB; whole words, as arenas require."""


class PairRecord(np.record):  # type: ignore[misc]  # numpy calls it final, and its manual derives from it
    """Cache of one pair; all zero: empty."""

    axis: NDArray[np.float64]
    """(3,) the last normal, out of B into A."""
    used: NDArray[np.int64]
    """(2,) points and faces kept. No faces: the points, 1 to 3, are the simplex of a pair that was apart."""
    rows: NDArray[np.uint32]
    """(POINTS_KEPT, 2) the vertices of A and of B that make a point of A - B, counted from each shape's first."""
    corner: NDArray[np.uint16]
    """(FACES_KEPT, 3) points of a face, counter-clockwise from outside."""
    twin: NDArray[np.uint16]
    """(FACES_KEPT, 3) edge i of face f runs from corner i to i + 1 and is number 4 f + i; here: the number of the same
    edge in the face across, where it runs the other way."""


class PairMemory(np.recarray[Any, np.dtype[Any]]):
    """np records of fixed size, one per pair: `memory[pair]` is a PairRecord, which kernels pass as a pointer."""

    axis: NDArray[np.float64]
    used: NDArray[np.int64]
    rows: NDArray[np.uint32]
    corner: NDArray[np.uint16]
    twin: NDArray[np.uint16]


def make_pair_memory(pairs: int) -> PairMemory:
    """Return empty memory for so many pairs."""
    return np.zeros(pairs, PAIR).view(PairMemory)


known_as_table(PairMemory, PAIR)


@kernel
def recall_axis(memory: PairRecord) -> Vec3:
    """Return the last normal, or zero if the cached one is no unit vector."""
    axis = (memory.axis[0], memory.axis[1], memory.axis[2])
    square = dot(axis, axis)
    return axis if 0.5 < square < 2.0 else (0.0, 0.0, 0.0)


@kernel
def keep_axis(n: Vec3, memory_out: PairRecord) -> None:
    """Keep a normal."""
    memory_out.axis[0], memory_out.axis[1], memory_out.axis[2] = n[0], n[1], n[2]


@kernel
def recall_points(vertices: Rows, shapes: Shapes, a: int, b: int, memory: PairRecord, scratch: Scratch) -> int:
    """Put the cached points, at the present poses, into the scratch; return how many, 0 if one is no number of a vertex."""
    count: int = memory.used[0]
    if not (0 < count <= POINTS_KEPT):
        return 0
    first_a, first_b = shapes.start[a], shapes.start[b]
    many_a, many_b = shapes.start[a + 1] - first_a, shapes.start[b + 1] - first_b
    for k in range(count):
        i, j = number(memory.rows[k, 0]), number(memory.rows[k, 1])
        if not (i < many_a and j < many_b):
            return 0
        on_a, on_b = row(vertices, first_a + i), row(vertices, first_b + j)
        put_row(scratch.w, k, sub(on_a, on_b))
        put_row(scratch.on_a, k, on_a)
        put_row(scratch.on_b, k, on_b)
        scratch.rows[k, 0] = first_a + i
        scratch.rows[k, 1] = first_b + j
    return count


@kernel
def recall_differences(vertices: Rows, shapes: Shapes, a: int, b: int, memory: PairRecord, scratch: Scratch) -> int:
    """Do as `recall_points`, but put only the points of A - B there."""
    count: int = memory.used[0]
    if not (0 < count <= POINTS_KEPT):
        return 0
    first_a, first_b = shapes[a].start, shapes[b].start
    many_a, many_b = shapes[a + 1].start - first_a, shapes[b + 1].start - first_b
    for k in range(count):
        i, j = number(memory.rows[k, 0]), number(memory.rows[k, 1])
        if not (i < many_a and j < many_b):
            return 0
        put_row(scratch.w, k, sub(row(vertices, first_a + i), row(vertices, first_b + j)))
    return count


@kernel
def met(f: int, e: int, faces: int, memory: PairRecord) -> bool:
    """Return True if edge e of face f is met by an edge of another face that runs the other way, and the two name each other."""
    other = number(memory.twin[f, e])
    g, back = other // EDGES, other % EDGES
    if not (g < faces and back < 3):
        return False
    return number(memory.twin[g, back]) == EDGES * f + e and memory.corner[g, back] == memory.corner[f, (e + 1) % 3]


@kernel
def lowest_kept(points: int, memory: PairRecord, scratch: Scratch) -> tuple[float, Vec3]:
    """Return height and normal of the lowest face of the surface over the points in the scratch; 0 if none is around the origin.

    Does the work of `recall_faces` and `lowest_face` without writing anything and with one square root: heights h / |n| of
    normals n that are not made unit vectors are compared by h^2 / n^2.
    """
    faces: int = memory.used[1]
    if not (4 <= faces <= FACES_KEPT):
        return 0.0, NOWHERE
    lowest, square, normal = inf, 1.0, NOWHERE
    for f in range(faces):
        i, j, k = number(memory.corner[f, 0]), number(memory.corner[f, 1]), number(memory.corner[f, 2])
        if not (i < points and j < points and k < points):
            return 0.0, NOWHERE
        if not (met(f, 0, faces, memory) and met(f, 1, faces, memory) and met(f, 2, faces, memory)):
            return 0.0, NOWHERE
        p, q, r = row(scratch.w, i), row(scratch.w, j), row(scratch.w, k)
        n = upright(sub(q, p), sub(r, p))
        height = min(dot(n, p), dot(n, q), dot(n, r))
        if not (height > 0.0):
            return 0.0, NOWHERE
        if height * height * square < lowest * lowest * dot(n, n):
            lowest, square, normal = height, dot(n, n), n
    length = sqrt(square)
    return lowest / length, scale(normal, 1.0 / length)


@kernel
def deepest_kept(
    vertices: Rows, shapes: Shapes, a: int, b: int, m: Vec3, depth: float, near: float, memory: PairRecord, scratch: Scratch
) -> tuple[Vec3, Vec3]:
    """Return `deepest_points` from the surface kept and the points in the scratch.

    ``near`` [m]: corners of the facet of normal m and height ``depth`` are that near to its plane.
    """
    target = scale(m, depth)
    points, faces = memory.used[0], memory.used[1]
    for i in range(points):
        scratch.height[i] = dot(row(scratch.w, i), m)
    nearest, best, share = inf, 0, (1.0, 0.0, 0.0)
    for f in range(faces):
        i, j, k = number(memory.corner[f, 0]), number(memory.corner[f, 1]), number(memory.corner[f, 2])
        if min(scratch.height[i], scratch.height[j], scratch.height[k]) >= depth - near:
            p, s = closest_on_triangle(
                sub(row(scratch.w, i), target), sub(row(scratch.w, j), target), sub(row(scratch.w, k), target)
            )
            if dot(p, p) < nearest:
                nearest, best, share = dot(p, p), f, s
    on_a, on_b = NOWHERE, NOWHERE
    for c in range(3):
        i = number(memory.corner[best, c])
        on_a = along(on_a, share[c], row(vertices, shapes[a].start + number(memory.rows[i, 0])))
        on_b = along(on_b, share[c], row(vertices, shapes[b].start + number(memory.rows[i, 1])))
    return on_a, on_b


@kernel
def recall_faces(points: int, memory: PairRecord, scratch: Scratch) -> int:
    """Put the surface kept over the points in the scratch; return the number of faces.

    0, unless every edge is met by the same edge the other way round and every face has the origin below its plane, as `expand`
    needs for its proof. The height written is that of the lowest corner, so that the distance of a sliver, whose plane rounding
    tilts, is never overstated.
    """
    faces: int = memory.used[1]
    if not (4 <= faces <= FACES_KEPT):
        return 0
    for f in range(faces):
        for e in range(3):
            i = number(memory.corner[f, e])
            if not (i < points and met(f, e, faces, memory)):
                return 0
            scratch.corner[f, e] = i
            scratch.across[f, e] = number(memory.twin[f, e]) // EDGES
        if not set_plane(f, scratch):
            return 0
        n = row(scratch.normal, f)
        _, second, third = corners(f, scratch)
        lowest = min(scratch.height[f], dot(n, second), dot(n, third))
        if not (lowest > 0.0):
            return 0
        scratch.height[f] = lowest
    return faces


@kernel
def remember_points(
    shapes: Shapes, a: int, b: int, n: Vec3, count: int, scratch: Scratch, memory_out: PairRecord
) -> None:
    """Keep a normal and the simplex in the first ``count`` points of the scratch; none: the normal alone."""
    keep_axis(n, memory_out)
    memory_out.used[0] = count
    memory_out.used[1] = 0
    for k in range(count):
        memory_out.rows[k, 0] = scratch.rows[k, 0] - shapes.start[a]
        memory_out.rows[k, 1] = scratch.rows[k, 1] - shapes.start[b]


@kernel
def remember_polytope(
    shapes: Shapes, a: int, b: int, n: Vec3, points: int, faces: int, scratch: Scratch, memory_out: PairRecord
) -> None:
    """Keep a normal and the surface in the scratch: its living faces and their corners, counted anew."""
    keep_axis(n, memory_out)
    memory_out.used[0] = 0
    memory_out.used[1] = 0
    face_number, point_number = scratch.stack, scratch.spoke
    kept_faces, kept_points = 0, 0
    for i in range(points):
        point_number[i] = -1
    for f in range(faces):
        if scratch.alive[f] != 1:
            continue
        if kept_faces == FACES_KEPT:
            return
        face_number[f] = kept_faces
        kept_faces += 1
        for e in range(3):
            i = number(scratch.corner[f, e])
            if point_number[i] < 0:
                if kept_points == POINTS_KEPT:
                    return
                point_number[i] = kept_points
                memory_out.rows[kept_points, 0] = scratch.rows[i, 0] - shapes.start[a]
                memory_out.rows[kept_points, 1] = scratch.rows[i, 1] - shapes.start[b]
                kept_points += 1
    for f in range(faces):
        if scratch.alive[f] != 1:
            continue
        for e in range(3):
            i, g, end = number(scratch.corner[f, e]), number(scratch.across[f, e]), scratch.corner[f, (e + 1) % 3]
            back = 0 if scratch.corner[g, 0] == end else (1 if scratch.corner[g, 1] == end else 2)
            memory_out.corner[face_number[f], e] = point_number[i]
            memory_out.twin[face_number[f], e] = EDGES * number(face_number[g]) + back
    memory_out.used[0] = kept_points
    memory_out.used[1] = kept_faces
