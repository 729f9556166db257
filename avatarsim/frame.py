"""One rendered frame: the paper's Figure 3 on one screen, and nothing else.

Lower loop: driven bodies go towards the tracker and stop where they touch. Upper loop: simulated bodies move on.
"""

from avatarsim.coupling_loop import Coupling
from avatarsim.engine import Snapshot
from avatarsim.impact.events import make_events
from avatarsim.posture.follow import follow
from avatarsim.posture.workspace import COUNT_NAMES, ready_memory, was_held
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings, PostureSettings
from avatarsim.stage_clock import StageClock
from avatarsim.upper_loop import DONE, STATUS_NAMES, advance
from avatarsim.upper_loop_memory import COUNT_NAMES as MOTION_COUNT_NAMES
from avatarsim.upper_loop_memory import Switches
from avatarsim.upper_loop_memory import make_memory as make_motion_memory
from avatarsim.recorded_events import snapshots
from avatarsim.world.target import Target
from avatarsim.world.world import World


class Frames:
    """The stages of a frame over one world, in order, each only if the scene calls for its effect."""

    def __init__(
        self, world: World, posture: PostureSettings, coupling: CouplingSettings, *, record_inside: bool, time_stages: bool
    ) -> None:
        self.world, self.posture_settings, self.coupling_settings = world, posture, coupling
        self.effects, self.clock = world.scene.effects, StageClock(time_stages)
        self.begun = self.time = 0.0
        self.status, self.record_inside = DONE, record_inside
        if self.effects.overlap_removal:
            self.target = Target(world)
            self.memory = ready_memory(world.geometry, world.skeleton, world.posture, world.poses, posture)
        if self.effects.coupling:
            self.coupling = Coupling(world, coupling)
        if self.effects.dynamics:
            self.motion = make_motion_memory(world.geometry, world.dynamics, world.poses, self.effects.gyroscopic)
            self.events = make_events(len(world.scene.names), 256 if record_inside else 0)
            self.switches = Switches(self.effects.gyroscopic, self.effects.continuous, self.effects.sleeping, False, record_inside)

    def frame(self, sample: TrackerSample, dt: float) -> None:
        """Pass `dt` seconds: first the driven bodies, then the simulated ones."""
        world = self.world
        self.clock.frame()
        if self.effects.overlap_removal:
            self.target.read(sample)
            if self.effects.coupling:
                with self.clock.stage("coupling"):
                    self.coupling.pull(self.target, dt)
            self.memory.counts[:] = 0
            self.follow_target()
        if self.effects.dynamics:
            with self.clock.stage("motion"):
                self.status = advance(
                    world.geometry, world.dynamics, world.poses, world.velocities, dt, self.motion, self.events, self.switches
                )
            if self.effects.coupling:
                self.coupling.receive(self.motion.received)
                if was_held(self.memory) and self.motion.moving.any():
                    # what was in the way may have moved on within this frame: do not wait for the next one
                    self.follow_target()
        self.begun, self.time = self.time, self.time + dt

    def follow_target(self) -> None:
        """Lower loop: driven bodies go towards the tracker, every state certified."""
        world = self.world
        with self.clock.stage("posture"):
            follow(
                world.geometry, world.skeleton, self.target.posture, self.posture_settings, world.posture, world.poses, self.memory
            )

    def counts(self) -> dict[str, int]:
        """Work done in the last frame."""
        counts: dict[str, int] = {}
        if self.effects.overlap_removal:
            counts |= zip(COUNT_NAMES, self.memory.counts.tolist(), strict=True)
        if self.effects.dynamics:
            counts |= zip(MOTION_COUNT_NAMES, self.motion.counts.tolist(), strict=True)
        return counts

    def statuses(self) -> dict[str, int]:
        """What did not end well in the last frame."""
        return {} if self.status == DONE else {f"motion {STATUS_NAMES[self.status]}": 1}

    def inside(self) -> tuple[Snapshot, ...]:
        """Events of the last frame, if they are recorded."""
        return snapshots(self.world, self.events, self.begun) if self.record_inside and self.effects.dynamics else ()
