"""Bodies against closed forms: courses, sliding to a stop, flips about the middle axis, rods about their foot, tops."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BarycentricInterpolator
from scipy.optimize import brentq

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.building.expected import Course, Flips, OfTime, Pivot, Stop, Top
from scenarios.measure.expecting import expected
from scenarios.measure.value import Missing, Value, Values, measure
from scenarios.scenario import Scenario

Array = NDArray[np.float64]

METRICS = ("course_error_max", "velocity_error_max", "spin_error_max")


def _errors(recording: Recording, course: Course, body: int) -> Iterator[tuple[str, Array]]:
    """(metric, distances (k,) from the closed form) of what the course states, over the states within its time."""
    chosen = (recording.times >= course.since) & (recording.times <= course.until)
    times = recording.times[chosen]
    stated = zip(METRICS, (course.position, course.velocity, course.spin), strict=True)
    shown = (recording.positions, recording.velocities, recording.angular_velocities)
    for (metric, form), values in zip(stated, shown, strict=True):
        if form is not None:
            yield metric, np.linalg.norm(values[chosen, body] - _at(form, times), axis=1)


def _at(form: OfTime, times: Array) -> Array:
    return np.array([form(float(time)) for time in times], dtype=np.float64).reshape(-1, 3)


@measure
def course_errors(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """course_error_max [m], velocity_error_max [m/s], spin_error_max [rad/s]: largest distance from the closed form over all
    bodies and states; nan stays nan. Only those that a course states; empty without courses."""
    found: dict[str, list[Array]] = {}
    for course in expected(scenario, "courses", Course):
        for metric, errors in _errors(recording, course, scene.names.index(course.body)):
            found.setdefault(metric, []).append(errors)
    values: dict[str, Value] = {}
    for metric, listed in found.items():
        together = np.concatenate(listed)
        early = Missing("the recording ends before the closed form begins", "scene")
        values[metric] = float(np.max(together)) if len(together) else early
    return values


@measure
def stops(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """stop_distance_error_max [%]: largest |way - closed form| of the last state, along the closed form's direction;
    stop_direction_error_max [deg]: largest angle between the two ways, 90 where a body never moved. Empty without stops.

    A recording that ends before a body should have stopped compares what it has: an engine that never moves is not excused.
    """
    entries = expected(scenario, "stops", Stop)
    if not entries:
        return {}
    ways, angles = [], []
    for entry in entries:
        path = recording.positions[:, scene.names.index(entry.body)]
        way, along = path[-1] - path[0], np.array(entry.direction)
        ahead = float(way @ along)
        ways.append(100.0 * abs(ahead - entry.distance) / entry.distance)
        angles.append(float(np.degrees(np.arctan2(np.linalg.norm(way - ahead * along), ahead))) if way.any() else 90.0)
    return {"stop_distance_error_max": float(np.max(ways)), "stop_direction_error_max": float(np.max(angles))}


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


@measure
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


@measure
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


@measure
def tops(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return axis_spin_error_max [rad/s], the largest difference of a top's spin about its own z axis from the stated one, and
    precession_error_max [rad/s], that of the mean rate at which this axis goes round gravity. Empty without tops."""
    entries = expected(scenario, "tops", Top)
    if not entries:
        return {}
    spins, rates = [], []
    up = -np.array(scene.gravity) / np.linalg.norm(scene.gravity)
    for entry in entries:
        own = scene.names.index(entry.body)
        axis = rotation.rotate(recording.orientations[:, own], np.array([0.0, 0.0, 1.0]))
        spins.append(np.abs(np.sum(recording.angular_velocities[:, own] * axis, axis=1) - entry.spin).max())
        flat = axis - (axis @ up)[:, None] * up
        turned = np.arctan2(rotation.cross(flat[:-1], flat[1:]) @ up, np.sum(flat[:-1] * flat[1:], axis=1)).sum()
        rates.append(abs(turned / (recording.times[-1] - recording.times[0]) - entry.precession))
    return {"axis_spin_error_max": float(np.max(spins)), "precession_error_max": float(np.max(rates))}
