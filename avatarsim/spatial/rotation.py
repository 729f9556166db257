"""Rotations: quaternions (w, x, y, z), matrices and rotation vectors, in plain numpy.

Off the hot path only; the kernels keep rotation matrices and use `avatarsim.spatial.tangent`.
All functions broadcast over leading axes.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.tolerances import ROUNDING

Array = NDArray[np.float64]

IDENTITY: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


def normalised(quaternion: ArrayLike) -> Array:
    """Unit quaternion along `quaternion`, shape (..., 4). The caller guarantees it is not zero."""
    q = np.asarray(quaternion, dtype=np.float64)
    return np.asarray(q / np.linalg.norm(q, axis=-1, keepdims=True))


def unit(quaternion: ArrayLike) -> Array:
    """Unit quaternion along `quaternion`, shape (..., 4), to the bit as it is where its length is 1 to rounding.

    The caller guarantees it is not zero."""
    q = np.asarray(quaternion, dtype=np.float64)
    lengths = np.linalg.norm(q, axis=-1, keepdims=True)
    return np.where(np.abs(lengths - 1.0) < 1e-12, q, q / lengths)


def multiply(a: ArrayLike, b: ArrayLike) -> Array:
    """Hamilton product a b, shape (..., 4): first b, then a."""
    p, q = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    pw, px, py, pz = p[..., 0], p[..., 1], p[..., 2], p[..., 3]
    qw, qx, qy, qz = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    product = np.empty(np.broadcast_shapes(p.shape, q.shape))
    product[..., 0] = pw * qw - px * qx - py * qy - pz * qz
    product[..., 1] = pw * qx + px * qw + py * qz - pz * qy
    product[..., 2] = pw * qy - px * qz + py * qw + pz * qx
    product[..., 3] = pw * qz + px * qy - py * qx + pz * qw
    return product


def conjugate(quaternion: ArrayLike) -> Array:
    """Inverse of a unit quaternion, shape (..., 4)."""
    return np.asarray(np.asarray(quaternion, dtype=np.float64) * np.array([1.0, -1.0, -1.0, -1.0]))


def rotate(quaternion: ArrayLike, vector: ArrayLike) -> Array:
    """`vector` (..., 3) turned by the unit quaternion (..., 4)."""
    q, v = np.asarray(quaternion, dtype=np.float64), np.asarray(vector, dtype=np.float64)
    u = q[..., 1:]
    t = 2.0 * cross(u, v)
    return np.asarray(v + q[..., :1] * t + cross(u, t))


def cross(a: ArrayLike, b: ArrayLike) -> Array:
    """Cross product (..., 3), a tenth of the cost of numpy's own on few vectors."""
    p, q = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    product = np.empty(np.broadcast_shapes(p.shape, q.shape))
    product[..., 0] = p[..., 1] * q[..., 2] - p[..., 2] * q[..., 1]
    product[..., 1] = p[..., 2] * q[..., 0] - p[..., 0] * q[..., 2]
    product[..., 2] = p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]
    return product


