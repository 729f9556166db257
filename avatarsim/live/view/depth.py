"""Penetration depth of bodies for a page: by a judge if there is one, else by the engine's own distances."""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

from avatarsim.cleaning.chords import Chords, Pair
from avatarsim.live.messages import Array
from avatarsim.live.orders import posture_of
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses

Depth = Callable[[Scene, Array, Array, Array], float]
"""Deepest penetration [m] of a scene whose bodies and links are at positions (n, 3) [m] and orientations (n, 4), with hinges at
angles (hinges,) [rad]."""

LEAST = 1e-6
"""[m] Smallest overlap that counts: less is invisible, and within the engine's guarantee."""


def still(scene: Scene) -> Scene:
    """Return the scene without its loose bodies."""
    bodies = tuple(body for body in scene.bodies if body.role is Role.FIXED)
    names = {*(body.name for body in bodies), *scene.names[len(scene.bodies):]}
    exclude = tuple(pair for pair in scene.exclude if names.issuperset(pair))
    at_rest = tuple(entry for entry in scene.at_rest if names.issuperset(entry[:2]))
    return replace(scene, bodies=bodies, exclude=exclude, at_rest=at_rest, attached=(), require=(), force=())


class OwnOverlap:
    """Deepest overlap of a posture with the fixed bodies of a scene, and with itself."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    @cached_property
    def _chords(self) -> Chords:
        return Chords(still(self._scene))

    def deepest(self, sample: TrackerSample) -> tuple[float, Pair | None]:
        """Return the depth [m] and the names of the pair, fixed bodies first; 0 and None without overlap."""
        gap, pair = self._chords.nearest(sample, 0.0)
        return (-gap, pair) if gap < -LEAST else (0.0, None)

    def at(self, positions: Array, orientations: Array, angles: Array) -> tuple[float, Pair | None]:
        """Return the same for bodies and links at positions (n, 3) [m] and orientations (n, 4), with hinges at angles [rad]."""
        first = len(self._scene.bodies)
        return self.deepest(posture_of(self._scene, positions[first:], orientations[first:], angles))


def own_depth(scene: Scene) -> Depth:
    """Return a function for the depth of avatars in fixed bodies and in themselves, by the engine's own distances."""
    overlap = OwnOverlap(scene)
    return lambda scene, positions, orientations, angles: overlap.at(positions, orientations, angles)[0]


def own_posture(
    scene: Scene, sample: TrackerSample, positions: Array, orientations: Array, angles: Array
) -> tuple[Array, Array, Array]:
    """Return the poses of a state, and its angles, with the first avatar in the user's own posture."""
    places, turns = link_poses(scene.avatars, sample)
    own, first = scene.avatars[0], len(scene.bodies)
    positions, orientations, angles = np.array(positions), np.array(orientations), np.array(angles)
    positions[first : first + len(own.links)] = places[: len(own.links)]
    orientations[first : first + len(own.links)] = turns[: len(own.links)]
    angles[: own.hinge_count] = sample.angles[: own.hinge_count]
    return positions, orientations, angles
