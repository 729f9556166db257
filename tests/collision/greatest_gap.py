"""Depth of two overlapping polytope cores by complete enumeration, nothing iterative: the oracle for all but ellipsoids.

Minus the depth is the greatest gap along any direction, and the directions that can be greatest are known beforehand: the
face normals of either body, and the common normals of one edge of each. All are tried, each against every corner of both
bodies, so no wrong direction can raise the result. Apart, the result is a lower bound of the distance.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, along, cross, dot, neg, norm, row, scale, sub

Ints = NDArray[np.int64]

MAY_TOUCH = 1e-7
"""Relative to size: a common normal of two edges counts as supporting if no neighbouring corner is higher by more. Larger
only costs time; smaller: flush and parallel pairs lose their edges to rounding."""


@kernel
def gap_along_rows(rows: Rows, a: int, a_end: int, b: int, b_end: int, n: Vec3) -> float:
    """min_A n.x - max_B n.x over rows a .. a_end and b .. b_end."""
    low, high = inf, -inf
    for i in range(a, a_end):
        low = min(low, dot(row(rows, i), n))
    for i in range(b, b_end):
        high = max(high, dot(row(rows, i), n))
    return low - high


@kernel
def face_normal(rows: Rows, start: int, face: Ints, f: int) -> Vec3:
    """Outward unit normal of face f."""
    a, b = row(rows, start + face[f, 0]), row(rows, start + face[f, 1])
    n = cross(sub(b, a), sub(row(rows, start + face[f, 2]), a))
    return scale(n, 1.0 / norm(n))


@kernel
def below(rows: Rows, start: int, edge: Ints, e: int, d: Vec3, slack: float) -> bool:
    """Whether the faces at edge e lie below the plane through it with normal d, which then touches the whole body."""
    end = row(rows, start + edge[e, 0])
    for k in range(2, 4):
        if edge[e, k] >= 0 and dot(d, sub(row(rows, start + edge[e, k]), end)) > slack:
            return False
    return True


@kernel
def greatest_gap(
    rows: Rows, start: Ints, face: Ints, face_start: Ints, edge: Ints, edge_start: Ints, a: int, b: int
) -> float:
    """Greatest gap [m] of cores a and b along the normals that a facet of A - B can have; -inf if A - B is flat."""
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
                    # nearly parallel edges: the cross product lost digits, but it must stand on both
                    n = scale(d, 1.0 / length)
                    for _ in range(2):
                        n = along(n, -dot(n, u) / uu, u)
                        n = along(n, -dot(n, v) / vv, v)
                    n = scale(n, 1.0 / norm(n))
                    best = max(best, gap_along_rows(rows, row_a, end_a, row_b, end_b, n))
                d = neg(d)
    return best
