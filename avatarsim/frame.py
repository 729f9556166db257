"""One rendered frame: the paper's Figure 3 on one screen, and nothing else.

Lower loop: driven bodies go towards the tracker and stop where they touch. Upper loop: simulated bodies move on.
"""

from avatarsim.engine import Snapshot
from avatarsim.posture.follow import follow
from avatarsim.posture.kinematics import forward
from avatarsim.posture.workspace import COUNT_NAMES, make_memory, metric
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.settings import CouplingSettings, PostureSettings
from avatarsim.stage_clock import StageClock
from avatarsim.world.doors import read_sample
from avatarsim.world.world import World, posture_of, sample_arrays


class Frames:
    """The stages of a frame over one world, in order, each only if the scene calls for its effect."""

    def __init__(
        self, world: World, posture: PostureSettings, coupling: CouplingSettings, *, record_inside: bool, time_stages: bool
    ) -> None:
        self.world, self.posture_settings, self.coupling_settings = world, posture, coupling
        self.effects, self.time, self.clock = world.scene.effects, 0.0, StageClock(time_stages)
        self.record_inside = record_inside
        if self.effects.overlap_removal:
            self.target = posture_of(world.skeleton, world.hinges, world.scene.first_sample)
            self.incoming = posture_of(world.skeleton, world.hinges, world.scene.first_sample)
            self.memory = make_memory(world.geometry, world.skeleton, world.poses)
            forward(
                world.geometry, world.skeleton, world.posture, self.memory.rows.x, world.poses, self.memory.axes
            )
            weight = metric(world.geometry, world.skeleton, world.poses, self.memory.axes, posture)
            self.memory.goal.inverse_weight[:] = 1.0 / weight

    def frame(self, sample: TrackerSample, dt: float) -> None:
        """Pass `dt` seconds: first the driven bodies, then the simulated ones."""
        self.clock.frame()
        world = self.world
        if self.effects.overlap_removal:
            self.read(sample)
            with self.clock.stage("posture"):
                follow(
                    world.geometry, world.skeleton, self.target, self.posture_settings, world.posture, world.poses, self.memory
                )
        self.time += dt

    def read(self, sample: TrackerSample) -> None:
        """The tracker's posture as arrays; a bad sample raises InvalidSample and changes nothing."""
        positions, rotations, angles = sample_arrays(sample)
        fits = positions.shape == self.target.root.shape and rotations.shape == (len(positions), 4)
        if not (fits and angles.shape == self.world.hinges.shape):
            checked(sample, self.world.scene.avatars)
        if not read_sample(positions, rotations, angles, self.world.hinges, self.incoming):
            checked(sample, self.world.scene.avatars)
        self.target, self.incoming = self.incoming, self.target

    def counts(self) -> dict[str, int]:
        """Work done in the last frame."""
        if not self.effects.overlap_removal:
            return {}
        return {name: int(count) for name, count in zip(COUNT_NAMES, self.memory.counts, strict=True)}

    def statuses(self) -> dict[str, int]:
        """What did not end well in the last frame."""
        return {}

    def inside(self) -> tuple[Snapshot, ...]:
        """Sub-steps and events of the last frame."""
        return ()