def from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Quaternion of a turn by `angle` [rad] about the unit `axis` (..., 3)."""
    half = 0.5 * np.asarray(angle, dtype=np.float64)[..., None]
    return np.concatenate([np.cos(half), np.sin(half) * np.asarray(axis, dtype=np.float64)], axis=-1)


def from_rotation_vector(vector: ArrayLike) -> Array:
    """Quaternion of a rotation vector (..., 3) [rad]."""
    v = np.asarray(vector, dtype=np.float64)
    angle = np.linalg.norm(v, axis=-1, keepdims=True)
    # sin(a/2)/a by numpy's sinc, finite at zero
    return np.concatenate([np.cos(0.5 * angle), 0.5 * np.sinc(0.5 * angle / np.pi) * v], axis=-1)


def to_rotation_vector(quaternion: ArrayLike) -> Array:
    """Rotation vector (..., 3) [rad], the short way round, length at most pi."""
    q = np.asarray(quaternion, dtype=np.float64)
    q = np.where(q[..., :1] < 0.0, -q, q)
    s = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(s, q[..., :1])
    return np.asarray(np.where(s > 1e-300, angle / np.maximum(s, 1e-300), 2.0) * q[..., 1:])


def to_matrix(quaternion: ArrayLike) -> Array:
    """Rotation matrix (..., 3, 3) of a unit quaternion."""
    q = np.asarray(quaternion, dtype=np.float64)
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    matrix = np.empty((*q.shape[:-1], 3, 3))
    matrix[..., 0, 0], matrix[..., 0, 1], matrix[..., 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
    matrix[..., 1, 0], matrix[..., 1, 1], matrix[..., 1, 2] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
    matrix[..., 2, 0], matrix[..., 2, 1], matrix[..., 2, 2] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)
    return matrix


def from_matrix(matrix: ArrayLike) -> Array:
    """Unit quaternion (..., 4) of a rotation matrix, w >= 0, by the largest of the four candidates."""
    m = np.asarray(matrix, dtype=np.float64)
    d0, d1, d2 = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    a, b, c = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    e, f, g = m[..., 0, 1] + m[..., 1, 0], m[..., 0, 2] + m[..., 2, 0], m[..., 1, 2] + m[..., 2, 1]
    candidates = np.stack(
        [
            np.stack([1 + d0 + d1 + d2, a, b, c], axis=-1),
            np.stack([a, 1 + d0 - d1 - d2, e, f], axis=-1),
            np.stack([b, e, 1 - d0 + d1 - d2, g], axis=-1),
            np.stack([c, f, g, 1 - d0 - d1 + d2], axis=-1),
        ],
        axis=-2,
    )
    best = np.argmax(np.sum(candidates**2, axis=-1), axis=-1)
    q = normalised(np.take_along_axis(candidates, best[..., None, None], axis=-2)[..., 0, :])
    return np.asarray(np.where(q[..., :1] < 0.0, -q, q))


def continuous(quaternions: ArrayLike, like: ArrayLike | None = None) -> Array:
    """Quaternions (F, ..., 4) of the same rotations in a row, none with a negative product with the one before.

    q and -q are one rotation, but numbers between them are not: a reader that interpolates or differentiates components sees a
    jump. The first frame stays. With `like` (F, ..., 4) the sign changes where that of `like` does, and nowhere else."""
    q = np.asarray(quaternions, dtype=np.float64)
    steps = _steps(q) if like is None else _steps(q) * _steps(np.asarray(like, dtype=np.float64))
    return np.asarray(q * np.cumprod(np.concatenate([np.ones((*q[:1].shape[:-1], 1)), steps]), axis=0))


def _steps(q: Array) -> Array:
    """-1 where a quaternion of (F, ..., 4) changes sides from the one before, else 1: (F - 1, ..., 1)."""
    return np.where((q[1:] * q[:-1]).sum(axis=-1, keepdims=True) < 0.0, -1.0, 1.0)


def with_signs_of(quaternions: ArrayLike, recorded: ArrayLike, kept: ArrayLike) -> Array:
    """Quaternions (F, ..., 4), F > 0, that change their signs where those of `recorded` (F, ..., 4) do.

    Frames `kept` (F,) have the sign of `recorded`, and the frames after them continue from there."""
    q, like = continuous(quaternions, recorded), np.asarray(recorded, dtype=np.float64)
    frames, is_kept = np.arange(len(q)), np.asarray(kept, dtype=np.bool_)
    anchor = np.maximum.accumulate(np.where(is_kept, frames, -1))
    anchor[anchor < 0] = int(np.argmax(is_kept))
    return np.asarray(q * np.where((q[anchor] * like[anchor]).sum(axis=-1, keepdims=True) < 0.0, -1.0, 1.0))


def difference(a: ArrayLike, b: ArrayLike) -> Array:
    """Rotation vector (..., 3) [rad], in the axes that both turn into, that takes unit quaternion a to b, the short way round."""
    return to_rotation_vector(multiply(b, conjugate(a)))


def turned(quaternion: ArrayLike, vector: ArrayLike) -> Array:
    """Unit quaternion (..., 4): `quaternion`, and then the turn of a rotation vector (..., 3) [rad]."""
    return normalised(multiply(from_rotation_vector(vector), quaternion))


def slerp(a: ArrayLike, b: ArrayLike, fraction: ArrayLike) -> Array:
    """Spherical interpolation from a (fraction 0) to b (fraction 1), the short way round."""
    start = normalised(a)
    step = to_rotation_vector(multiply(conjugate(start), normalised(b)))
    return multiply(start, from_rotation_vector(np.asarray(fraction, dtype=np.float64)[..., None] * step))


def between(a: ArrayLike, b: ArrayLike) -> Array:
    """The smallest rotation that turns unit vector a into unit vector b; any axis when they are opposite."""
    u, v = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    w = 1.0 + float(np.dot(u, v))
    if w < ROUNDING:
        side = np.cross(u, np.eye(3)[int(np.argmin(np.abs(u)))])
        return np.concatenate([[0.0], side / np.linalg.norm(side)])
    return normalised(np.concatenate([[w], np.cross(u, v)]))
