"""Rows of bodies that topple one another: the speed of the wave, and the number of bodies that it reaches."""

import numpy as np

from avatarsim.scene.scene import Scene
from runfiles.record import Array, Recording
from scenarios.building.expected import Wave
from scenarios.measure.bodies.axes import lean
from scenarios.measure.expecting import for_each
from scenarios.measure.value import Values

TOPPLED = np.radians(30.0)
"""Lean [rad] beyond which a body counts as toppled: more than one that is pushed and rises again, less than one that lies on
the next."""


@for_each("waves", Wave)
def waves(recording: Recording, scene: Scene, wave: Wave) -> Values:
    """Return wave_speed_error [%] and wave_missing [bodies].

    wave_speed_error: difference of the speed of the front, from body `first` to body `last`, from the stated one. A wave that
    does not get there has the speed of its way by the end of the recording. wave_missing: bodies that never toppled.
    """
    times = np.array([_toppled(recording, scene, name) for name in wave.bodies])
    error = 100.0 * abs(_speed(wave, times, float(recording.times[-1])) / wave.speed - 1.0)
    return {"wave_speed_error": error, "wave_missing": float(np.isnan(times).sum())}


def _toppled(recording: Recording, scene: Scene, name: str) -> float:
    """Return time [s] at which a body's own z axis leans beyond TOPPLED, between the states shown; nan where it never does."""
    angle = lean(recording, scene, name)
    beyond = np.flatnonzero(angle > TOPPLED)
    if not len(beyond):
        return float("nan")
    k = int(beyond[0])
    return float(recording.times[0] if k == 0 else np.interp(TOPPLED, angle[k - 1 : k + 1], recording.times[k - 1 : k + 1]))


def _speed(wave: Wave, times: Array, end: float) -> float:
    """Return speed of the front [m/s] from body `first` to body `last`, or to the farthest before it that the wave has reached; 0
    if it has not reached the first."""
    reached = np.flatnonzero(~np.isnan(times[: wave.last + 1]))
    farthest = int(reached[-1]) if len(reached) else 0
    if np.isnan(times[wave.first]) or farthest <= wave.first:
        return 0.0
    until = times[wave.last] if farthest == wave.last else end
    return float(wave.pitch * (farthest - wave.first) / (until - times[wave.first]))
