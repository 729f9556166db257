"""One rendered frame: the paper's Figure 3 on one screen, and nothing else.

Lower loop: driven bodies go towards the tracker and stop where they touch. Upper loop: simulated bodies move on.

`batch.advance_worlds` has the stages of the frame once more, for `advance_many`: there a kernel passes the frames of all worlds
that need nothing between their stages. `engine.advance` comes here, and so do worlds of `advance_many` whose stages are timed,
which are recorded, or whose method is another than `default`.
"""

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.batch import MOVING, Output, job_of
from avatarsim.counters import StageClock, Tally
from avatarsim.engine import Snapshot
from avatarsim.jit.layout import Index
from avatarsim.lower_loop import IkLoop, TrackedLoop
from avatarsim.model.world import Target, World, sample_arrays
from avatarsim.paper.method import PaperLoop
from avatarsim.rehearsal import Part
from avatarsim.rigid.step import SimulatedLoop
from avatarsim.scene.moving import Pose, with_moving
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import Chosen


def make_lower_loop(
    world: World, method: str, chosen: Chosen, seed: int, record: bool
) -> IkLoop | PaperLoop | TrackedLoop:
    """Return the lower loop of a method; without overlap removal the tracker's posture is shown as it is."""
    if not world.scene.effects.overlap_removal:
        return TrackedLoop(world)
    if method == "paper":
        return PaperLoop(world, chosen.paper, chosen.coupling, chosen.attraction, seed)
    return IkLoop(world, chosen.posture, chosen.coupling, seed, record=record)


class GivenSample(NamedTuple):
    """Positions, rotations and angles of the last sample for moving bodies; empty without any."""

    given: tuple[NDArray[np.float64], ...]


