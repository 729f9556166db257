"""The depth of two shapes with a proof that no direction of all gives less: the oracle for ellipsoids, and a second for all.

h(n) = max over A - B of n.x is the depth along the unit vector n, so the depth is the least h over the sphere. Any point p
of A - B proves h(n) >= n.p, and over a small spherical triangle n.p is least at a corner. So the sphere is cut into
triangles, each into four, until p.corner >= least h seen - tolerance for a support point p of each triangle. Interval
arithmetic in spirit; nothing is assumed about smoothness or about how many minima there are. Directions are those of a
sphere in coordinates in which A - B is about round: a plate's normals, which crowd at its rim, then spread out evenly.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, cross, dot, neg, norm, perpendicular, row, scale, sub

Ints = NDArray[np.int64]

DEEPEST_CUT = 40
"""Halvings of a right angle: triangles of 1e-12 rad, beyond which rounding decides."""
STACK_ROWS = 4 * DEEPEST_CUT + 8
"""Triangles waiting at once: three more per cut, and the eight first ones."""


def rounder(rows: Rows, kind: Ints, start: Ints, a: int, b: int) -> Rows:
    """Matrix (3, 3) that takes directions of a sphere to those in which A - B needs cutting: the root of its inverse moments."""
    moments = np.zeros((3, 3))
    for s in (a, b):
        own = rows[start[s] : start[s + 1]]
        own = own[1:] if kind[s] != POINTS else (own - own.mean(axis=0)) * np.sqrt(3.0 / len(own))
        moments += own.T @ own
    squares, axes = np.linalg.eigh(moments)
    squares = np.maximum(squares / squares.max(), 1e-12)
    return np.ascontiguousarray((axes / np.sqrt(squares)) @ axes.T)


def make_stack() -> Rows:
    """Return memory for the triangles still to be looked at."""
    return np.zeros((STACK_ROWS, 10))


@kernel
def farthest(rows: Rows, kind: int, start: int, end: int, d: Vec3) -> Vec3:
    """Return the point of a core farthest along d."""
    if kind == POINTS:
        best, found = -inf, start
        for i in range(start, end):
            t = dot(row(rows, i), d)
            if t > best:
                best, found = t, i
        return row(rows, found)
    p, total = row(rows, start), 0.0
    for k in range(1, 4):
        t = dot(row(rows, start + k), d)
        total += t * t
    for k in range(1, 4):
        p = along(p, dot(row(rows, start + k), d) / sqrt(total), row(rows, start + k))
    return p


@kernel
def farthest_of_difference(rows: Rows, kind: Ints, start: Ints, a: int, b: int, d: Vec3) -> Vec3:
    """Return the point of A - B farthest along d."""
    p = farthest(rows, kind[a], start[a], start[a + 1], d)
    return sub(p, farthest(rows, kind[b], start[b], start[b + 1], neg(d)))


@kernel
def push(stack: Rows, at: int, x: Vec3, y: Vec3, z: Vec3, cuts: float) -> int:
    """Write a triangle; returns the next free place."""
    for k in range(3):
        stack[at, k], stack[at, 3 + k], stack[at, 6 + k] = x[k], y[k], z[k]
    stack[at, 9] = cuts
    return at + 1


@kernel
def direction(spread: Rows, m: Vec3) -> Vec3:
    """Return the unit vector along spread m."""
    d = (dot(row(spread, 0), m), dot(row(spread, 1), m), dot(row(spread, 2), m))
    return scale(d, 1.0 / norm(d))


@kernel
def middle(x: Vec3, y: Vec3) -> Vec3:
    """Return the unit vector half-way."""
    m = add(x, y)
    return scale(m, 1.0 / norm(m))


@kernel
def depth_along(rows: Rows, kind: Ints, start: Ints, a: int, b: int, spread: Rows, m: Vec3) -> float:
    """Return h of the direction at the parameter m."""
    d = direction(spread, m)
    return dot(farthest_of_difference(rows, kind, start, a, b, d), d)


@kernel
def descend(rows: Rows, kind: Ints, start: Ints, a: int, b: int, spread: Rows, m: Vec3) -> float:
    """Return a small depth near the direction at m, by trying steps both ways along two tangents, halved where none helps."""
    m = scale(m, 1.0 / norm(m))
    least, step = depth_along(rows, kind, start, a, b, spread, m), 0.1
    while step > 1e-9:
        x = perpendicular(m)
        y = cross(m, x)
        better = False
        for k in range(8):
            # The diagonals, too: along a kink of h neither tangent alone may lead down.
            sx = (1.0, -1.0, 0.0, 0.0, 1.0, 1.0, -1.0, -1.0)[k]
            sy = (0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0)[k]
            t = along(along(m, sx * step, x), sy * step, y)
            h = depth_along(rows, kind, start, a, b, spread, t)
            if h < least:
                least, m, better = h, scale(t, 1.0 / norm(t)), True
                break
        if not better:
            step *= 0.5
    return least


@kernel
def least_on_grid(rows: Rows, kind: Ints, start: Ints, a: int, b: int, spread: Rows, steps: int) -> Vec3:
    """Return the parameter of the direction of least depth on a grid of 6 steps^2 directions."""
    least, best = inf, (1.0, 0.0, 0.0)
    for side in range(6):
        for i in range(steps):
            for j in range(steps):
                u, v = (2.0 * i + 1.0) / steps - 1.0, (2.0 * j + 1.0) / steps - 1.0
                far = 1.0 if side < 3 else -1.0
                m = (far, u, v)
                if side % 3 == 1:
                    m = (v, far, u)
                elif side % 3 == 2:
                    m = (u, v, far)
                h = depth_along(rows, kind, start, a, b, spread, m)
                if h < least:
                    least, best = h, m
    return best


@kernel
def best_of_mixture(p: Vec3, q: Vec3, x: Vec3, y: Vec3, z: Vec3) -> float:
    """Return the greatest over t in 0 .. 1 of the least of (p + t (q - p)).corner over three corners."""
    at_p = (dot(p, x), dot(p, y), dot(p, z))
    at_q = (dot(q, x), dot(q, y), dot(q, z))
    best = max(min(min(at_p[0], at_p[1]), at_p[2]), min(min(at_q[0], at_q[1]), at_q[2]))
    for i in range(3):
        j = (i + 1) % 3
        # where the lines of corners i and j cross
        change = (at_q[i] - at_q[j]) - (at_p[i] - at_p[j])
        if change != 0.0:
            t = -(at_p[i] - at_p[j]) / change
            if 0.0 < t < 1.0:
                low = inf
                for k in range(3):
                    low = min(low, at_p[k] + t * (at_q[k] - at_p[k]))
                best = max(best, low)
    return best


@kernel
def least_depth(
    rows: Rows,
    kind: Ints,
    start: Ints,
    a: int,
    b: int,
    claim: float,
    tolerance: float,
    spread: Rows,
    most: int,
    stack: Rows,
) -> tuple[bool, float, int]:
    """Return the depth [m] of the overlapping cores a and b, radii left out.

    claim: the depth along some direction, to start from: far above the least it takes long; spread: from `rounder`, or any
    invertible matrix; most: triangles to look at before giving up. Returns (whether proved, least, triangles looked at): the
    depth is in least - tolerance .. least if proved, else at most least.
    """
    waiting, least, seen = 0, claim, 0
    for octant in range(8):
        x = (1.0 if octant & 1 else -1.0, 0.0, 0.0)
        y = (0.0, 1.0 if octant & 2 else -1.0, 0.0)
        z = (0.0, 0.0, 1.0 if octant & 4 else -1.0)
        waiting = push(stack, waiting, x, y, z, 0.0)
    while waiting > 0:
        waiting -= 1
        x = (stack[waiting, 0], stack[waiting, 1], stack[waiting, 2])
        y = (stack[waiting, 3], stack[waiting, 4], stack[waiting, 5])
        z = (stack[waiting, 6], stack[waiting, 7], stack[waiting, 8])
        cuts = stack[waiting, 9]
        seen += 1
        c = direction(spread, add(add(x, y), z))
        p = farthest_of_difference(rows, kind, start, a, b, c)
        least = min(least, dot(p, c))
        u, v, w = direction(spread, x), direction(spread, y), direction(spread, z)
        low = min(min(dot(p, u), dot(p, v)), dot(p, w))
        if low < least - tolerance:
            # Across an edge of the direction's fan two points take turns: a point between them is better than either.
            corners = (u, v, w)
            for k in range(3):
                q = farthest_of_difference(rows, kind, start, a, b, corners[k])
                low = max(low, best_of_mixture(p, q, u, v, w))
                after = farthest_of_difference(rows, kind, start, a, b, corners[(k + 1) % 3])
                low = max(low, best_of_mixture(q, after, u, v, w))
        if low < 0.0:
            # n is a mean of the corners, made a unit vector: divide by how short the mean can be
            plane = cross(sub(v, u), sub(w, u))
            low *= norm(plane) / abs(dot(plane, u))
        if low >= least - tolerance:
            continue
        if seen >= most or cuts >= DEEPEST_CUT:
            return False, least, seen
        xy, yz, zx = middle(x, y), middle(y, z), middle(z, x)
        waiting = push(stack, waiting, x, xy, zx, cuts + 1.0)
        waiting = push(stack, waiting, xy, y, yz, cuts + 1.0)
        waiting = push(stack, waiting, zx, yz, z, cuts + 1.0)
        waiting = push(stack, waiting, xy, yz, zx, cuts + 1.0)
    return True, least, seen


def proved_depth(
    rows: Rows, kind: Ints, start: Ints, a: int, b: int, claim: float, tolerance: float, most: int, stack: Rows
) -> tuple[bool, float]:
    """Depth [m] of the overlapping cores a and b, and whether it is proved; `claim` as in `least_depth`, inf if there is none.

    If the claim leads nowhere, the search starts again from the best of a grid, refined.
    """
    spread = rounder(rows, kind, start, a, b)
    certain, least = False, claim
    if claim < np.inf:
        certain, least, _ = least_depth(rows, kind, start, a, b, claim, tolerance, spread, most, stack)
    if not certain:
        coarse = least_on_grid(rows, kind, start, a, b, spread, 24)
        least = min(least, descend(rows, kind, start, a, b, spread, coarse))
        certain, least, _ = least_depth(rows, kind, start, a, b, least, tolerance, spread, most, stack)
    return certain, least
