"""Depth and distance of polytope cores by complete enumeration, nothing iterative: the oracles for all but ellipsoids.

Minus the depth is the greatest gap along any direction, and the directions that can be greatest are known beforehand: the face
normals of either body, and the common normals of one edge of each. All are tried, each against every corner of both bodies, so
no wrong direction can raise the result. The distance is the least over all pairs of features: edge and edge, corner and face.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS
from avatarsim.spatial.vec3 import Rows, Vec3, along, cross, dot, neg, norm, row, scale, sub

Ints = NDArray[np.int64]

MAY_TOUCH = 1e-7
"""Relative to size: a common normal of two edges counts as supporting if no neighbouring corner is higher by more. Larger
only costs time; smaller: flush and parallel pairs lose their edges to rounding."""


@kernel
def gap_along_rows(rows: Rows, a: int, a_end: int, b: int, b_end: int, n: Vec3) -> float:
    """Return min_A n.x - max_B n.x over rows a .. a_end and b .. b_end."""
    low, high = inf, -inf
    for i in range(a, a_end):
        low = min(low, dot(row(rows, i), n))
    for i in range(b, b_end):
        high = max(high, dot(row(rows, i), n))
    return low - high


@kernel
def face_normal(rows: Rows, start: int, face: Ints, f: int) -> Vec3:
    """Return the outward unit normal of face f."""
    a, b = row(rows, start + face[f, 0]), row(rows, start + face[f, 1])
    n = cross(sub(b, a), sub(row(rows, start + face[f, 2]), a))
    return scale(n, 1.0 / norm(n))


@kernel
def below(rows: Rows, start: int, edge: Ints, e: int, d: Vec3, slack: float) -> bool:
    """Return whether the faces at edge e lie below the plane through it with normal d, which then touches the whole body."""
    end = row(rows, start + edge[e, 0])
    for k in range(2, 4):
        if edge[e, k] >= 0 and dot(d, sub(row(rows, start + edge[e, k]), end)) > slack:
            return False
    return True


@kernel
def greatest_gap(
    rows: Rows, start: Ints, face: Ints, face_start: Ints, edge: Ints, edge_start: Ints, a: int, b: int
) -> float:
    """Return the greatest gap [m] of cores a and b along the normals that a facet of A - B can have; -inf if A - B is flat."""
    row_a, end_a, row_b, end_b = start[a], start[a + 1], start[b], start[b + 1]
    best = -inf
    for f in range(face_start[a], face_start[a + 1]):
        best = max(best, gap_along_rows(rows, row_a, end_a, row_b, end_b, neg(face_normal(rows, row_a, face, f))))
    for f in range(face_start[b], face_start[b + 1]):
        best = max(best, gap_along_rows(rows, row_a, end_a, row_b, end_b, face_normal(rows, row_b, face, f)))
    if face_start[a] == face_start[a + 1] and face_start[b] == face_start[b + 1]:
        return -inf
    for e in range(edge_start[a], edge_start[a + 1]):
        u = sub(row(rows, row_a + edge[e, 1]), row(rows, row_a + edge[e, 0]))
        uu = dot(u, u)
        for g in range(edge_start[b], edge_start[b + 1]):
            v = sub(row(rows, row_b + edge[g, 1]), row(rows, row_b + edge[g, 0]))
            d = cross(u, v)
            vv, length = dot(v, v), norm(d)
            if not (length > 1e-14 * sqrt(uu * vv)):
                continue
            slack = MAY_TOUCH * length * sqrt(max(uu, vv))
            for _ in range(2):
                # d out of b into a: a's faces at its edge are above, b's below
                if below(rows, row_a, edge, e, neg(d), slack) and below(rows, row_b, edge, g, d, slack):
                    # nearly parallel edges: the cross product lost digits, but it must be at right angles to both
                    n = scale(d, 1.0 / length)
                    for _ in range(2):
                        n = along(n, -dot(n, u) / uu, u)
                        n = along(n, -dot(n, v) / vv, v)
                    n = scale(n, 1.0 / norm(n))
                    best = max(best, gap_along_rows(rows, row_a, end_a, row_b, end_b, n))
                d = neg(d)
    return best


@kernel
def point_to_segment(p: Vec3, a: Vec3, u: Vec3) -> float:
    """Return the distance of p from the segment a .. a + u, which may be a point."""
    w, uu = sub(p, a), dot(u, u)
    share = 0.0 if uu == 0.0 else min(1.0, max(0.0, dot(w, u) / uu))
    return norm(along(w, -share, u))


@kernel
def segment_to_segment(a: Vec3, u: Vec3, b: Vec3, v: Vec3) -> float:
    """Return the distance of the segments a .. a + u and b .. b + v: the least over the four ends and the inner points."""
    best = min(point_to_segment(a, b, v), point_to_segment(along(a, 1.0, u), b, v))
    best = min(best, min(point_to_segment(b, a, u), point_to_segment(along(b, 1.0, v), a, u)))
    uu = dot(u, u)
    if uu == 0.0:
        return best
    # The part of v across u is formed by itself: uu vv - uv^2 would lose all digits of nearly parallel segments.
    across = along(v, -dot(u, v) / uu, u)
    across = along(across, -dot(u, across) / uu, u)
    square, w = dot(across, across), sub(a, b)
    if square == 0.0:
        return best
    t = dot(w, across) / square
    if 0.0 < t < 1.0:
        w = along(w, -t, v)
        s = -dot(w, u) / uu
        if 0.0 < s < 1.0:
            best = min(best, norm(along(w, s, u)))
    return best


@kernel
def point_over_face(p: Vec3, a: Vec3, b: Vec3, c: Vec3) -> float:
    """Return the distance of p from the plane of triangle a b c if its foot is inside; else inf, as an edge is nearer."""
    n = cross(sub(b, a), sub(c, a))
    if (
        dot(cross(sub(b, a), sub(p, a)), n) < 0.0
        or dot(cross(sub(c, b), sub(p, b)), n) < 0.0
        or dot(cross(sub(a, c), sub(p, c)), n) < 0.0
    ):
        return inf
    return abs(dot(n, sub(p, a))) / norm(n)


@kernel
def least_distance(
    rows: Rows, start: Ints, face: Ints, face_start: Ints, edge: Ints, edge_start: Ints, a: int, b: int
) -> float:
    """Return the least distance [m] of any features of cores a and b; their distance if they do not overlap."""
    best = inf
    for e in range(edge_start[a], edge_start[a + 1]):
        p = row(rows, start[a] + edge[e, 0])
        u = sub(row(rows, start[a] + edge[e, 1]), p)
        for g in range(edge_start[b], edge_start[b + 1]):
            q = row(rows, start[b] + edge[g, 0])
            best = min(best, segment_to_segment(p, u, q, sub(row(rows, start[b] + edge[g, 1]), q)))
    for turn in range(2):
        flat, other = (a, b) if turn == 0 else (b, a)
        for f in range(face_start[flat], face_start[flat + 1]):
            i, j, k = start[flat] + face[f, 0], start[flat] + face[f, 1], start[flat] + face[f, 2]
            for v in range(start[other], start[other + 1]):
                best = min(best, point_over_face(row(rows, v), row(rows, i), row(rows, j), row(rows, k)))
    return best


@kernel
def outside_polytope(rows: Rows, start: int, face: Ints, face_first: int, face_end: int, p: Vec3) -> bool:
    """Return whether p is beyond any face."""
    for f in range(face_first, face_end):
        a = row(rows, start + face[f, 0])
        n = cross(sub(row(rows, start + face[f, 1]), a), sub(row(rows, start + face[f, 2]), a))
        if not (dot(n, sub(p, a)) <= 0.0):
            return True
    return False


@kernel
def ellipsoid_norm(rows: Rows, start: int, p: Vec3) -> tuple[float, Vec3]:
    """Return |D^-1 R^T (p - c)|, 1 on the surface, and its gradient there."""
    w, square, gradient = sub(p, row(rows, start)), 0.0, (0.0, 0.0, 0.0)
    for k in range(1, 4):
        axis = row(rows, start + k)
        t = dot(w, axis) / dot(axis, axis)
        square += t * t
        gradient = along(gradient, t / dot(axis, axis), axis)
    length = sqrt(square)
    return length, gradient if length == 0.0 else scale(gradient, 1.0 / length)


@kernel
def outside_ellipsoid(rows: Rows, start: int, p: Vec3) -> float:
    """Distance of p from some point of the ellipsoid, 0 inside: at least the true distance, and nearly it when that is small."""
    length, gradient = ellipsoid_norm(rows, start, p)
    if length <= 1.0:
        return 0.0
    square = dot(gradient, gradient)
    # A little more than the linear step, to arrive inside; if none does, the point towards the centre is inside.
    step = 1.001 * (length - 1.0) / square
    for _ in range(8):
        if ellipsoid_norm(rows, start, along(p, -step, gradient))[0] <= 1.0:
            return step * sqrt(square)
        step *= 1.2
    return norm(sub(p, row(rows, start))) * (1.0 - 1.0 / length)


@kernel
def outside(
    rows: Rows, kind: Ints, start: Ints, face: Ints, face_start: Ints, edge: Ints, edge_start: Ints, s: int, p: Vec3
) -> float:
    """Return the distance [m] of p from the core of shape s, 0 inside; for an ellipsoid at least that."""
    first = start[s]
    if kind[s] != POINTS:
        return outside_ellipsoid(rows, first, p)
    if face_start[s] < face_start[s + 1] and not outside_polytope(rows, first, face, face_start[s], face_start[s + 1], p):
        return 0.0
    best = inf
    for e in range(edge_start[s], edge_start[s + 1]):
        end = row(rows, first + edge[e, 0])
        best = min(best, point_to_segment(p, end, sub(row(rows, first + edge[e, 1]), end)))
    for f in range(face_start[s], face_start[s + 1]):
        i, j, k = first + face[f, 0], first + face[f, 1], first + face[f, 2]
        best = min(best, point_over_face(p, row(rows, i), row(rows, j), row(rows, k)))
    return best
