"""The posture from which scenes with the humanoid begin: upright, knees soft, arms a little away, touching nothing."""

from dataclasses import replace

import numpy as np

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Hinges
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from scenarios.building.reach import reach

ARMS_OUT = float(np.radians(20.0))
"""Angle by which the upper arms are lifted sideways [rad]; at 0 the wrists come within 3 mm of the hips."""
KNEES_BENT = float(np.radians(10.0))
"""Bend of knees and elbows [rad]: a straight limb leaves open which way to fold."""
CLEARANCE = 0.01
"""Height of the soles above the floor at the start [m]."""
FORWARD, LEFT, UP = np.eye(3)


def standing(avatar: Avatar, x: float = 0.0, y: float = 0.0, heading: float = 0.0) -> TrackerSample:
    """Return the humanoid standing at (x, y) [m] on the floor z = 0, looking along `heading` [rad] from the x axis."""
    sample = rest((avatar,))
    turns = {"root": rotation.from_axis_angle(UP, heading)}
    for side, sign in (("left", 1.0), ("right", -1.0)):
        turns[f"{side}_shoulder"] = rotation.from_axis_angle(FORWARD, sign * ARMS_OUT)
        # thighs forward and shanks back by the same angle keep the soles level and under the body
        turns[f"{side}_hip"] = turns[f"{side}_ankle"] = rotation.from_axis_angle(LEFT, -0.5 * KNEES_BENT)
    rotations, angles = sample.rotations.copy(), []
    for k, link in enumerate(avatar.links):
        rotations[k] = turns.get(link.name, rotations[k])
        if isinstance(link.joint, Hinges):
            angles.append(KNEES_BENT if link.name.endswith("elbow") else -KNEES_BENT)
    positions = sample.positions.copy()
    posed = replace(sample, rotations=rotations, angles=np.array(angles), positions=positions)
    positions[0] = (x, y, CLEARANCE + float(reach((avatar,), (posed,), -UP)[0]))
    return posed
