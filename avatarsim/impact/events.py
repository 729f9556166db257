"""Recorded events of a frame: the state of all bodies right before and right after each impact."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Cube, IndexGrid, IndexLine, Line, Stack
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row

Array = NDArray[np.float64]
Index = NDArray[np.int64]

APPROACH, IMPACT = 0, 1
"""Kind of an event: right before, and right after, at the same time."""


class Events(NamedTuple):
    """Events k < min(kept[0], cap) in order: time (cap) since the frame began at which the surfaces meet [s], kind, the pair
    whose impact it is (cap, 2); position (cap, nb, 3), rotation (cap, nb, 3, 3), linear, angular velocity (cap, nb, 3) of all.

    Poses are those at which the impact is resolved, with the stand-off still open. It takes the time gap / speed to close, so the
    last impact of a frame may be a few nanoseconds past its end, and slow impacts may overtake fast ones of other pairs."""

    kept: IndexLine
    time: Line
    kind: IndexLine
    pair: IndexGrid
    position: Cube
    rotation: Stack
    linear: Cube
    angular: Cube


def make_events(bodies: int, cap: int = 64) -> Events:
    """Allocate room for ``cap`` events (two per impact) of so many bodies; cap 0 if nothing is recorded."""
    return Events(
        np.zeros(1, np.int64), np.zeros(cap), np.zeros(cap, np.int64), np.zeros((cap, 2), np.int64), np.zeros((cap, bodies, 3)),
        np.zeros((cap, bodies, 3, 3)), np.zeros((cap, bodies, 3)), np.zeros((cap, bodies, 3)),
    )


@kernel
def record(
    events: Events, kind: int, time: float, a: int, b: int, position: Array, rotation: Array, linear: Array, angular: Array
) -> None:
    """Append one event; the count goes on when there is no room, so that the loss shows."""
    k = events.kept[0]
    events.kept[0] = k + 1
    if k >= events.time.shape[0]:
        return
    events.time[k], events.kind[k] = time, kind
    events.pair[k, 0], events.pair[k, 1] = a, b
    for body in range(position.shape[0]):
        put_row(events.position[k], body, row(position, body))
        put_columns(events.rotation[k], body, columns(rotation, body))
        put_row(events.linear[k], body, row(linear, body))
        put_row(events.angular[k], body, row(angular, body))
