"""An engine that is driven frame by frame under the eyes of the judge."""

from dataclasses import dataclass

import numpy as np

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from reference.judging.judge import Judge
from tests.stability.hostile import DT, ball_excess, hinge_excess, link_error


@dataclass
class Ride:
    """An engine that is driven frame by frame under the eyes of the judge."""

    scene: Scene
    engine: AvatarsimEngine
    judge: Judge
    record: FrameRecord

    def frame(self, sample: TrackerSample, dt: float = DT) -> FrameRecord:
        """Run one frame; overlap and limits are exact zeros, in every frame."""
        self.record = self.engine.advance(sample, dt)
        shown = self.record.shown
        verdict = self.judge.overlaps(shown.positions, shown.orientations)
        assert verdict.deepest == 0.0, (shown.time, verdict.pairs)
        assert hinge_excess(self.scene, self.record) <= 0.0
        assert ball_excess(self.scene, shown.orientations[None])[0] <= 1e-9
        return self.record

    def error(self, sample: TrackerSample) -> float:
        """Return the distance [m] of links from the sample."""
        return link_error(self.scene, self.record, sample)

    def place(self, name: str) -> np.ndarray:
        """Return where a body is shown."""
        return self.record.shown.positions[self.scene.names.index(name)]


def ride(scene: Scene, seed: int = 0, preset: str = "default", **options: object) -> Ride:
    """Return a loaded engine."""
    engine = AvatarsimEngine()
    return Ride(scene, engine, Judge(scene), engine.load(scene, Settings(preset, options, seed), DT))
