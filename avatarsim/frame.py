"""One rendered frame: the paper's Figure 3 on one screen, and nothing else.

Lower loop: driven bodies go towards the tracker and stop where they touch. Upper loop: simulated bodies move on. Their order is
that of `Stage`; `stages.py` has their kernels.
"""

from collections.abc import Mapping, Sequence
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.counters import FrameClock, Stage, Tally
from avatarsim.engine import Snapshot
from avatarsim.errors import AvatarsimError
from avatarsim.jit.layout import Index
from avatarsim.lower_loop import IkLoop, TrackedLoop
from avatarsim.model.world import NOT_FINITE_POSE, Target, World, sample_arrays, shown_poses
from avatarsim.paper.method import PaperLoop
from avatarsim.rehearsal import Part
from avatarsim.rigid.step import DONE, SimulatedLoop
from avatarsim.scene.effects import Effects
from avatarsim.scene.moving import Pose, with_moving
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import Chosen
from avatarsim.stages import FINITE, MOVING, STAGE_KERNELS, STATUS, Output, Shown, make_job, pass_shown


def stages_of(effects: Effects, is_driven: bool) -> tuple[Stage, ...]:
    """Return the stages that a scene needs, in order."""
    return (
        *((Stage.POSTURE,) if is_driven else ()),
        *((Stage.MOTION,) if effects.dynamics else ()),
        *((Stage.COUPLING,) if is_driven and effects.dynamics and effects.coupling else ()),
    )


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
        "_counted", "_job", "_other_method", "_outcome", "clock", "driven", "effects", "given", "is_lost", "in_one_call", "lower",
        "moves", "output", "passed", "record", "stages", "target", "time", "upper", "world",
    )
    ASSIGNED: ClassVar[tuple[str, ...]] = ("time", "passed", "is_lost", "_outcome")
    WRITTEN: ClassVar[tuple[str, ...]] = ("given", "_job")

    def __init__(self, world: World, method: str, chosen: Chosen, seed: int, *, record: bool, time_stages: bool) -> None:
        self.world, self.effects, self.clock = world, world.scene.effects, FrameClock(time_stages)
        self.time, self.driven, self.record = 0.0, bool(world.scene.avatars), record
        self.stages = stages_of(self.effects, self.driven)
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
            self.lower.set_moving(moving)
        self._counted = (*self.lower.counts(), *self.upper.counts()) if self.driven and self.effects.dynamics else ()
        self.output = Output(world)
        lower = self.lower if self.driven else None
        self._other_method = None if isinstance(lower, IkLoop) else lower
        self.in_one_call = not (record or time_stages or self._other_method)
        self._job = make_job(
            world, self.target if self.driven else None, lower if isinstance(lower, IkLoop) else None,
            self.upper if self.effects.dynamics else None, self.output, moving, self.stages,
        )
        self._outcome: Sequence[int] = DONE, 0, 1

    def begin(self, sample: TrackerSample | None) -> Index:
        """Begin a frame: read the sample, or keep the last one where tracking is lost. Return its job (COLUMNS), for
        `pass_frames` if `in_one_call`. Raises InvalidSample for a sample that does not fit the avatars."""
        self.clock.begin()
        self.passed = ()
        if self.driven:
            if sample is not None:
                self.target.read(sample)
                if self.moves:
                    self._keep(sample)
            if isinstance(self.lower, IkLoop):
                self.lower.note_tracking(self.is_lost, self.target)
                self._job[MOVING + 1] = len(self.lower.begin())
        return self._job

    def end(self, dt: float, outcome: Sequence[int]) -> None:
        """Finish a frame that `pass_frames` has passed; `outcome` is what that wrote into its job, from column STATUS on."""
        self._outcome = outcome
        for stage in self.stages:
            self.clock.stages[stage].calls += 1
        self.time += dt

    def frame(self, sample: TrackerSample | None, dt: float) -> None:
        """Pass `dt` seconds: driven bodies, then simulated ones."""
        self.begin(sample)
        for stage in self.stages:
            with self.clock.stages[stage]:
                self._pass(stage, dt)
            if self.record:
                self.passed += self._recorded(stage, dt)
        self.time += dt
        self.show()

    def _pass(self, stage: Stage, dt: float) -> None:
        """Pass one stage."""
        if self._other_method is None or stage is Stage.MOTION:
            STAGE_KERNELS[stage](self._job, dt)
        elif stage is Stage.POSTURE:
            self._other_method.follow(self.target, dt)
        else:
            self._other_method.receive(self.upper.memory.received)

    def _recorded(self, stage: Stage, dt: float) -> tuple[Snapshot, ...]:
        """Return the states within a stage that was passed, of a frame that is recorded."""
        if stage is Stage.MOTION:
            return self.upper.inside(self.time)
        return self.lower.passed(self.time if stage is Stage.POSTURE else self.time + dt)

    def show(self) -> None:
        """Write the shown state."""
        pass_shown(self._job)
        self._outcome = self._job[STATUS:].tolist()

    def show_all(self) -> None:
        """Write the shown state between two frames: also of bodies that never move by themselves, which may be elsewhere."""
        written = self.output.shown
        written.positions[...], written.orientations[...] = shown_poses(self.world)
        self.show()

    def shown(self) -> Shown:
        """Return the shown state, as last written. AvatarsimError if a number of it is not finite."""
        if not self._outcome[FINITE - STATUS]:
            raise AvatarsimError(NOT_FINITE_POSE)
        return self.output.shown

    def _keep(self, sample: TrackerSample) -> None:
        """Keep a sample, for moving bodies whose pose is not given in the next frame."""
        for given, array in zip(self.given, sample_arrays(sample), strict=True):
            given[...] = array

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
        return counts.joined_with(self.upper.counts(), self._counted) if self.effects.dynamics else counts

    def statuses(self) -> dict[str, int]:
        """Return counts of failures in the last frame, by name."""
        status, has_status, _ = self._outcome
        if not (status or has_status or self.moves or self.is_lost or self.record or self._other_method):
            return {}
        statuses = self.lower.statuses() if self.driven else {}
        if self.is_lost and self.driven:
            statuses["tracking_lost"] = sum(not avatar.moves for avatar in self.world.scene.avatars)
        return statuses | self.upper.statuses(status) if self.effects.dynamics else statuses

    def retained_state(self) -> GivenSample:
        """Return the last given poses of moving bodies; those of other parts are theirs."""
        return GivenSample(self.given)

    def resume_from(self, time: float) -> None:
        """Continue from the arrays of a frame that ended at `time` [s], which replaced those of all parts."""
        self.time, self.passed = time, ()
        if self.driven:
            self.lower.resume(time > 0.0)
        if self.effects.dynamics:
            self.upper.resume()

    def parts(self) -> tuple[Part, ...]:
        """Return all that takes part in a frame."""
        loops = (*((self.target, self.lower) if self.driven else ()), *((self.upper,) if self.effects.dynamics else ()))
        return self, self.world, self.output, *loops, *self.clock.stages
