"""How deep bodies are in each other, as a page asks for it: by a judge where there is one, else by our own distances."""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

from avatarsim.cleaning.chords import Chords, Pair
from avatarsim.live.messages import Array
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample

Depth = Callable[[Scene, Array, Array, Array], float]
"""Deepest penetration [m] of a scene whose bodies and links are at positions (n, 3) [m] and orientations (n, 4), with hinges at
angles (hinges,) [rad]."""

LEAST = 1e-6
"""[m] of an overlap that counts: below, there is none to an eye or to the promise."""


def still(scene: Scene) -> Scene:
    """The scene without its loose bodies."""
    bodies = tuple(body for body in scene.bodies if body.role is Role.FIXED)
    names = {*(body.name for body in bodies), *scene.names[len(scene.bodies):]}
    exclude = tuple(pair for pair in scene.exclude if names.issuperset(pair))
    at_rest = tuple(entry for entry in scene.at_rest if names.issuperset(entry[:2]))
    return replace(scene, bodies=bodies, exclude=exclude, at_rest=at_rest, attached=(), require=(), force=())


class OwnOverlap:
    """The deepest overlap of a user's own posture with the fixed bodies of a scene, and with itself."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    @cached_property
    def _chords(self) -> Chords:
        return Chords(still(self._scene))

    def pair(self, sample: TrackerSample) -> Pair | None:
        """Names of the two that overlap deepest, those of fixed bodies first; None where nothing overlaps."""
        gap, pair = self._chords.nearest(sample, 0.0)
        return pair if gap < -LEAST else None
