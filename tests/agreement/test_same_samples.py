"""Every engine gets the same tracker samples at the same instants, to the bit, and computes the same frames."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from avatarsim.engine import Engine, FrameRecord, Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from runfiles.record import load
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.run import accuracy as room
from scenarios.run.accuracy import accuracy
from tests.agreement.rivals import HAS_PYBULLET, STUDIED_ENGINES
from tests.agreement.runs import of_catalog

ROOT = Path(__file__).resolve().parents[2]
FRAMES = 12
NAMES = ("avatarsim", "mujoco", "tracker", *(("pybullet",) if HAS_PYBULLET else ()))
SCENES = ("driven_10cm_wall", "two_arms", "hand_grasp", "squeeze")


class Listening:
    """An engine that records its inputs."""

    def __init__(self, inner: Engine, heard: list[tuple[float, bytes]]) -> None:
        self.inner, self.heard = inner, heard

    def __getattr__(self, name: str) -> object:
        return getattr(self.inner, name)

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        self.note(scene.first_sample, dt)
        return self.inner.load(scene, settings, dt)

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        self.note(sample, dt)
        return self.inner.advance(sample, dt)

    def note(self, sample: TrackerSample, dt: float) -> None:
        """Record the time, frame time and every number of a sample, as bytes."""
        numbers = np.concatenate([sample.positions.ravel(), sample.rotations.ravel(), sample.angles, [dt]])
        self.heard.append((sample.time, numbers.tobytes()))


@pytest.mark.parametrize("scene", SCENES)
def test_all_engines_hear_the_same(scene: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    heard: dict[str, list[tuple[float, bytes]]] = {name: [] for name in NAMES}
    monkeypatch.setattr(room, "opened", lambda name: Listening(opened(name), heard[name]))
    recordings = {}
    for name in NAMES:
        outcome = accuracy(Job(scene, name, "default", frames=FRAMES), tmp_path)
        assert outcome.state == "measured" and outcome.recording is not None, outcome.note
        recordings[name] = load(outcome.recording)
    first = recordings[NAMES[0]]
    assert len(heard[NAMES[0]]) == FRAMES + 1
    for name in NAMES[1:]:
        assert heard[name] == heard[NAMES[0]]
        other = recordings[name]
        for field in ("times", "raw_positions", "raw_orientations", "raw_angles"):
            assert getattr(other, field).tobytes() == getattr(first, field).tobytes()
        # they also begin in the same first state
        assert np.abs(other.positions[0] - first.positions[0]).max() <= 1e-12


def fingerprints() -> list[str]:
    """Return a hash of all bits of the last state of a run by each engine."""
    return [of_catalog(opened(engine.name), SCENES[0], Settings("tuned"), 60)[1][-1].state_hash() for engine in STUDIED_ENGINES]


def test_a_run_in_another_process_is_the_same() -> None:
    code = "from tests.agreement.test_same_samples import fingerprints; print(*fingerprints())"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split() == fingerprints()
