"""Interpolation of tracker samples and forward kinematics for all steps of a frame at once, compiled.

The plain twin of the kinematics is `avatarsim.scene.tracker.link_poses`; the two are compared in the tests.
Quaternions are (w, x, y, z).
"""

import math

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

RIGID, MOVED, TURNED, FREE, SLID = 0, 1, 2, 3, 4
"""Kinds of joints: none, hinges, ball, free root, slide."""

BEYOND = 1e-3
"""Excess [rad] from which a motor holds: at 0, a motor with its target at the limit would hold at every step."""


@kernel
def _multiply(pw: float, px: float, py: float, pz: float, qw: float, qx: float, qy: float,
              qz: float) -> tuple[float, float, float, float]:
    """Return the Hamilton product p q."""
    return (
        pw * qw - px * qx - py * qy - pz * qz,
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
    )


@kernel
def _scaled_turn(w: float, x: float, y: float, z: float, fraction: float) -> tuple[float, float, float, float]:
    """Return the rotation (w, x, y, z), taken the short way round, times `fraction`."""
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    s = math.sqrt(x * x + y * y + z * z)
    half = fraction * math.atan2(s, w)
    k = math.sin(half) / s if s > 1e-150 else fraction
    return math.cos(half), k * x, k * y, k * z


@kernel
def _twist(along: float, w: float) -> float:
    """Return the angle [rad] within half a turn of the rotation about an axis that has `along` of it and real part `w`."""
    twist = 2.0 * math.atan2(along, w)
    if twist > math.pi:
        return twist - 2.0 * math.pi
    return twist + 2.0 * math.pi if twist < -math.pi else twist


@kernel
def _rotate(w: float, x: float, y: float, z: float, a: float, b: float, c: float) -> tuple[float, float, float]:
    """Return the vector (a, b, c) turned by a unit quaternion."""
    _, tx, ty, tz = _multiply(w, x, y, z, 0.0, a, b, c)
    tw = -(x * a + y * b + z * c)
    _, tx, ty, tz = _multiply(tw, tx, ty, tz, w, -x, -y, -z)
    return tx, ty, tz


@kernel
def interpolate(roots0: Array, turns0: Array, angles0: Array, roots1: Array, turns1: Array, angles1: Array,
                fractions: Array, roots: Array, turns: Array, angles: Array) -> int:
    """Write the postures at `fractions` (n,) between two samples into roots, turns, angles; 0 on return."""
    for i in range(len(fractions)):
        f = fractions[i]
        for h in range(angles.shape[1]):
            angles[i, h] = angles0[h] + f * (angles1[h] - angles0[h])
        for k in range(roots.shape[1]):
            for c in range(3):
                roots[i, k, c] = roots0[k, c] + f * (roots1[k, c] - roots0[k, c])
            aw, ax, ay, az = turns0[k, 0], turns0[k, 1], turns0[k, 2], turns0[k, 3]
            w, x, y, z = _multiply(aw, -ax, -ay, -az, turns1[k, 0], turns1[k, 1], turns1[k, 2], turns1[k, 3])
            w, x, y, z = _scaled_turn(w, x, y, z, f)
            turns[i, k, 0], turns[i, k, 1], turns[i, k, 2], turns[i, k, 3] = _multiply(aw, ax, ay, az, w, x, y, z)
    return 0


