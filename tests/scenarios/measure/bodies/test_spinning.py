"""Spins, falling rods, tops: flips between frames, one by one, angles until a rod is down, rate of precession of an axis."""

from math import cos, sin

import numpy as np
import pytest

from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.building.expected import Flips, Pivot, Top
from scenarios.measure.bodies.closed_form import flips, pivots, tops
from scenarios.measure.value import Missing
from tests.scenarios.examples import drop_scene, expecting, resting

BALL, FRAMES = 1, 120


def swinging(late: float = 0.0) -> Recording:
    """Return a spin about y as a cosine of two radians per second, with zeros at pi/4, 3 pi/4, ..."""
    recording = resting(drop_scene(), FRAMES)
    recording.angular_velocities[:, BALL, 1] = np.cos(2.0 * (recording.times - late))
    return recording


def test_flips_are_compared_one_by_one_between_frames() -> None:
    wanted = Flips("ball", 1, (np.pi / 4, 3 * np.pi / 4))
    found = flips(swinging(0.001), expecting(FRAMES, flips=(wanted,)), drop_scene())
    assert found["flip_time_error_max"] == pytest.approx(0.001, abs=1e-9)
    # a flip too few is the engine's fault
    for recording in (resting(drop_scene(), FRAMES), swinging(-0.7)):
        none = flips(recording, expecting(FRAMES, flips=(Flips("ball", 1, (np.pi / 4,)),)), drop_scene())["flip_time_error_max"]
        assert isinstance(none, Missing) and none.fault == "engine"


def leaning(rate: float) -> Recording:
    """Return a rod that tilts at `rate` [rad/s] from 0.1 rad with a reported spin 0.01 rad/s larger."""
    recording = resting(drop_scene(), FRAMES)
    for k, time in enumerate(recording.times):
        half = 0.5 * (0.1 + rate * time)
        recording.orientations[k, BALL] = (cos(half), 0.0, sin(half), 0.0)
        recording.angular_velocities[k, BALL] = (0.0, rate + 0.01, 0.0)
    return recording


def test_a_rod_is_judged_by_its_angle_until_it_is_down() -> None:
    found = pivots(leaning(0.5), expecting(FRAMES, pivots=(Pivot("ball", lambda angle: 0.5, 1.0),)), drop_scene())
    assert found == {"pivot_rate_error_max": pytest.approx(0.01), "pivot_missing": 0.0}
    found = pivots(leaning(0.2), expecting(FRAMES, pivots=(Pivot("ball", lambda angle: 0.5, 1.0),)), drop_scene())
    assert found == {"pivot_rate_error_max": pytest.approx(0.29), "pivot_missing": pytest.approx(0.5)}


def precessing(rate: float, spin: float, lean: float = 0.2) -> Recording:
    """Return a top with `spin` about its tilted axis, which precesses at `rate`, both [rad/s]."""
    recording = resting(drop_scene(), FRAMES)
    upright, across = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)
    for k, time in enumerate(recording.times):
        own = rotation.from_axis_angle(upright, (spin - rate * cos(lean)) * time)
        leaning = rotation.multiply(rotation.from_axis_angle(across, lean), own)
        recording.orientations[k, BALL] = rotation.multiply(rotation.from_axis_angle(upright, rate * time), leaning)
        axis = rotation.rotate(recording.orientations[k, BALL], np.array([0.0, 0.0, 1.0]))
        recording.angular_velocities[k, BALL] = (spin - rate * cos(lean)) * axis + np.array([0.0, 0.0, rate])
    return recording


@pytest.mark.parametrize(("rate", "spin"), [(4.3, 200.0), (-3.1, 200.0), (4.0, 188.0), (12.0, 201.5)])
def test_top_is_compared_by_spin_and_precession(rate: float, spin: float) -> None:
    found = tops(precessing(rate, spin), expecting(FRAMES, tops=(Top("ball", 200.0, 4.0),)), drop_scene())
    assert found["axis_spin_error_max"] == pytest.approx(abs(spin - 200.0), abs=1e-9)
    assert found["precession_error_max"] == pytest.approx(abs(rate - 4.0), abs=1e-9)
    assert tops(precessing(rate, spin), expecting(FRAMES), drop_scene()) == {}
