"""A ball joint as three hinges through one centre, each with a range: the last about the limb, so that MuJoCo limits its twist.

Angles are those of a Cardan suspension (x, y, z about axes that turn along), counted from the posture in which the limb points to
the middle of its cone with no twist. The second axis carries the third: at 90 degrees the first and the third are one, and
the joint has lost a direction; so the second ends before. With the second at an angle the third is not the twist of swing
and twist.
"""

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.scene.joint import SwingTwist
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

LOCKED = float(np.radians(89.0))
"""Widest angle [rad] of the second hinge. Wider: the first and the third become one axis, and qvel grows without end there."""
NARROWEST = 1e-9
"""Width [rad] given to a hinge whose two limits coincide; MuJoCo refuses an empty interval."""


def axes(limit: SwingTwist) -> Array:
    """Return (3, 3) rows: two axes across the limb and the limb's own, right-handed, in the link's frame."""
    limb = np.array(limit.axis)
    across = np.cross(limb, np.eye(3)[int(np.argmin(np.abs(limb)))])
    across /= np.linalg.norm(across)
    return np.array([across, np.cross(limb, across), limb])


def middle(limit: SwingTwist) -> Array:
    """Return the turn of the link in its parent's frame at which all angles are 0: the shortest to its cone's middle."""
    return np.asarray(rotation.between(limit.axis, limit.centre))


def angles(limit: SwingTwist, orientation: ArrayLike, turn: ArrayLike) -> Array:
    """Return angles (3,) [rad] that turn the link as a ball joint with that `turn` and rest pose `orientation` does."""
    turned = rotation.multiply(rotation.conjugate(middle(limit)), rotation.multiply(orientation, turn))
    across = axes(limit)
    matrix = across @ rotation.to_matrix(turned) @ across.T
    return np.array([
        np.arctan2(-matrix[1, 2], matrix[2, 2]), np.arctan2(matrix[0, 2], np.hypot(matrix[0, 0], matrix[0, 1])),
        np.arctan2(-matrix[0, 1], matrix[0, 0]),
    ])


def add(body: mujoco.MjsBody, name: str, limit: SwingTwist, limited: bool, armature: float) -> None:
    """Put the three hinges, called `name`.0 to `name`.2, into `body`, and turn it to where their angles are 0."""
    body.quat = middle(limit)
    ranges = ((-limit.swing, limit.swing), (-min(limit.swing, LOCKED), min(limit.swing, LOCKED)), limit.twist)
    for k, (axis, (low, high)) in enumerate(zip(axes(limit), ranges, strict=True)):
        joint = body.add_joint(name=f"{name}.{k}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis)
        joint.armature, joint.limited = armature, limited
        joint.range = [low, max(high, low + NARROWEST)]
