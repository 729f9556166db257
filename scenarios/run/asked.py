"""What a job asks of every engine alike: the scene, what the user does in it, and what follows from these alone.

Building a scene and checking a motion may take longer than an engine's frames, and neither changes: what one run of a process
worked out, the next in the same scene finds again.
"""

from dataclasses import dataclass
from functools import cached_property
from importlib import import_module

from numpy import float64
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked, link_poses_each
from scenarios.job import Job
from scenarios.measure.known import Known
from scenarios.run.provenance import scene_hash
from scenarios.scenario import Motion, Scenario

Array = NDArray[float64]
Key = tuple[str, str, int, bool, int | None, tuple[str, ...], tuple[str, ...]]


@dataclass(frozen=True, eq=False)
class Asked:
    """A scenario `offered` by a catalogue at the length in which it is run, its scene and motion."""

    offered: Scenario
    scenario: Scenario
    scene: Scene
    motion: Motion

    @cached_property
    def samples(self) -> list[TrackerSample]:
        """The user's samples, frame by frame. Raises InvalidSample for one that is not valid."""
        return [checked(self.motion(k), self.scene.avatars) for k in range(self.scenario.frames)]

    def first(self, frames: int) -> list[TrackerSample]:
        """The samples of the first `frames` frames, or of all there are; each is worked out once."""
        kept = self._worked_out
        kept += [self.motion(k) for k in range(len(kept), min(frames, self.scenario.frames))]
        return kept[:frames]

    @cached_property
    def _worked_out(self) -> list[TrackerSample]:
        return []

    @cached_property
    def states(self) -> list[TrackerSample]:
        """The same with the first posture before it: one for each state that an engine shows."""
        return [self.scene.first_sample, *self.samples]

    @cached_property
    def raw(self) -> tuple[Array, Array]:
        """Where the tracker has the links in each of these states: (F+1, links, 3) [m] and (F+1, links, 4)."""
        return link_poses_each(self.scene.avatars, self.states)

    @cached_property
    def scene_hash(self) -> str:
        """Digits that stand for everything in the scene's description."""
        return scene_hash(self.scene)

    @cached_property
    def known(self) -> Known:
        """What measures of the scene have in common; it is judged whole."""
        return Known(self.scenario, self.scene.whole)


_last: dict[Key, Asked] = {}
"""What was asked last in this process: at most one, since engines come scene by scene."""


def asked(job: Job) -> Asked:
    """What `job` asks, from the run before where that asked the same. Raises what the catalogue raises."""
    key = job.catalogue, job.scenario, job.seed, job.full, job.frames, job.narrow, job.force
    offered = import_module(job.catalogue).get(job.scenario)
    if key not in _last or _last[key].offered is not offered:
        _last.clear()
        _last[key] = Asked(offered, *job.asked())
    return _last[key]