@kernel
def chain_poses(parent: Integers, kind: Integers, anchor: Array, rest: Array, first: Integers, axes: Array,
                roots: Array, turns: Array, angles: Array, positions: Array, orientations: Array) -> int:
    """Write the link poses of every posture into positions and orientations; 0 on return."""
    for i in range(len(roots)):
        for k in range(len(parent)):
            if kind[k] == FREE:
                px, py, pz = roots[i, k, 0], roots[i, k, 1], roots[i, k, 2]
                w, x, y, z = turns[i, k, 0], turns[i, k, 1], turns[i, k, 2], turns[i, k, 3]
            else:
                ox, oy, oz = 0.0, 0.0, 0.0
                w, x, y, z = 1.0, 0.0, 0.0, 0.0
                if parent[k] >= 0:
                    p = parent[k]
                    ox, oy, oz = positions[i, p, 0], positions[i, p, 1], positions[i, p, 2]
                    w, x, y, z = orientations[i, p, 0], orientations[i, p, 1], orientations[i, p, 2], orientations[i, p, 3]
                ax, ay, az = _rotate(w, x, y, z, anchor[k, 0], anchor[k, 1], anchor[k, 2])
                px, py, pz = ox + ax, oy + ay, oz + az
                w, x, y, z = _multiply(w, x, y, z, rest[k, 0], rest[k, 1], rest[k, 2], rest[k, 3])
                if kind[k] == SLID:
                    way = angles[i, first[k]]
                    ax, ay, az = _rotate(w, x, y, z, axes[first[k], 0], axes[first[k], 1], axes[first[k], 2])
                    px, py, pz = px + way * ax, py + way * ay, pz + way * az
                for h in range(first[k], first[k + 1] if kind[k] == MOVED else first[k]):
                    c, s = math.cos(0.5 * angles[i, h]), math.sin(0.5 * angles[i, h])
                    w, x, y, z = _multiply(w, x, y, z, c, s * axes[h, 0], s * axes[h, 1], s * axes[h, 2])
                if kind[k] == TURNED:
                    w, x, y, z = _multiply(w, x, y, z, turns[i, k, 0], turns[i, k, 1], turns[i, k, 2], turns[i, k, 3])
            length = math.sqrt(w * w + x * x + y * y + z * z)
            positions[i, k, 0], positions[i, k, 1], positions[i, k, 2] = px, py, pz
            orientations[i, k, 0], orientations[i, k, 1] = w / length, x / length
            orientations[i, k, 2], orientations[i, k, 3] = y / length, z / length
    return 0


@kernel
def extrapolate(positions: Array, orientations: Array, steps: float, ahead: Array, turned: Array) -> int:
    """Write poses `steps` ahead of each but the first, at the velocity of the step that led there; 0 on
    return.

    Linear in positions, a constant turn in orientations.
    """
    for i in range(1, len(positions)):
        for k in range(positions.shape[1]):
            for c in range(3):
                ahead[i - 1, k, c] = positions[i, k, c] + steps * (positions[i, k, c] - positions[i - 1, k, c])
            aw, ax, ay, az = orientations[i, k, 0], orientations[i, k, 1], orientations[i, k, 2], orientations[i, k, 3]
            w, x, y, z = _multiply(aw, ax, ay, az, orientations[i - 1, k, 0], -orientations[i - 1, k, 1],
                                   -orientations[i - 1, k, 2], -orientations[i - 1, k, 3])
            w, x, y, z = _scaled_turn(w, x, y, z, steps)
            turned[i - 1, k, 0], turned[i - 1, k, 1], turned[i - 1, k, 2], turned[i - 1, k, 3] = _multiply(
                w, x, y, z, aw, ax, ay, az)
    return 0


@kernel
def turned_on(turns: Array, links: Integers, share: float, left: Array, right: Array, aimed: Array) -> int:
    """Write left a (a^-1 b)^share right for each turn b of `links` but the first, a the one before it, into aimed (n - 1, links,
    4); 0 on return.

    The turn goes on as it was beyond a share of 1; left and right (links, 4) turn it into the followers' frames."""
    for i in range(1, len(turns)):
        for j in range(len(links)):
            k = links[j]
            aw, ax, ay, az = turns[i - 1, k, 0], turns[i - 1, k, 1], turns[i - 1, k, 2], turns[i - 1, k, 3]
            w, x, y, z = _multiply(aw, -ax, -ay, -az, turns[i, k, 0], turns[i, k, 1], turns[i, k, 2], turns[i, k, 3])
            w, x, y, z = _scaled_turn(w, x, y, z, share)
            w, x, y, z = _multiply(aw, ax, ay, az, w, x, y, z)
            w, x, y, z = _multiply(left[j, 0], left[j, 1], left[j, 2], left[j, 3], w, x, y, z)
            aimed[i - 1, j, 0], aimed[i - 1, j, 1], aimed[i - 1, j, 2], aimed[i - 1, j, 3] = _multiply(
                w, x, y, z, right[j, 0], right[j, 1], right[j, 2], right[j, 3])
    return 0


