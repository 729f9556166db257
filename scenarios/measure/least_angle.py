"""How near to the user's angles joints can come at all without leaving their limits: what no method can go below."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Ball, Hinges, Joint, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from scenarios.measure.cone import beyond_cone_each
from scenarios.measure.joints import Place, angle_about, beyond, places, relative, turned
from scenarios.measure.limits import limb_axis, swing_twist
from scenarios.record import Recording

Array = NDArray[np.float64]


def least_angles(recording: Recording, scene: Scene) -> Array:
    """(F, joints) angle [rad] that each joint is from the raw tracker's at least, whatever posture within limits is shown.

    A lower bound: a turn by some angle takes no direction farther than that, so a limb that points out of its cone or swing limit
    by that much is at least so far, and a hinge as far as it is beyond its limits. What a twist limit asks for besides, and three
    hinges at one joint, is not counted. Joints and their order as in `angle_offsets`."""
    raw = recording.raw_orientations[1:]
    found = [_least(place.joint, place, raw) for place in places(scene) if not isinstance(place.joint, Rigid)]
    return np.array(found, dtype=np.float64).reshape(len(found), recording.frames).T


def _least(joint: Joint, place: Place, raw: Array) -> Array:
    least = np.zeros(len(raw))
    if isinstance(joint, Hinges) and len(joint.hinges) == 1:
        hinge = joint.hinges[0]
        least = beyond(angle_about(np.array(hinge.axis), turned(place, raw)), hinge.lower, hinge.upper)
    if isinstance(joint, Ball):
        turn = relative(place, raw)
        if joint.limits is not None:
            least = np.maximum(least, swing_twist(joint.limits, turn)[0] - joint.limits.swing)
        if joint.cone is not None:
            least = np.maximum(least, beyond_cone_each(joint.cone, rotation.rotate(turn, limb_axis(joint, joint.cone, place))))
    return least
