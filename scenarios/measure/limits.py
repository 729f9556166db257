"""How far shown postures are beyond the avatar's own limits: hinges, swing and twist of ball joints, reach cones."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Ball, Hinges, ReachCone, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from scenarios.measure.cone import beyond_cone_each
from scenarios.measure.joints import Place, angle_about, angle_between, beyond, gaps, places, relative, turned
from scenarios.measure.value import Values
from scenarios.record import Recording

Array = NDArray[np.float64]

SAME_TURN = 1e-6
"""Angle [rad] to which the hinge angles that an engine reports must agree with the pose that it shows. Further apart, the
report says nothing about the pose, and the difference itself counts as excess."""


def _hinges(joint: Hinges, place: Place, orientations: Array, angles: Array) -> Array:
    turn = turned(place, orientations)
    axes = [np.array(hinge.axis) for hinge in joint.hinges]
    if len(axes) == 1:
        told = angle_about(axes[0], turn)[:, None]
    elif angles.shape[1] >= place.angles.stop:
        # three angles are not one-to-one with a rotation, so the engine's own are taken, once they prove to be the pose
        told = angles[:, place.angles]
    else:
        return np.full(len(turn), np.nan)
    composed = np.tile(rotation.IDENTITY, (len(turn), 1))
    for axis, angle in zip(axes, told.T, strict=True):
        composed = rotation.multiply(composed, rotation.from_axis_angle(axis, angle))
    off = angle_between(composed, turn)
    excess = np.where(off <= SAME_TURN, 0.0, off)
    for hinge, angle in zip(joint.hinges, told.T, strict=True):
        excess = np.maximum(excess, beyond(angle, hinge.lower, hinge.upper))
    return np.asarray(excess)


def swing_twist(limits: SwingTwist, turn: Array) -> tuple[Array, Array]:
    """Swing (F,) of the limb away from its centre and twist (F,) [rad] about it, of rotations (F, 4) against the parent."""
    axis, centre = np.array(limits.axis), np.array(limits.centre)
    limb = rotation.rotate(turn, axis)
    swing = np.arctan2(np.linalg.norm(rotation.cross(limb, centre), axis=-1), limb @ centre)
    shortest = rotation.between(axis, centre)
    return swing, angle_about(axis, rotation.multiply(rotation.conjugate(shortest), turn))


def joint_limit_excess(scene: Scene, orientations: Array, angles: Array) -> Array:
    """(F,) largest excess [rad] over the limits of hinges and balls, of links' orientations (F, L, 4) and angles (F, H)."""
    worst = np.zeros(len(orientations))
    for place in places(scene):
        if isinstance(place.joint, Hinges):
            worst = np.maximum(worst, _hinges(place.joint, place, orientations, angles))
        elif isinstance(place.joint, Ball) and place.joint.limits is not None:
            limits = place.joint.limits
            swing, twist = swing_twist(limits, relative(place, orientations))
            worst = np.maximum(worst, np.maximum(swing - limits.swing, beyond(twist, *limits.twist)))
    return worst


def limb_axis(joint: Ball, cone: ReachCone, place: Place) -> Array:
    """(3,) unit axis of the limb in its own frame: that of the swing limits; without them the direction that is the cone's
    visible point when the joint is at zero."""
    if joint.limits is not None:
        return np.array(joint.limits.axis)
    return rotation.rotate(rotation.conjugate(place.orientation), np.array(cone.visible_point))


def reach_cone_excess(scene: Scene, orientations: Array) -> Array:
    """(F,) largest angle [rad] by which a limb points outside its reach cone."""
    worst = np.zeros(len(orientations))
    for place in places(scene):
        if isinstance(place.joint, Ball) and place.joint.cone is not None:
            limbs = rotation.rotate(relative(place, orientations), limb_axis(place.joint, place.joint.cone, place))
            worst = np.maximum(worst, beyond_cone_each(place.joint.cone, limbs))
    return worst


def limit_excess(recording: Recording, scene: Scene) -> Values:
    """joint_limit_excess_max, reach_cone_excess_max [deg], joint_gap_max [m] over all frames. Empty without joints."""
    if not (scene.derived_effects.limits or scene.derived_effects.kinematics):
        return {}
    orientations, positions = recording.orientations[:, recording.links], recording.positions[:, recording.links]
    found = {
        "joint_limit_excess_max": float(np.degrees(np.max(joint_limit_excess(scene, orientations, recording.angles)))),
        "joint_gap_max": float(np.max(gaps(scene, positions, orientations))),
    }
    if scene.derived_effects.reach_cones:
        found["reach_cone_excess_max"] = float(np.degrees(np.max(reach_cone_excess(scene, orientations))))
    return found
