"""Excess of postures beyond joint limits: hinges, swing and twist of balls, and reach cones, in plain numpy.

The definitions are those of the kernels of `avatarsim/model/joint_limits.py`, for whole clips at once.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Ball, ReachCone, axes_of, unit_of
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

NOTICED = 1e-6
"""Angle [rad] from which a joint counts as beyond its limits: below the precision of any file."""


@dataclass(frozen=True)
class Beyond:
    """A joint that a clip takes beyond its limits: in `frames` frames, by at `most` so much [`unit`: rad or m]."""

    joint: str
    frames: int
    most: float
    unit: str = "rad"

    @property
    def text(self) -> str:
        """Excess with its unit, for a sentence."""
        return f"{1e3 * self.most:.1f} mm" if self.unit == "m" else f"{np.degrees(self.most):.1f} degrees"


def beyond_limits(avatar: Avatar, motion: Motion) -> tuple[Beyond, ...]:
    """Return the joints that a motion of this avatar takes beyond their limits, worst first."""
    found, hinge = [], 0
    for k, link in enumerate(avatar.links):
        excess, unit = np.zeros(len(motion)), "rad"
        for joint in axes_of(link.joint):
            angle, unit = motion.angles[:, hinge], unit_of(joint)
            excess = np.maximum(excess, np.maximum(joint.lower - angle, angle - joint.upper))
            hinge += 1
        if isinstance(link.joint, Ball):
            excess = ball_excess(link.joint, rotation.multiply(link.orientation, motion.rotations[:, k]))
        frames = int((excess > NOTICED).sum())
        if frames:
            found.append(Beyond(link.name, frames, float(excess.max()), unit))
    return tuple(sorted(found, key=lambda one: -one.most))


def ball_excess(joint: Ball, turned: Array) -> Array:
    """Return the excess (F,) [rad] of turns (F, 4), from the link's frame to the parent's, over a ball's limits; 0 inside."""
    excess = np.zeros(len(turned))
    if joint.limits is not None:
        swing, twist = swing_and_twist(turned, joint.limits.axis, joint.limits.centre)
        low, high = joint.limits.twist
        excess = np.maximum(swing - joint.limits.swing, np.maximum(low - twist, twist - high))
        if joint.cone is not None:
            limbs = rotation.rotate(turned, joint.limits.axis)
            excess = np.maximum(excess, reach_excess(joint.cone, limbs))
    return np.maximum(excess, 0.0)


def swing_and_twist(turned: ArrayLike, axis: ArrayLike, centre: ArrayLike) -> tuple[Array, Array]:
    """Return swing (...,) [rad] of turns (..., 4), the angle of the limb, `axis` turned, to `centre`, and twist (...,) [rad].
    Twist is the rest about `centre` with the limb swung back, counted from the shortest turn of `axis` onto `centre`."""
    start, middle = np.asarray(axis, dtype=np.float64), np.asarray(centre, dtype=np.float64)
    limb = rotation.rotate(turned, start)
    across = rotation.cross(middle, limb)
    swing = np.arctan2(np.linalg.norm(across, axis=-1), limb @ middle)
    back = rotation.conjugate(rotation.from_rotation_vector(_along(across, swing)))
    untwisted = rotation.multiply(turned, rotation.conjugate(rotation.between(start, middle)))
    left = rotation.multiply(back, untwisted)
    return np.asarray(swing), np.asarray(_wrapped(2.0 * np.arctan2(left[..., 1:] @ middle, left[..., 0])))


def _along(across: Array, angle: Array) -> Array:
    """Return vectors (..., 3) of these lengths along others; zero along one without length."""
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    return np.asarray(across / np.where(length > 1e-12, length, 1.0) * angle[..., None])


def _wrapped(angle: Array) -> Array:
    return np.asarray(np.arctan2(np.sin(angle), np.cos(angle)))


def reach_excess(cone: ReachCone, limbs: Array) -> Array:
    """Return the angles (F,) [rad] of unit directions (F, 3) outside a polygon: triangles of its edges and visible point."""
    seen, starts = np.array(cone.visible_point), cone.vertices
    inside, cosine = np.zeros(len(limbs), dtype=np.bool_), np.full(len(limbs), -1.0)
    for start, end in zip(starts, np.roll(starts, -1, axis=0), strict=True):
        inward = rotation.cross(start, end)
        inward /= np.linalg.norm(inward)
        height = limbs @ inward
        inside |= (limbs @ rotation.cross(seen, start) >= 0.0) & (limbs @ rotation.cross(seen, end) <= 0.0) & (height >= 0.0)
        feet = limbs - height[:, None] * inward
        on_arc = (feet @ rotation.cross(inward, start) >= 0.0) & (feet @ rotation.cross(end, inward) >= 0.0)
        # the distance of the perpendicular's foot from the limb is the limb's height above the edge's plane
        nearest = np.maximum(limbs @ start, np.where(on_arc, np.linalg.norm(feet, axis=1), -1.0))
        cosine = np.maximum(cosine, nearest)
    sine = np.sqrt(np.clip(1.0 - cosine * cosine, 0.0, None))
    return np.where(inside, 0.0, np.arctan2(sine, cosine))