@kernel
def clamp_balls(balls: Integers, rest: Array, axis: Array, between: Array, stops: Array, turns: Array) -> int:
    """Bring the rotations `turns` (links, 4) of the links `balls` within `stops` (swing, lower and upper
    twist); 0 on return.

    With R = rest turn and S = between^-1 R: S = W T, T the twist about the limb's axis, W the swing; both are
    clipped.
    """
    for b in range(len(balls)):
        k = balls[b]
        w, x, y, z = _multiply(rest[k, 0], rest[k, 1], rest[k, 2], rest[k, 3],
                               turns[k, 0], turns[k, 1], turns[k, 2], turns[k, 3])
        w, x, y, z = _multiply(between[b, 0], -between[b, 1], -between[b, 2], -between[b, 3], w, x, y, z)
        along = x * axis[b, 0] + y * axis[b, 1] + z * axis[b, 2]
        twist = _twist(along, w)
        c, s = math.cos(0.5 * twist), -math.sin(0.5 * twist)
        w, x, y, z = _multiply(w, x, y, z, c, s * axis[b, 0], s * axis[b, 1], s * axis[b, 2])
        swing = 2.0 * math.atan2(math.sqrt(x * x + y * y + z * z), abs(w))
        clipped = min(max(twist, stops[b, 1]), stops[b, 2])
        if swing > stops[b, 0] or clipped != twist:
            w, x, y, z = _scaled_turn(w, x, y, z, min(1.0, stops[b, 0] / max(swing, 1e-150)))
            c, s = math.cos(0.5 * clipped), math.sin(0.5 * clipped)
            w, x, y, z = _multiply(w, x, y, z, c, s * axis[b, 0], s * axis[b, 1], s * axis[b, 2])
            w, x, y, z = _multiply(between[b, 0], between[b, 1], between[b, 2], between[b, 3], w, x, y, z)
            turns[k, 0], turns[k, 1], turns[k, 2], turns[k, 3] = _multiply(
                rest[k, 0], -rest[k, 1], -rest[k, 2], -rest[k, 3], w, x, y, z)
    return 0


@kernel
def beyond_stops(states: Array, left: Array, right: Array, axis: Array, stops: Array, beyond: NDArray[np.bool_]) -> int:
    """Write which of `states` (n, 4), joint turns (x, y, z, w) as Bullet has them, are beyond `stops` (n, 3) [rad]: swing, lower
    and upper twist; 0 on return. left turn right, (n, 4) each, is the turn away from the cone's centre, of a limb along `axis`
    (n, 3)."""
    for k in range(len(states)):
        w, x, y, z = _multiply(left[k, 0], left[k, 1], left[k, 2], left[k, 3],
                               states[k, 3], states[k, 0], states[k, 1], states[k, 2])
        w, x, y, z = _multiply(w, x, y, z, right[k, 0], right[k, 1], right[k, 2], right[k, 3])
        along = x * axis[k, 0] + y * axis[k, 1] + z * axis[k, 2]
        across = math.sqrt(max(0.0, x * x + y * y + z * z - along * along))
        swing = 2.0 * math.atan2(across, math.sqrt(w * w + along * along))
        twist = _twist(along, w)
        beyond[k] = swing > stops[k, 0] + BEYOND or not stops[k, 1] - BEYOND <= twist <= stops[k, 2] + BEYOND
    return 0
