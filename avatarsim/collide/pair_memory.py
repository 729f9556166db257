"""What is kept of a pair of shapes from one frame to the next: which vertices made the last answer.

Vertices are kept by number, so they move with the shapes: the simplex of a pair that was apart, or the whole surface
around the origin of a pair that overlapped. A memory is a hint. It is checked when it is read, whatever is in it.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.polytope import set_plane
from avatarsim.collide.scratch import Scratch
from avatarsim.kernel import kernel
from avatarsim.record import table_of
from avatarsim.spatial.vec3 import Rows, Vec3, dot, put_row, row, sub
from avatarsim.world.shapes import Shapes

POINTS_KEPT = 64
"""Corners of a remembered surface. Two hulls of 52 vertices, concentric, need under 50; a surface with more is forgotten,
and the next query starts cold."""

FACES_KEPT = 2 * POINTS_KEPT - 4
"""Faces of a closed triangulated surface with as many corners."""


PAIR = np.dtype(
    [
        ("axis", np.float64, (3,)),
        ("used", np.int64, (2,)),
        ("rows", np.int32, (POINTS_KEPT, 2)),
        ("corner", np.int16, (FACES_KEPT, 3)),
        ("twin", np.int16, (FACES_KEPT, 3)),
    ],
    align=True,
)
"""One row of PairMemory, about 2 kB; whole words, as an arena wants them."""


class PairRecord(np.record):  # type: ignore[misc]  # numpy calls it final, and its manual derives from it
    """What is kept of one pair. All zero: nothing known."""

    axis: NDArray[np.float64]
    """(3,) the last normal, out of B into A."""
    used: NDArray[np.int64]
    """(2,) points and faces kept. No faces: the points, 1 to 3, are the simplex of a pair that was apart."""
    rows: NDArray[np.int32]
    """(POINTS_KEPT, 2) the vertices of A and of B that make a point of A - B, counted from each shape's first."""
    corner: NDArray[np.int16]
    """(FACES_KEPT, 3) points of a face, counter-clockwise from outside."""
    twin: NDArray[np.int16]
    """(FACES_KEPT, 3) edge i of face f runs from corner i to i + 1 and is number 3 f + i; here: the number of the same
    edge in the face across, where it runs the other way."""


class PairMemory(np.recarray[Any, np.dtype[Any]]):
    """np records of fixed size, one per pair: `memory[pair]` is a PairRecord, which kernels hand on as a pointer."""

    axis: NDArray[np.float64]
    used: NDArray[np.int64]
    rows: NDArray[np.int32]
    corner: NDArray[np.int16]
    twin: NDArray[np.int16]


def make_pair_memory(pairs: int) -> PairMemory:
    """Empty memory for so many pairs."""
    return np.zeros(pairs, PAIR).view(PairMemory)


pair_memory_in = table_of(PairMemory, PAIR)
"""The PairMemory in these words, in a tuple of one."""


@kernel
def recall_axis(memory: PairRecord) -> Vec3:
    """The last normal, or zero if what is kept is no unit vector."""
    axis = (memory.axis[0], memory.axis[1], memory.axis[2])
    square = dot(axis, axis)
    return axis if 0.5 < square < 2.0 else (0.0, 0.0, 0.0)


@kernel
def keep_axis(n: Vec3, memory_out: PairRecord) -> None:
    """Keep a normal."""
    memory_out.axis[0], memory_out.axis[1], memory_out.axis[2] = n[0], n[1], n[2]


@kernel
def recall_points(vertices: Rows, shapes: Shapes, a: int, b: int, memory: PairRecord, scratch: Scratch) -> int:
    """Put the points kept, as the vertices now lie, into the scratch; how many, 0 if a number is none of a vertex."""
    count: int = memory.used[0]
    if not (0 < count <= POINTS_KEPT):
        return 0
    first_a, first_b = shapes.start[a], shapes.start[b]
    many_a, many_b = shapes.start[a + 1] - first_a, shapes.start[b + 1] - first_b
    for k in range(count):
        i, j = memory.rows[k, 0], memory.rows[k, 1]
        if not (0 <= i < many_a and 0 <= j < many_b):
            return 0
        on_a, on_b = row(vertices, first_a + i), row(vertices, first_b + j)
        put_row(scratch.w, k, sub(on_a, on_b))
        put_row(scratch.on_a, k, on_a)
        put_row(scratch.on_b, k, on_b)
        scratch.rows[k, 0] = first_a + i
        scratch.rows[k, 1] = first_b + j
    return count


@kernel
def recall_faces(points: int, memory: PairRecord, scratch: Scratch) -> int:
    """Put the surface kept over the points in the scratch; how many faces.

    0, unless every edge is met by the same edge the other way round and every face has the origin below its plane: what
    `expand` needs for its proof. The height written is that of the lowest corner, so that the distance of a sliver,
    whose plane rounding tilts, is never overstated.
    """
    faces: int = memory.used[1]
    if not (4 <= faces <= FACES_KEPT):
        return 0
    corner, twin = memory.corner, memory.twin
    for f in range(faces):
        for e in range(3):
            i, end, other = corner[f, e], corner[f, (e + 1) % 3], twin[f, e]
            if not (0 <= i < points and 0 <= other < 3 * faces):
                return 0
            g = other // 3
            back = other - 3 * g
            if twin[g, back] != 3 * f + e or corner[g, back] != end:
                return 0
            scratch.corner[f, e] = i
            scratch.across[f, e] = g
        if not set_plane(f, scratch):
            return 0
        n = row(scratch.normal, f)
        second, third = row(scratch.w, scratch.corner[f, 1]), row(scratch.w, scratch.corner[f, 2])
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
            i = scratch.corner[f, e]
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
            g, end = scratch.across[f, e], scratch.corner[f, (e + 1) % 3]
            back = 0 if scratch.corner[g, 0] == end else (1 if scratch.corner[g, 1] == end else 2)
            memory_out.corner[face_number[f], e] = point_number[scratch.corner[f, e]]
            memory_out.twin[face_number[f], e] = 3 * face_number[g] + back
    memory_out.used[0] = kept_points
    memory_out.used[1] = kept_faces
