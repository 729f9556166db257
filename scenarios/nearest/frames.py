"""Frames in contact: what was shown there, what the nearest free posture would be, and how far the user is from both."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from reference.nearest_free.search import ENOUGH, Found, Problem, descend, scattered
from reference.nearest_free.tree import Posture, Tree
from runfiles.record import Recording
from scenarios.measure.overlap import SEEN
from scenarios.measure.posture.free import free_frames
from scenarios.measure.posture.limits import joint_limit_excess, reach_cone_excess
from scenarios.measure.side import outside
from scenarios.scenario import Scenario

Array = NDArray[np.float64]

SPREADS = (0.05, 0.15, 0.4)
"""Standard deviations [rad] of random starts, about the user's posture and about the one shown."""

WITHIN = 1e-6
"""How far [m] inside its region a link's origin is sought: the search may end its own tolerance beyond what it is told."""


@dataclass(frozen=True)
class Sample:
    """One frame: root mean square distances of link origins [m] and of joint angles [rad] from the user of the posture shown, of
    the nearest free one, and of the nearest that is downhill from the one shown; `ends` of `starts` led to a posture that the
    judge allows. nan where none did. What was nearest is decided by offset squared plus (`arm` [m] times angle) squared."""

    scenario: str
    frame: int
    arm: float
    offset: float
    angle: float
    nearest_offset: float
    nearest_angle: float
    downhill_offset: float
    downhill_angle: float
    starts: int
    ends: int


class Frames:
    """The frames of one recording, and other engines' recordings of the same scene to start from."""

    def __init__(self, scenario: Scenario, scene: Scene, recording: Recording, others: Sequence[Recording]) -> None:
        self.scenario, self.scene, self.recording, self.others = scenario, scene, recording, others
        self.tree, self.judge, self.bodies = Tree(scene), Judge(scene), len(scene.bodies)
        links = len(scene.links)
        self.low, self.high = np.full((links, 3), -np.inf), np.full((links, 3), np.inf)
        for region in scenario.regions:
            at = [k - self.bodies for k in region.indices(scene.names) if k >= self.bodies]
            self.low[at] = np.maximum(self.low[at], np.array(region.low) + WITHIN)
            self.high[at] = np.minimum(self.high[at], np.array(region.high) - WITHIN)

    def in_contact(self) -> NDArray[np.int64]:
        """Frames, from 1, in which the user's own posture could not be shown: those that the `_free` figures leave out."""
        free = free_frames(self.recording, self.scenario, self.scene, self.judge.link_depths)
        return np.flatnonzero(~free[1:]) + 1

    def shown(self, recording: Recording, frame: int) -> Posture | None:
        """What a recording shows; None for an engine that does not tell its hinge angles, or poses that are no numbers."""
        positions, orientations = recording.positions[frame, recording.links], recording.orientations[frame, recording.links]
        if recording.angles.shape[1] != len(self.tree.limits) or not np.isfinite(positions).all():
            return None
        return self.tree.from_poses(positions, orientations, recording.angles[frame])

    def user(self, frame: int) -> Posture:
        """The tracker's own posture."""
        r = self.recording
        return self.tree.from_poses(r.raw_positions[frame], r.raw_orientations[frame], r.raw_angles[frame])

    def problem(self, frame: int) -> Problem:
        """The search of one frame: bodies where they were shown, the user where the tracker had them."""
        r = self.recording
        positions, orientations = r.positions[frame, : self.bodies], r.orientations[frame, : self.bodies]
        return Problem(self.scene, self.tree, positions, orientations, self.user(frame), self.low, self.high)

    def holds(self, found: Found, frame: int) -> bool:
        """Whether the judge, the limits and the regions allow what the search found."""
        placed = self.tree.placed(found.posture)
        turns = rotation.from_matrix(placed.turns)
        positions = np.vstack([self.recording.positions[frame, : self.bodies], placed.positions])
        orientations = np.vstack([self.recording.orientations[frame, : self.bodies], turns])
        excess = joint_limit_excess(self.scene, turns[None], found.posture.angles[None])[0]
        excess = max(excess, reach_cone_excess(self.scene, turns[None])[0])
        wrong = outside(positions[None], self.scenario.regions, self.scene.names)[0]
        return bool(excess <= ENOUGH and not wrong and self.judge.link_depths(positions[None], orientations[None])[0] <= SEEN)

    def starts(self, frame: int, before: Posture | None) -> list[Posture]:
        """What is shown, what the user does, the nearest of the sample before, other engines' postures, and random ones."""
        random, goal = np.random.default_rng(frame), self.user(frame)
        seen = [self.shown(recording, frame) for recording in (self.recording, *self.others)]
        known = [posture for posture in (seen[0], goal, before, *seen[1:]) if posture is not None]
        about = [goal] if seen[0] is None else [goal, seen[0]]
        return known + [scattered(self.tree, posture, spread, random) for posture in about for spread in SPREADS]

    def samples(self, count: int) -> Iterator[Sample]:
        """`count` frames in contact, evenly spread over all of them, or as many as there are."""
        frames = self.in_contact()
        if len(frames) == 0:
            return
        chosen = np.unique(frames[np.linspace(0, len(frames) - 1, count + 2).round().astype(int)[1:-1]])
        before: Posture | None = None
        for frame in chosen.tolist():
            problem, starts = self.problem(frame), self.starts(frame, before)
            ends = [descend(problem, start) for start in starts]
            allowed = [found if found.allowed and self.holds(found, frame) else None for found in ends]
            good = [found for found in allowed if found is not None]
            best = min(good, key=lambda found: found.score, default=None)
            before = best.posture if best else before
            # where an engine tells no angles there is no posture shown, and the first start is another
            here = self.shown(self.recording, frame)
            own, downhill = (None, None) if here is None else (problem.found(here), allowed[0])
            yield Sample(
                self.scenario.name, frame, problem.arm, *_figures(own), *_figures(best), *_figures(downhill),
                len(starts), len(good),
            )


def _figures(found: Found | None) -> tuple[float, float]:
    return (found.offset, found.angle) if found else (np.nan, np.nan)
