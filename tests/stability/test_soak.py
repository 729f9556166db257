"""The soak test: its scene runs, the user's motion closes, and what grows, slows or overlaps is a fault."""

import mmap

import numpy as np
import pytest

from avatarsim.engine import FrameRecord
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from tests.stability import soak as soaked
from tests.stability.soak import Report, motion, scene, soak

GONE: list[mmap.mmap] = []
"""What the forgetful engine never gives back."""


class Hoards(AvatarsimEngine):
    """An engine that keeps a megabyte of each frame, up to four hundred."""

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """A frame as usual."""
        if len(GONE) < 400:
            # pages of its own: what malloc gives may be memory that the process has had all along
            GONE.append(mmap.mmap(-1, 2**20))
            GONE[-1].write(b"x" * 2**20)
        return super().advance(sample, dt)


def report(resident: list[float], ratios: list[float], overlap: float = 0.0) -> Report:
    return Report(np.full(10, 100_000), ratios, [round(1e6 * one) for one in resident], [overlap], frames=10)


@pytest.mark.parametrize(("made", "said"), [
    (report([90.0, 100.0, 106.0, 100.0], [1.0] * 4), "memory grew by 16.00 MB"),
    (report([100.0] * 40 + [105.5], [1.0] * 40), "memory grew by 5.50 MB"),
    (report([100.0] * 20, [1.0] * 10 + [1.06] * 10), "slower by 6.0 %"),
    (report([100.0] * 20, [1.0] * 10 + [float("nan")] * 10), "slower by nan %"),
    (report([100.0] * 20, [1.0] * 20, 2e-6), "an overlap of 2e-06 m"),
    (report([100.0] * 20, [1.0] * 20, float("nan")), "an overlap of nan m"),
])
def test_each_fault_is_said(made: Report, said: str) -> None:
    [fault] = made.faults()
    assert said in fault


def test_what_grows_at_first_and_frames_that_get_faster_are_no_fault() -> None:
    assert report([80.0] + [100.0] * 39 + [104.0], [1.1] * 20 + [1.0] * 20).faults() == []


def test_the_user_ends_a_period_where_the_next_begins() -> None:
    moves = motion(scene())
    first, last, second = moves[0], moves[-1], moves[1]
    step = np.abs(second.positions - first.positions).max(), np.abs(second.angles - first.angles).max()
    assert np.abs(first.positions - last.positions).max() <= 1.1 * step[0] + 1e-3
    assert np.abs(first.angles - last.angles).max() <= 1.1 * step[1] + 1e-3
    np.testing.assert_allclose(first.angles, scene().first_sample.angles, atol=1e-9)


def test_short_periods_show_no_overlap_and_an_engine_that_hoards_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(soaked, "PERIOD", 8)
    monkeypatch.setattr(soaked, "MOST_DRIFT", np.inf)
    whole = soak(24, samples=2)
    assert (whole.frames, len(whole.resident), len(whole.ratios)) == (24, 2, 2)
    assert whole.deepest <= soaked.DEEPEST and "worst frame" in whole.text()
    assert any("memory" in fault for fault in soak(24, Hoards, samples=2).faults())
