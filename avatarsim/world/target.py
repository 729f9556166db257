"""The tracker's posture of this frame as arrays, and how fast the tracker's links move."""

from math import isfinite

from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.world.doors import read_sample
from avatarsim.world.world import World, posture_of, sample_arrays


class Target:
    """The latest tracker sample. A bad one raises InvalidSample and leaves the last good one in place."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.posture = posture_of(world.skeleton, world.hinges, world.scene.first_sample)
        self._incoming = posture_of(world.skeleton, world.hinges, world.scene.first_sample)

    def read(self, sample: TrackerSample) -> None:
        """Check the sample and take it over."""
        positions, rotations, angles = sample_arrays(sample)
        fits = positions.shape == self.posture.root.shape and rotations.shape == (len(positions), 4)
        good = fits and angles.shape == self.world.hinges.shape and isfinite(sample.time)
        if not (good and read_sample(positions, rotations, angles, self.world.hinges, self._incoming)):
            # the slow check knows what is wrong and says it
            checked(sample, self.world.scene.avatars)
        self.posture, self._incoming = self._incoming, self.posture
