"""Free rotation: when a spin about the middle axis turns over; and rods that fall about their foot."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BarycentricInterpolator
from scipy.optimize import brentq

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from scenarios.expected import Flips, Pivot
from scenarios.measure.expecting import expected
from scenarios.measure.value import Missing, Value, Values
from scenarios.record import Recording
from scenarios.scenario import Scenario

Array = NDArray[np.float64]

NEIGHBOURS = 6
"""Samples on each side of a change of sign through which the polynomial goes. At 60 Hz and a flip of a third of a second twelve
samples place it to 1e-9 s, two to 1e-4 s."""


def crossings(times: Array, values: Array) -> list[float]:
    """Times [s] at which `values` change sign, to the accuracy of a polynomial through the samples around."""
    found = []
    for k in np.flatnonzero(np.signbit(values[:-1]) != np.signbit(values[1:])):
        low, high = max(0, int(k) + 1 - NEIGHBOURS), int(k) + 1 + NEIGHBOURS
        middle = float(times[k])
        curve = BarycentricInterpolator(times[low:high] - middle, values[low:high])
        found.append(middle + float(brentq(curve, 0.0, float(times[k + 1]) - middle, xtol=1e-13)))
    return found


def flips(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """flip_time_error_max [s]: largest difference of the n-th change of sign from the closed form's n-th, over all that the
    recording is long enough for. One that did not happen, or one too many, is the engine's fault. Empty without flips."""
    errors: list[float] = []
    entries = expected(scenario, "flips", Flips)
    for entry in entries:
        own = scene.names.index(entry.body)
        body_axes = rotation.conjugate(recording.orientations[:, own])
        spin = rotation.rotate(body_axes, recording.angular_velocities[:, own])[:, entry.axis]
        # the polynomial needs its samples on both sides
        end = float(recording.times[-1]) - (NEIGHBOURS + 1) * recording.dt
        wanted = [time for time in entry.times if time < end]
        seen = [time for time in crossings(recording.times, spin) if time < end] if np.isfinite(spin).all() else []
        if len(seen) != len(wanted):
            return {"flip_time_error_max": Missing(f"{entry.body} flipped {len(seen)} times instead of {len(wanted)}", "engine")}
        errors += [abs(a - b) for a, b in zip(seen, wanted, strict=True)]
    if not entries:
        return {}
    early: Value = Missing("the recording ends before the first flip", "scene")
    return {"flip_time_error_max": max(errors) if errors else early}


def pivots(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """pivot_rate_error_max [rad/s]: largest difference of a leaning rod's angular speed from what energy allows at its angle, and
    pivot_missing [rad]: by how much it fell short of the angle that it is to reach. Empty without pivots."""
    entries = expected(scenario, "pivots", Pivot)
    if not entries:
        return {}
    errors, short = [], []
    # upright is against gravity, whichever way the world lies
    up = -np.array(scene.gravity) / np.linalg.norm(scene.gravity)
    for entry in entries:
        own = scene.names.index(entry.body)
        axis = rotation.rotate(recording.orientations[:, own], np.array([0.0, 0.0, 1.0]))
        lean = np.arctan2(np.linalg.norm(rotation.cross(axis, up), axis=1), axis @ up)
        speed = np.linalg.norm(recording.angular_velocities[:, own], axis=1)
        falling = lean <= entry.until
        # once down it is down: what it does afterwards is not this closed form's affair
        last = int(np.argmin(falling)) if not falling.all() else len(lean)
        errors.append(float(np.max(np.abs(speed[:last] - [entry.rate(float(a)) for a in lean[:last]]))))
        short.append(max(0.0, entry.until - float(np.max(lean))))
    return {"pivot_rate_error_max": float(np.max(errors)), "pivot_missing": float(np.max(short))}