class Frames:
    """The stages of a frame over one world, in order, each only if the scene needs its effect."""

    # places of their own: which attributes there are depends on the scene, and after some thirty scenes of other kinds Python
    # would keep those of this one in a dictionary
    __slots__ = (
        "_counted", "_job", "clock", "driven", "effects", "given", "is_lost", "lower", "moves", "output", "passed", "record",
        "target", "time", "upper", "world",
    )
    ASSIGNED: ClassVar[tuple[str, ...]] = ("time", "passed", "is_lost")
    WRITTEN: ClassVar[tuple[str, ...]] = ("given",)

    def __init__(self, world: World, method: str, chosen: Chosen, seed: int, *, record: bool, time_stages: bool) -> None:
        self.world, self.effects, self.clock = world, world.scene.effects, StageClock(time_stages)
        self.time, self.driven, self.record = 0.0, bool(world.scene.avatars), record
        self.passed: tuple[Snapshot, ...] = ()
        self.is_lost = False
        self.moves = any(avatar.moves for avatar in world.scene.avatars)
        self.given = tuple(array.copy() for array in sample_arrays(world.scene.first_sample)) if self.moves else ()
        moving = np.zeros(len(world.scene.names), dtype=np.int64)
        if self.driven:
            self.target = Target(world)
            self.lower = make_lower_loop(world, method, chosen, seed, record)
        if self.effects.dynamics:
            kept = (chosen.paper if method == "paper" else chosen.posture).stand_off
            self.upper = SimulatedLoop(world, paper=method == "paper", record=record, stand_off=kept)
            moving = self.upper.memory.moving
        if self.driven:
            self.lower.watch(moving)
        self._counted = (*self.lower.counts(), *self.upper.counts()) if self.driven and self.effects.dynamics else ()
        self.output = Output(world)
        self._job = self._as_job(moving) if not (record or time_stages) else None

    def _as_job(self, moving: Index) -> Index | None:
        """Return the row of this world for `batch`; None where its method has no kernel for whole frames."""
        upper = self.upper if self.effects.dynamics else None
        if not self.driven:
            return job_of(self.world, None, None, upper, self.output, moving)
        if not isinstance(self.lower, IkLoop):
            return None
        return job_of(self.world, self.target, self.lower, upper, self.output, moving)

    def _read(self, sample: TrackerSample | None) -> None:
        """Read a sample; where tracking is lost the last one stays."""
        if sample is not None:
            self.target.read(sample)
            if self.moves:
                self._keep(sample)
        if isinstance(self.lower, IkLoop):
            self.lower.note_tracking(self.is_lost, self.target)

    def begin(self, sample: TrackerSample | None) -> Index | None:
        """Begin a frame that `batch` will pass, and return its row; None, and nothing is begun, where a frame has to be passed
        stage by stage: another method than `default`, a recording, stages that are timed. InvalidSample as in `frame`."""
        if self._job is None:
            return None
        # nothing is timed here, so the clock has nothing to forget
        self.passed = ()
        if self.driven:
            self._read(sample)
            if isinstance(self.lower, IkLoop):
                self._job[MOVING + 1] = len(self.lower.begin())
        return self._job

    def end(self, dt: float, status: int) -> None:
        """Finish that frame once it was passed: its time, the upper loop's status, and the calls of its stages."""
        stages = self.clock.stages
        if self.driven:
            stages["posture"].calls += 1
        if self.effects.dynamics:
            self.upper.status = status
            stages["motion"].calls += 1
            if self.effects.coupling and self.driven:
                stages["coupling"].calls += 1
        self.time += dt

    def frame(self, sample: TrackerSample | None, dt: float) -> None:
        """Pass `dt` seconds: driven bodies, then simulated ones. Changes here need the same ones in `batch.advance_worlds`."""
        self.clock.frame()
        self.passed = ()
        if self.driven:
            self._read(sample)
            with self.clock.stage("posture"):
                self.lower.follow(self.target, dt)
            if self.record:
                self.passed += self.lower.passed(self.time)
        if self.effects.dynamics:
            with self.clock.stage("motion"):
                self.upper.advance(dt)
            if self.record:
                self.passed += self.upper.inside(self.time)
            if self.effects.coupling and self.driven:
                with self.clock.stage("coupling"):
                    self.lower.receive(self.upper.memory.received, self.upper.memory.moving, self.target)
                if self.record:
                    self.passed += self.lower.passed(self.time + dt)
        self.time += dt

    def _keep(self, sample: TrackerSample) -> None:
        """Keep a sample, for moving bodies whose pose is not given in the next frame."""
        for kept, array in zip(self.given, sample_arrays(sample), strict=True):
            kept[...] = array

    def completed(self, sample: TrackerSample | None, poses: Mapping[str, Pose]) -> TrackerSample | None:
        """Return the sample with the given poses of moving bodies, and the last ones of those that are not given; None where
        tracking is lost, and the last sample stays."""
        self.is_lost = sample is None
        if not (self.moves or poses):
            return sample
        if sample is None:
            sample = TrackerSample(self.time, *(self.given or sample_arrays(self.world.scene.first_sample)))
        last = TrackerSample(self.time, *self.given) if self.moves else sample
        return with_moving(self.world.scene.avatars, sample, poses, last)

    def counts(self) -> Tally:
        """Return the work done in the last frame."""
        if not self.driven:
            return self.upper.counts() if self.effects.dynamics else Tally()
        counts = self.lower.counts()
        return counts.beside(self.upper.counts(), self._counted) if self.effects.dynamics else counts

    def statuses(self) -> dict[str, int]:
        """Return counts of failures in the last frame, by name."""
        statuses = self.lower.statuses() if self.driven else {}
        if self.is_lost and self.driven:
            statuses["tracking_lost"] = sum(not avatar.moves for avatar in self.world.scene.avatars)
        return statuses | self.upper.statuses() if self.effects.dynamics else statuses

    def kept(self) -> GivenSample:
        """Return the last given poses of moving bodies; those of other parts are theirs."""
        return GivenSample(self.given)

    def go_on_from(self, time: float) -> None:
        """Continue from the arrays of a frame that ended at `time` [s], which replaced those of all parts."""
        self.time, self.passed = time, ()
        if self.driven:
            self.lower.go_on(time > 0.0)
        if self.effects.dynamics:
            self.upper.go_on()

    def parts(self) -> tuple[Part, ...]:
        """Return all that takes part in a frame."""
        loops = (*((self.target, self.lower) if self.driven else ()), *((self.upper,) if self.effects.dynamics else ()))
        return self, self.world, *loops, *self.clock.stages.values()
