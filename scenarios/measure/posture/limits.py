"""Angles beyond joint limits: hinges, swing and twist, reach cones (spherical polygons); the least angle that limits leave."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Ball, Hinges, ReachCone, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import cross
from runfiles.record import Recording
from scenarios.measure.posture.joints import Place, angle_about, angle_between, beyond, gaps, places, relative, turned
from scenarios.measure.value import Values, measure

Array = NDArray[np.float64]

NO_ARC = 1e-12
"""Length [rad] below which an edge is a point: no plane through the origin holds it and nothing else."""


def beyond_cone(cone: ReachCone, directions: Array) -> Array:
    """Return angles (F,) [rad] from unit directions (F, 3), in the parent's frame, to the cone; 0 inside; nan for nan.

    Inside is each direction in one of the spherical triangles (visible point, edge), which together are the polygon.
    """
    sound = np.asarray(np.isfinite(directions).all(axis=1))
    limbs = np.where(sound[:, None], directions, 0.0)
    seen, starts = np.array(cone.visible_point), cone.vertices
    ends = np.roll(starts, -1, axis=0)
    # three planes through the origin bound each triangle; counter-clockwise edges have the inside on their left
    first, edge, second = (cross(a, b) @ limbs.T >= 0.0 for a, b in ((seen, starts), (starts, ends), (ends, seen)))
    outside = ~(first & edge & second).any(axis=0)
    beyond = np.zeros(len(limbs))
    if outside.any():
        beyond[outside] = _angles_to_edges(starts, ends, limbs[outside]).min(axis=0)
    return np.where(sound, beyond, np.nan)


def _angles_to_edges(starts: Array, ends: Array, limbs: Array) -> Array:
    """Return (E, F) angles [rad] from directions (F, 3) to the nearest point of each of E great arcs, which make a polygon."""
    to_start = np.arctan2(np.linalg.norm(cross(starts[:, None], limbs), axis=2), starts @ limbs.T)
    apart = np.minimum(to_start, np.roll(to_start, -1, axis=0))
    normals = cross(starts, ends)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    # an arc without length has no lune, and its ends are all there is of it
    normals = np.where(lengths > NO_ARC, normals / np.maximum(lengths, NO_ARC), 0.0)
    within = (cross(normals, starts) @ limbs.T >= 0.0) & (cross(ends, normals) @ limbs.T >= 0.0) & (lengths > NO_ARC)
    across = normals @ limbs.T
    feet = limbs - across[:, :, None] * normals[:, None]
    return np.asarray(np.where(within, np.abs(np.arctan2(across, np.linalg.norm(feet, axis=2))), apart))


SAME_TURN = 1e-6
"""Angle [rad] to which the hinge angles that an engine reports must agree with the pose that it shows. Further apart, the
report does not describe the pose, and the difference itself counts as excess."""


def _hinges(joint: Hinges, place: Place, orientations: Array, angles: Array) -> Array:
    turn = turned(place, orientations)
    axes = [np.array(hinge.axis) for hinge in joint.hinges]
    if len(axes) == 1:
        measured = angle_about(axes[0], turn)[:, None]
    elif angles.shape[1] >= place.angles.stop:
        # three angles are not one-to-one with a rotation, so the engine's own are taken, once they prove to be the pose
        measured = angles[:, place.angles]
    else:
        return np.full(len(turn), np.nan)
    composed = np.tile(rotation.IDENTITY, (len(turn), 1))
    for axis, angle in zip(axes, measured.T, strict=True):
        composed = rotation.multiply(composed, rotation.from_axis_angle(axis, angle))
    off = angle_between(composed, turn)
    excess = np.where(off <= SAME_TURN, 0.0, off)
    for hinge, angle in zip(joint.hinges, measured.T, strict=True):
        excess = np.maximum(excess, beyond(angle, hinge.lower, hinge.upper))
    return np.asarray(excess)


def swing_twist(limits: SwingTwist, turn: Array) -> tuple[Array, Array]:
    """Return swing (F,) of the limb from its centre and twist (F,) [rad] about it, of rotations (F, 4) against the parent."""
    axis, centre = np.array(limits.axis), np.array(limits.centre)
    limb = rotation.rotate(turn, axis)
    swing = np.arctan2(np.linalg.norm(rotation.cross(limb, centre), axis=-1), limb @ centre)
    shortest = rotation.between(axis, centre)
    return swing, angle_about(axis, rotation.multiply(rotation.conjugate(shortest), turn))


def joint_limit_excess(scene: Scene, orientations: Array, angles: Array) -> Array:
    """Return (F,) largest excess [rad] over limits of hinges and balls, of links' orientations (F, L, 4), angles (F, H)."""
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
    """Return (3,) unit axis of the limb in its own frame: that of the swing limits; without them the direction that is the cone's
    visible point when the joint is at zero."""
    if joint.limits is not None:
        return np.array(joint.limits.axis)
    return rotation.rotate(rotation.conjugate(place.orientation), np.array(cone.visible_point))


def reach_cone_excess(scene: Scene, orientations: Array) -> Array:
    """Return (F,) largest angle [rad] by which a limb points outside its reach cone."""
    worst = np.zeros(len(orientations))
    for place in places(scene):
        if isinstance(place.joint, Ball) and place.joint.cone is not None:
            limbs = rotation.rotate(relative(place, orientations), limb_axis(place.joint, place.joint.cone, place))
            worst = np.maximum(worst, beyond_cone(place.joint.cone, limbs))
    return worst


@measure
def limit_excess(recording: Recording, scene: Scene) -> Values:
    """Return joint_limit_excess_max, reach_cone_excess_max [deg], joint_gap_max [m] over all frames. Empty without joints."""
    if not (scene.derived_effects.limits or scene.derived_effects.kinematics):
        return {}
    orientations, positions = recording.orientations[:, recording.links], recording.positions[:, recording.links]
    excess = {
        "joint_limit_excess_max": float(np.degrees(np.max(joint_limit_excess(scene, orientations, recording.angles)))),
        "joint_gap_max": float(np.max(gaps(scene, positions, orientations))),
    }
    if scene.derived_effects.reach_cones:
        excess["reach_cone_excess_max"] = float(np.degrees(np.max(reach_cone_excess(scene, orientations))))
    return excess
