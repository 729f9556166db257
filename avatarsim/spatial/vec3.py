"""Three-vectors inside kernels: plain tuples of floats, which the compiler keeps in registers.

Symmetric 3 x 3 matrices inside kernels: three column tuples.
"""

from math import sqrt
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel

Vec3: TypeAlias = tuple[float, float, float]
Rows: TypeAlias = NDArray[np.float64]
"""A float64 array of shape (n, 3), C-contiguous."""


@kernel
def add(a: Vec3, b: Vec3) -> Vec3:
    """a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@kernel
def sub(a: Vec3, b: Vec3) -> Vec3:
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def neg(a: Vec3) -> Vec3:
    """-a."""
    return (-a[0], -a[1], -a[2])


@kernel
def scale(a: Vec3, s: float) -> Vec3:
    """s a."""
    return (a[0] * s, a[1] * s, a[2] * s)


@kernel
def along(a: Vec3, s: float, d: Vec3) -> Vec3:
    """a + s d."""
    return (a[0] + s * d[0], a[1] + s * d[1], a[2] + s * d[2])


@kernel
def dot(a: Vec3, b: Vec3) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a: Vec3, b: Vec3) -> Vec3:
    """Vector product, right-handed."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@kernel
def norm(a: Vec3) -> float:
    """Euclidean length. Squares underflow below 1e-154, overflow above 1e154; no length in metres is near."""
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@kernel
def unit(a: Vec3) -> Vec3:
    """a / |a|; not finite for a = 0, which the caller has ruled out or tests for."""
    s = 1.0 / sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    return (a[0] * s, a[1] * s, a[2] * s)


@kernel
def perpendicular(a: Vec3) -> Vec3:
    """A unit vector at right angles to ``a``, always the same one; (0, 0, 1) for a = 0.

    Crosses ``a`` with the coordinate axis it is least aligned with, so the cross product never vanishes for a
    != 0.
    """
    if dot(a, a) == 0.0:
        return (0.0, 0.0, 1.0)
    x, y, z = abs(a[0]), abs(a[1]), abs(a[2])
    if x <= y and x <= z:
        return unit((0.0, -a[2], a[1]))
    if y <= z:
        return unit((a[2], 0.0, -a[0]))
    return unit((-a[1], a[0], 0.0))


@kernel
def row(m: NDArray[Any], i: int) -> Vec3:
    """Row i of an (n, 3) array."""
    return (m[i, 0], m[i, 1], m[i, 2])


@kernel
def put_row(m_out: NDArray[Any], i: int, a: Vec3) -> None:
    """Write ``a`` into row i of an (n, 3) array."""
    m_out[i, 0] = a[0]
    m_out[i, 1] = a[1]
    m_out[i, 2] = a[2]


@kernel
def solved(a: Vec3, b: Vec3, c: Vec3, v: Vec3) -> Vec3:
    """x with the symmetric matrix of columns a, b, c times x = v, by Cramer's rule."""
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    whole = dot(a, bc)
    return (dot(v, bc) / whole, dot(v, ca) / whole, dot(v, ab) / whole)


@kernel
def limited(v: Vec3, most: float) -> Vec3:
    """v, shortened to at most `most`."""
    length = norm(v)
    return v if length <= most else scale(v, most / length)
