"""Bodies against closed forms: courses, sliding to a stop, flips about the middle axis, rods about their foot, tops."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BarycentricInterpolator
from scipy.optimize import brentq

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.building.expected import Course, Flips, OfTime, Pivot, Stop, Top
from scenarios.measure.bodies.axes import lean, own_axis, up
from scenarios.measure.expecting import for_each
from scenarios.measure.value import Missing, Value, Values

Array = NDArray[np.float64]

METRICS = ("course_error_max", "velocity_error_max", "spin_error_max")


@for_each("courses", Course)
def course_errors(recording: Recording, scene: Scene, course: Course) -> Values:
    """Return course_error_max [m], velocity_error_max [m/s], spin_error_max [rad/s]: largest distances from the stated values of
    the course's closed form, over the states within its time; nan stays nan."""
    chosen, body = (recording.times >= course.since) & (recording.times <= course.until), scene.names.index(course.body)
    stated = zip(METRICS, (course.position, course.velocity, course.spin), strict=True)
    shown = (recording.positions, recording.velocities, recording.angular_velocities)
    by_metric: dict[str, Value] = {}
    for (metric, form), values in zip(stated, shown, strict=True):
        if form is not None:
            errors = np.linalg.norm(values[chosen, body] - _at(form, recording.times[chosen]), axis=1)
            early = Missing("the recording ends before the closed form begins", "scene")
            by_metric[metric] = float(np.max(errors)) if len(errors) else early
    return by_metric


def _at(form: OfTime, times: Array) -> Array:
    return np.array([form(float(time)) for time in times], dtype=np.float64).reshape(-1, 3)


@for_each("stops", Stop)
def stops(recording: Recording, scene: Scene, stop: Stop) -> Values:
    """Return stop_distance_error_max [%]: |way - closed form| of the last state, along the closed form's direction;
    stop_direction_error_max [deg]: angle between the two ways, 90 where a body never moved.

    A recording that ends before a body should have stopped is compared as it is: an engine that never moves is not excused.
    """
    path = recording.positions[:, scene.names.index(stop.body)]
    way, along = path[-1] - path[0], np.array(stop.direction)
    ahead = float(way @ along)
    angle = float(np.degrees(np.arctan2(np.linalg.norm(way - ahead * along), ahead))) if way.any() else 90.0
    return {"stop_distance_error_max": 100.0 * abs(ahead - stop.distance) / stop.distance, "stop_direction_error_max": angle}


NEIGHBOURS = 6
"""Samples on each side of a change of sign through which the polynomial goes. At 60 Hz and a flip of a third of a second twelve
samples place it to 1e-9 s, two to 1e-4 s."""


def crossings(times: Array, values: Array) -> list[float]:
    """Return times [s] at which `values` change sign, to the accuracy of a polynomial through the samples around."""
    roots = []
    for k in np.flatnonzero(np.signbit(values[:-1]) != np.signbit(values[1:])):
        low, high = max(0, int(k) + 1 - NEIGHBOURS), int(k) + 1 + NEIGHBOURS
        middle = float(times[k])
        curve = BarycentricInterpolator(times[low:high] - middle, values[low:high])
        roots.append(middle + float(brentq(curve, 0.0, float(times[k + 1]) - middle, xtol=1e-13)))
    return roots


@for_each("flips", Flips)
def flips(recording: Recording, scene: Scene, entry: Flips) -> Values:
    """Return flip_time_error_max [s]: largest difference of the n-th change of sign from the closed form's n-th, over all that
    the recording is long enough for. One that did not happen, or one too many, is the engine's fault."""
    own = scene.names.index(entry.body)
    body_axes = rotation.conjugate(recording.orientations[:, own])
    spin = rotation.rotate(body_axes, recording.angular_velocities[:, own])[:, entry.axis]
    # the polynomial needs its samples on both sides
    end = float(recording.times[-1]) - (NEIGHBOURS + 1) * recording.dt
    wanted = [time for time in entry.times if time < end]
    seen = [time for time in crossings(recording.times, spin) if time < end] if np.isfinite(spin).all() else []
    if len(seen) != len(wanted):
        return {"flip_time_error_max": Missing(f"{entry.body} flipped {len(seen)} times instead of {len(wanted)}", "engine")}
    early: Value = Missing("the recording ends before the first flip", "scene")
    return {"flip_time_error_max": float(np.max(np.abs(np.subtract(seen, wanted)))) if wanted else early}


@for_each("pivots", Pivot)
def pivots(recording: Recording, scene: Scene, pivot: Pivot) -> Values:
    """Return pivot_rate_error_max [rad/s]: largest difference of a leaning rod's angular speed from the one by energy at its
    angle, and pivot_missing [rad]: by how much it fell short of the angle that it is to reach."""
    angle = lean(recording, scene, pivot.body)
    speed = np.linalg.norm(recording.angular_velocities[:, scene.names.index(pivot.body)], axis=1)
    falling = angle <= pivot.until
    # once the rod is down, its motion is no matter of this closed form
    last = int(np.argmin(falling)) if not falling.all() else len(angle)
    error = float(np.max(np.abs(speed[:last] - [pivot.rate(float(a)) for a in angle[:last]])))
    return {"pivot_rate_error_max": error, "pivot_missing": max(0.0, pivot.until - float(np.max(angle)))}


@for_each("tops", Top)
def tops(recording: Recording, scene: Scene, top: Top) -> Values:
    """Return axis_spin_error_max [rad/s], the largest difference of a top's spin about its own z axis from the stated one, and
    precession_error_max [rad/s], that of the mean rate at which this axis goes round gravity."""
    axis, upright = own_axis(recording, scene, top.body), up(scene)
    spin = np.sum(recording.angular_velocities[:, scene.names.index(top.body)] * axis, axis=1)
    flat = axis - (axis @ upright)[:, None] * upright
    turned = np.arctan2(rotation.cross(flat[:-1], flat[1:]) @ upright, np.sum(flat[:-1] * flat[1:], axis=1)).sum()
    off = turned / (recording.times[-1] - recording.times[0]) - top.precession
    return {"axis_spin_error_max": float(np.abs(spin - top.spin).max()), "precession_error_max": float(abs(off))}
