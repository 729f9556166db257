"""A glance at what many scenes cost: few frames of each, but all of an everyday one; one process per engine and preset.

Whether an engine carries anything from one scene into the next shows: the hashes of its last frames are compared with those of
processes that ran one scene only.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import nan

from scenarios.job import Job
from scenarios.measure.timing import REPEATS
from scenarios.seats import Seats
from scenarios.timing import ENOUGH, MOST_FRAMES, Clocked, Turns, loaded, warm_up

MANY = 12
"""Scenes in a comparison from which on each gets a glance only, unless full lengths are asked for: measured at their own lengths
in fresh processes, a hundred scenes take a quarter of an hour."""
EACH_ROUND = 0.4
"""Time [s] that the timed frames of all engines of a scene should take together; it decides frames and repeats, the same for
all."""
LEAST, MOST = 45, 240
"""Frames timed at least and at most: with fewer, what falls would be timed in the air; more would hold up the other scenes."""
WARM_GLANCE = 10
"""Frames run untimed before a scene is timed in a process that has run others: its code and caches are warm, the buffers of this
scene are not."""
PATIENCE = 60.0
"""Longest a glance may wait for one answer [s]."""


def planned(cost: float, at_length: bool) -> tuple[int, int]:
    """Repeats and frames of a scene of which a frame of all engines together takes `cost` [s]: all of them at length; otherwise
    what fits into EACH_ROUND, at least LEAST frames once. An unknown cost counts as none."""
    if at_length:
        return REPEATS, MOST_FRAMES
    if not cost > 0.0:
        return REPEATS, MOST
    frames = min(MOST, round(EACH_ROUND / (REPEATS * cost)))
    return (REPEATS, frames) if frames > LEAST else (max(1, min(REPEATS, int(EACH_ROUND / (LEAST * cost)))), LEAST)


def glance(jobs: Sequence[Job], cost: float, seats: Seats, at_length: bool = False) -> list[Clocked]:
    """Time all `jobs` of one scene, one at a time, all over the same frames, as often as `planned` says; an engine that has taken
    ENOUGH has no further repeat. Warm-up and loading are done side by side."""
    table = [Turns(job, seats.at(job.run)) for job in jobs]
    repeats, frames = planned(cost, at_length)
    warm_up(table, WARM_GLANCE)
    for _ in range(repeats):
        again = [at for at in table if at.spent < ENOUGH]
        for turns in loaded(again, [frames] * len(again)):
            turns.turn()
    return [_without_warm_up(turns.clocked()) for turns in table]


def _without_warm_up(clocked: Clocked) -> Clocked:
    """The time of a warm-up is that of a fresh process, and here is none."""
    return clocked if clocked.timed is None else replace(clocked, timed=replace(clocked.timed, warmup=nan))
