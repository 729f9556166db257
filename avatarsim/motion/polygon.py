"""Convex polygons in a plane: hull by gift wrapping, clipping of one by another (Sutherland and Hodgman 1974).

Rows are (u, v, height).
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel

Array = NDArray[np.float64]

SLIVER = 1e-5
"""Polygons of less area than this part of their squared perimeter are taken as segments: their plane is noise."""


@kernel
def copy_row(source: Array, i: int, out: Array, k: int) -> None:
    """out[k] = source[i], three numbers."""
    out[k, 0], out[k, 1], out[k, 2] = source[i, 0], source[i, 1], source[i, 2]


@kernel
def left_of(ax: float, ay: float, bx: float, by: float, px: float, py: float) -> float:
    """Twice the area of the triangle a, b, p: positive if p is left of the line from a to b."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel
def wrap(points: Array, count: int, equal: float, out: Array) -> int:
    """Convex hull of the first ``count`` points, counter-clockwise into ``out``; returns its number of corners.

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
    """Whether a polygon is a sliver, or no polygon at all."""
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
    """Keep the two corners that are farthest apart; returns how many are left."""
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
    """(c, p, q) with height = c + p u + q v over a polygon (Newell's normal) or along a segment."""
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
    """Part of a polygon (or segment, given as two corners) with a u + b v <= c; returns its number of corners."""
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
