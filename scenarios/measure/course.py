"""Bodies against their closed-form course: position, velocity and spin of every state shown."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from scenarios.expected import Course, OfTime
from scenarios.measure.expecting import expected
from scenarios.measure.value import Missing, Value, Values
from scenarios.record import Recording
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
