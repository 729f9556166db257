"""Target posture of a frame: the tracker sample as arrays, checked as it is read."""

from collections.abc import Mapping
from math import isfinite
from typing import ClassVar

from avatarsim.errors import InvalidSample
from avatarsim.jit.arena import opened, packed
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Array, Index
from avatarsim.scene.checks import as_number
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.world.doors import read_sample
from avatarsim.world.parts import TargetParts
from avatarsim.world.skeleton import Posture
from avatarsim.world.world import World, posture_of, sample_arrays


@kernel
def read_opened(positions: Array, rotations: Array, angles: Array, target: Index) -> bool:
    """`read_sample` on the arena of a target: a good sample becomes its posture, a bad one is forgotten."""
    parts = opened(target, TargetParts)
    if not read_sample(positions, rotations, angles, parts.hinges, parts.incoming):
        return False
    return read_sample(positions, rotations, angles, parts.hinges, parts.posture)


class Target:
    """The latest tracker sample. A bad one raises InvalidSample and leaves the last good one in place."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ()
    WRITTEN: ClassVar[tuple[str, ...]] = ("words",)
    KEPT: ClassVar[tuple[str, ...]] = ("posture",)
    WORKING: ClassVar[tuple[str, ...]] = ()

    def __init__(self, world: World) -> None:
        self.world = world
        first = posture_of(world.skeleton, world.hinges, world.scene.first_sample)
        incoming = Posture(*(array.copy() for array in first))
        self.words, (self.posture, _, hinges) = packed(TargetParts(first, incoming, world.hinges))
        self._shapes = self.posture.root.shape, (len(self.posture.root), 4), hinges.shape

    def ranges(self) -> Mapping[str, tuple[int, int]]:
        """Nothing: a posture is real numbers."""
        return {}

    def read(self, sample: TrackerSample) -> None:
        """Check the sample and take it over."""
        try:
            positions, rotations, angles = sample_arrays(sample)
        except (AttributeError, TypeError, ValueError) as error:
            checked(sample, self.world.scene.avatars)
            raise InvalidSample("tracker sample", sample, "a TrackerSample of numbers") from error
        time, fits = sample.time, (positions.shape, rotations.shape, angles.shape) == self._shapes
        good = fits and isfinite(time if type(time) is float else as_number(time))
        if not (good and read_opened(positions, rotations, angles, self.words)):
            # the slow check finds which value is wrong, for the message
            checked(sample, self.world.scene.avatars)
            raise InvalidSample("tracker sample", sample, "finite, and quaternions of length 1")
