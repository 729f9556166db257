"""A glance at what many scenes cost: few frames of each, but all of an everyday one; one process per engine and preset.

Whether an engine carries anything from one scene into the next shows: the hashes of its last frames are compared with those of
processes that ran one scene only.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import nan

from scenarios.job import Job
from scenarios.seats import Seats
from scenarios.timing import MOST_FRAMES, Clocked, Turns, loaded

MANY = 12
"""Scenes in a comparison from which on each gets a glance only, unless full lengths are asked for: measured at their own lengths
in fresh processes, a hundred scenes take a quarter of an hour."""
SLICE = 0.3
"""Time [s] that one round of all engines through a scene should take; it decides how many frames are timed, the same for all."""
LEAST, MOST = 30, 180
"""Frames timed at least and at most: with fewer, what falls would be timed in the air; more would hold up the other scenes."""
ROUNDS = 2
"""Repeats of an everyday scene, so that neither a disturbance nor buffers that grow look like a frame's own cost."""
ONCE = 300
"""Frames from which on one repeat is enough: what disturbs a few of them is lost among the others, and slow engines would take a
fifth of the whole pass for a second."""
PATIENCE = 60.0
"""Longest a glance may wait for one answer [s]."""


def glance(jobs: Sequence[Job], cost: float, seats: Seats, at_length: bool = False) -> list[Clocked]:
    """Time all `jobs` of one scene, one at a time, all over the same frames: MOST_FRAMES `at_length`, otherwise what fits into a
    SLICE if a frame of all of them takes `cost` [s], once: a median shrugs off what disturbs a frame or two, and a second
    repeat would be a second load, which takes longer than the frames. Loading is done side by side."""
    table = [Turns(job, seats.at(job.run)) for job in jobs]
    few = MOST if not cost > 0.0 else max(LEAST, min(MOST, round(SLICE / cost)))
    frames = MOST_FRAMES if at_length else few
    for _ in range(ROUNDS if at_length else 1):
        for turns in loaded(table, [frames] * len(table)):
            turns.turn()
        if any(turns.frames >= ONCE for turns in table):
            break
    return [_without_warm_up(turns.clocked()) for turns in table]


def _without_warm_up(clocked: Clocked) -> Clocked:
    """A warm-up is that of a fresh process, and here is none."""
    return clocked if clocked.timed is None else replace(clocked, timed=replace(clocked.timed, warmup=nan))
