"""Directions: against gravity, and of a body's own z axis."""

import numpy as np

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from runfiles.record import Array, Recording


def up(scene: Scene) -> Array:
    """Return the unit vector against gravity."""
    return -np.array(scene.gravity) / float(np.linalg.norm(scene.gravity))


def own_axis(recording: Recording, scene: Scene, body: str) -> Array:
    """Return the z axis (F+1, 3) of a body in all states shown."""
    return rotation.rotate(recording.orientations[:, scene.names.index(body)], np.array([0.0, 0.0, 1.0]))


def lean(recording: Recording, scene: Scene, body: str) -> Array:
    """Return the angle (F+1,) [rad] of that axis from upright."""
    axis, upright = own_axis(recording, scene, body), up(scene)
    return np.asarray(np.arctan2(np.linalg.norm(rotation.cross(axis, upright), axis=1), axis @ upright))
