"""All states of a recording in order of time: snapshots inside frames and the states shown."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runfiles.record import EVENTS, Integers, Recording

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Timeline:
    """T states: `frame` (T,), `time` (T,) [s], `event` (T,) code in EVENTS, poses (T, n, .) and velocities (T, n, 3); `inside`
    (S,) gives the places among them of the snapshots inside frames.

    A frame's shown state comes after everything inside that frame."""

    frame: Integers
    time: Array
    event: Integers
    inside: Integers
    positions: Array
    orientations: Array
    velocities: Array
    angular_velocities: Array


def timeline(recording: Recording, bodies: list[int]) -> Timeline:
    """Return the states of the bodies and links at places `bodies` in canonical order."""
    shown = np.arange(recording.frames + 1)
    frame = np.concatenate([recording.inside_frame, shown])
    order = np.argsort(frame, kind="stable")
    place = np.argsort(order)
    # bodies in a row are copied a state at a time
    in_a_row = bool(bodies) and bodies == list(range(bodies[0], bodies[0] + len(bodies)))
    chosen = slice(bodies[0], bodies[0] + len(bodies)) if in_a_row else bodies

    def joined(inside: Array, ends: Array) -> Array:
        whole = np.empty((len(frame), len(bodies), inside.shape[2]))
        whole[place[: len(inside)]], whole[place[len(inside) :]] = inside[:, chosen], ends[:, chosen]
        return whole

    return Timeline(
        frame=frame[order],
        time=np.concatenate([recording.inside_time, recording.times])[order],
        event=np.concatenate([recording.inside_event, np.full(len(shown), EVENTS.index("step"))])[order],
        inside=place[: len(recording.inside_frame)],
        positions=joined(recording.inside_positions, recording.positions),
        orientations=joined(recording.inside_orientations, recording.orientations),
        velocities=joined(recording.inside_velocities, recording.velocities),
        angular_velocities=joined(recording.inside_angular_velocities, recording.angular_velocities),
    )
