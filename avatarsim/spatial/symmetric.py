"""Symmetric 3 x 3 matrices inside kernels: three column tuples."""

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, cross, dot


@kernel
def solved(a: Vec3, b: Vec3, c: Vec3, v: Vec3) -> Vec3:
    """x with the symmetric matrix of columns a, b, c times x = v, by Cramer's rule."""
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    whole = dot(a, bc)
    return (dot(v, bc) / whole, dot(v, ca) / whole, dot(v, ab) / whole)
