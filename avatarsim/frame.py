"""One rendered frame: the paper's Figure 3 on one screen, and nothing else.

Lower loop: driven bodies go towards the tracker and stop where they touch. Upper loop: simulated bodies move on.
"""

from avatarsim.engine import Snapshot
from avatarsim.impact.events import make_events
from avatarsim.loops.checked import CheckedLoop
from avatarsim.loops.paper import PaperLoop
from avatarsim.loops.recorded_events import snapshots
from avatarsim.loops.tracked import TrackedLoop
from avatarsim.loops.upper import DONE, STATUS_NAMES, advance
from avatarsim.loops.upper_memory import COUNT_NAMES, Switches, make_memory
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import Chosen
from avatarsim.stage_clock import StageClock
from avatarsim.world.target import Target
from avatarsim.world.world import World

EVENTS_KEPT = 256
"""Most events of one frame that a recording keeps (two per impact); more are counted."""


def lower_loop(world: World, method: str, chosen: Chosen, seed: int) -> CheckedLoop | PaperLoop | TrackedLoop:
    """The lower loop of a method; without overlap removal the tracker's posture is shown as it is."""
    if not world.scene.effects.overlap_removal:
        return TrackedLoop(world)
    if method == "paper":
        return PaperLoop(world, chosen.paper, chosen.coupling, chosen.attraction, seed)
    return CheckedLoop(world, chosen.posture, chosen.coupling)


class Frames:
    """The stages of a frame over one world, in order, each only if the scene calls for its effect."""

    def __init__(self, world: World, method: str, chosen: Chosen, seed: int, *, record: bool, time_stages: bool) -> None:
        self.world, self.effects, self.clock, self.record = world, world.scene.effects, StageClock(time_stages), record
        self.begun, self.time, self.status = 0.0, 0.0, DONE
        if world.scene.avatars:
            self.target = Target(world)
            self.lower = lower_loop(world, method, chosen, seed)
        if self.effects.dynamics:
            on = self.effects
            self.motion = make_memory(world.geometry, world.dynamics, world.poses, on.gyroscopic)
            self.events = make_events(len(world.scene.names), EVENTS_KEPT if record else 0)
            self.switches = Switches(on.gyroscopic, on.continuous, on.sleeping, method == "paper", record)

    def frame(self, sample: TrackerSample, dt: float) -> None:
        """Pass `dt` seconds: first the driven bodies, then the simulated ones."""
        world = self.world
        self.clock.frame()
        if world.scene.avatars:
            self.target.read(sample)
            with self.clock.stage("posture"):
                self.lower.follow(self.target.posture, dt)
        if self.effects.dynamics:
            with self.clock.stage("motion"):
                self.status = advance(
                    world.geometry, world.dynamics, world.poses, world.velocities, dt, self.motion, self.events, self.switches
                )
            if self.effects.coupling:
                with self.clock.stage("coupling"):
                    self.lower.receive(self.motion.received, self.target.posture, bool(self.motion.moving.any()))
        self.begun, self.time = self.time, self.time + dt

    def counts(self) -> dict[str, int]:
        """Work done in the last frame."""
        counts = self.lower.counts() if self.world.scene.avatars else {}
        if self.effects.dynamics:
            counts |= zip(COUNT_NAMES, self.motion.counts.tolist(), strict=True)
        return counts

    def statuses(self) -> dict[str, int]:
        """What did not end well in the last frame."""
        statuses = self.lower.statuses() if self.world.scene.avatars else {}
        return statuses if self.status == DONE else {**statuses, f"motion {STATUS_NAMES[self.status]}": 1}

    def inside(self) -> tuple[Snapshot, ...]:
        """Events of the last frame, if they are recorded."""
        return snapshots(self.world, self.events, self.begun) if self.record and self.effects.dynamics else ()
