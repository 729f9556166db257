"""The soak test: its scene runs, the user's motion closes, and growth, slowing and overlap are faults."""

import mmap
from typing import Any

import numpy as np
import pytest

from avatarsim.engine import FrameRecord
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from tests.stability import soak as soaked
from tests.stability.soak import Report, motion, scene, soak

GONE: list[mmap.mmap] = []
"""Memory that the forgetful engine never gives back."""


class Hoards(AvatarsimEngine):
    """An engine that keeps a megabyte of each frame, up to four hundred."""

    def advance(self, sample: TrackerSample | None, dt: float, moving: Any = None) -> FrameRecord:
        """Return a frame as usual."""
        if len(GONE) < 400:
            # pages of its own: memory from malloc may have been the process's all along
            GONE.append(mmap.mmap(-1, 2**20))
            GONE[-1].write(b"x" * 2**20)
        return super().advance(sample, dt, moving)


def report(resident: list[float], ratios: list[float], overlap: float = 0.0) -> Report:
    return Report(np.full(10, 100_000), ratios, [round(1e6 * one) for one in resident], [overlap], frames=10)


NAN = float("nan")


@pytest.mark.parametrize(("made", "figure", "value"), [
    (report([90.0, 100.0, 106.0, 100.0], [1.0] * 4), "growth", 16.0),
    (report([100.0] * 40 + [105.5], [1.0] * 40), "growth", 5.5),
    (report([100.0] * 20, [1.0] * 10 + [1.06] * 10), "drift", 0.06),
    (report([100.0] * 20, [1.0] * 10 + [NAN] * 10), "drift", NAN),
    (report([100.0] * 20, [1.0] * 20, 2e-6), "deepest", 2e-6),
    (report([100.0] * 20, [1.0] * 20, NAN), "deepest", NAN),
])
def test_a_figure_that_is_too_large_or_no_number_is_a_fault(made: Report, figure: str, value: float) -> None:
    assert getattr(made, figure) == pytest.approx(value, nan_ok=True) and len(made.faults()) == 1
    # memory that grows at first and frames that get faster are none
    assert report([80.0] + [100.0] * 39 + [104.0], [1.1] * 20 + [1.0] * 20).faults() == []


def test_the_user_ends_a_period_where_the_next_begins() -> None:
    moves = motion(scene())
    first, last, second = moves[0], moves[-1], moves[1]
    step = np.abs(second.positions - first.positions).max(), np.abs(second.angles - first.angles).max()
    assert np.abs(first.positions - last.positions).max() <= 1.1 * step[0] + 1e-3
    assert np.abs(first.angles - last.angles).max() <= 1.1 * step[1] + 1e-3
    np.testing.assert_allclose(first.angles, scene().first_sample.angles, atol=1e-9)


def test_a_short_soak_is_free_and_finds_an_engine_that_hoards(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(soaked, "PERIOD", 8)
    monkeypatch.setattr(soaked, "MOST_DRIFT", np.inf)
    whole = soak(24, samples=2)
    assert (whole.frames, len(whole.resident), len(whole.ratios)) == (24, 2, 2)
    assert whole.deepest <= soaked.DEEPEST
    assert any("growth" in fault for fault in soak(24, Hoards, samples=2).faults())
