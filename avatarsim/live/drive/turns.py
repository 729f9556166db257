"""Unit quaternions and 3-vectors as plain tuples (Shuster 1993): a tenth of what numpy takes on one of them.

Scalar first; a b is first b, then a. The arrays' functions are `avatarsim.spatial.rotation`.
"""

from math import atan2, cos, hypot, sin, sqrt

from avatarsim.scene.checks import Quaternion, Vector

ZERO: Vector = (0.0, 0.0, 0.0)
UP: Vector = (0.0, 0.0, 1.0)
NO_LENGTH = 1e-12
"""Length below which a vector has no direction: rounding of unit vectors is 1e-16."""


def add(a: Vector, b: Vector) -> Vector:
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def sub(a: Vector, b: Vector) -> Vector:
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scaled(a: Vector, s: float) -> Vector:
    """s a."""
    return s * a[0], s * a[1], s * a[2]


def dot(a: Vector, b: Vector) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def norm(a: Vector) -> float:
    """Length."""
    return hypot(*a)


def shortened(a: Vector, most: float) -> Vector:
    """The vector, or one of length `most` along it where it is longer."""
    length = norm(a)
    return scaled(a, most / length) if length > most else a


def multiply(p: Quaternion, q: Quaternion) -> Quaternion:
    """Hamilton product p q."""
    pw, px, py, pz = p
    qw, qx, qy, qz = q
    return (
        pw * qw - px * qx - py * qy - pz * qz, pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx, pw * qz + px * qy - py * qx + pz * qw,
    )


def conjugate(q: Quaternion) -> Quaternion:
    """Inverse of a unit quaternion."""
    return q[0], -q[1], -q[2], -q[3]


def normalised(q: Quaternion) -> Quaternion:
    """The unit quaternion along q, which is not zero."""
    s = 1.0 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return q[0] * s, q[1] * s, q[2] * s, q[3] * s


def rotate(q: Quaternion, v: Vector) -> Vector:
    """v turned by q."""
    w, x, y, z = q
    a, b, c = v
    tx, ty, tz = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx


def about(axis: Vector, angle: float) -> Quaternion:
    """A turn by `angle` [rad] about a unit axis."""
    s = sin(0.5 * angle)
    return cos(0.5 * angle), s * axis[0], s * axis[1], s * axis[2]


def exp(v: Vector) -> Quaternion:
    """The turn of a rotation vector [rad]."""
    angle = norm(v)
    if angle < NO_LENGTH:
        return normalised((1.0, 0.5 * v[0], 0.5 * v[1], 0.5 * v[2]))
    return about(scaled(v, 1.0 / angle), angle)


def log(q: Quaternion) -> Vector:
    """The rotation vector [rad] of a turn, the short way round."""
    w, x, y, z = q if q[0] >= 0.0 else (-q[0], -q[1], -q[2], -q[3])
    sine = hypot(x, y, z)
    s = 2.0 * atan2(sine, w) / sine if sine > NO_LENGTH else 2.0
    return s * x, s * y, s * z


def way(a: Quaternion, b: Quaternion) -> Vector:
    """Rotation vector [rad], in the axes that both turn into, that takes a to b."""
    return log(multiply(b, conjugate(a)))


def turned_by(v: Vector, q: Quaternion) -> Quaternion:
    """q, and then the turn of a rotation vector [rad]."""
    return normalised(multiply(exp(v), q))
