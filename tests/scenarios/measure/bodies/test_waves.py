"""Waves through dominoes: an injected speed is found, also of a wave that stops, and upright dominoes are counted."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.building.expected import Wave
from scenarios.measure.bodies.waves import TOPPLED, waves
from scenarios.measure.value import Value
from tests.scenarios.examples import drop, resting

ROW, PITCH, FRAMES = 20, 0.02, 240
NAMES = tuple(f"domino_{k}" for k in range(ROW))
WAVE = Wave(NAMES, PITCH, 0.9, 5, 17)
FALL = 8.0
"""Angular velocity of each domino after it is struck [rad/s]."""


def row() -> Scene:
    pieces = (Piece(Box((0.005, 0.02, 0.04))),)
    bodies = (simulated(name, pieces, "wood", solid(pieces, 0.01), (PITCH * k, 0.0, 0.02)) for k, name in enumerate(NAMES))
    return Scene("row", tuple(bodies))


def running(speed: float, until: int = ROW) -> Recording:
    """Return a recording in which each domino passes TOPPLED when the front arrives; those from `until` on are never reached."""
    recording = resting(row(), FRAMES)
    for k in range(until):
        lean = np.clip(TOPPLED + FALL * (recording.times - 0.1 - PITCH * k / speed), 0.0, 1.2)
        recording.orientations[:, k] = rotation.from_axis_angle((0.0, 1.0, 0.0), lean)
    return recording


def figures(recording: Recording, wave: Wave = WAVE) -> dict[str, Value]:
    return dict(waves(recording, replace(drop(FRAMES), expects={"waves": (wave,)}), row()))


@pytest.mark.parametrize("speed", [0.9, 0.45, 1.35, 0.803])
def test_wave_speed_comes_out_between_frames(speed: float) -> None:
    found = figures(running(speed))
    assert found["wave_speed_error"] == pytest.approx(100.0 * abs(speed / 0.9 - 1.0), abs=0.1)
    assert found["wave_missing"] == 0.0


def test_wave_that_stops_has_the_speed_of_its_way() -> None:
    recording = running(0.9, until=12)
    found = figures(recording)
    began = 0.1 + 5 * PITCH / 0.9
    assert found["wave_missing"] == 8.0
    assert found["wave_speed_error"] == pytest.approx(100.0 * (1.0 - 6 * PITCH / (FRAMES / 60.0 - began) / 0.9), abs=0.1)


@pytest.mark.parametrize("until", [0, 3, 6])
def test_a_wave_that_never_begins_has_no_speed(until: int) -> None:
    assert figures(running(0.9, until=until)) == {"wave_speed_error": 100.0, "wave_missing": float(ROW - until)}
