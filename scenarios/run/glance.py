"""How much of each scene is timed when there are many: all of an everyday one, of others what an engine's speed allows.

What all engines of a scene are compared by is a window of its frames that contains contact: where the user meets something only
after what there is time for, timing begins a little before that, and the frames before it run without being timed. Of a motion
that is drawn anew it is the window in which the user is deepest inside something, so far as LEAD reaches: nothing says that its
first contact is what it is about.

One process per engine and preset serves all scenes. Whether an engine carries anything from one scene into the next shows: the
hashes of its last frames are compared with those of processes that ran one scene only.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from runfiles.naming import GATED
from runfiles.timing_protocol import REPEATS, TAIL_FRAMES
from scenarios.job import Job
from scenarios.run.machine import Meter
from scenarios.run.timed_worker import Seats
from scenarios.run.timing import MOST_FRAMES, Clocked, timed_pass

MANY = 12
"""Scenes in a comparison from which on each gets a glance only, unless full lengths are asked for: measured at their own lengths
in fresh processes, a hundred scenes take a quarter of an hour."""
SLICE = 0.3
"""Time [s] that one round of all engines through the same frames of a scene should take; it decides how many these are."""
LEAST = TAIL_FRAMES // 5
"""Frames timed at least. With fewer, what falls would be timed in the air, and the 95th percentile of these frames could lie
above the 99th of all TAIL_FRAMES that a fast engine runs."""
CHEAP = 0.015
"""Time [s] that one repeat of an engine may take so that it is run REPEATS times, or over TAIL_FRAMES frames, or over the whole
scene. With twice as much the pass takes a tenth longer; with half of it, a fifth of our own rows lose their tail."""
BEFORE = 3
"""One of so many frames of the window lies before the user's first contact: what contact adds shows beside what it adds to. With
one of twenty there would be none to compare with, with one of two half the time is spent in the air."""
LEAD = 1.5
"""Time [s] of all engines of a scene together for frames that run before such a window and are not timed. With all that there
are, up to 500, six rooms would take ten seconds more of a comparison's five minutes; with half of it, three of them would be
timed at a first touch."""
PATIENCE = 60.0
"""Longest a glance may wait for one answer [s]."""


def glance(
    jobs: Sequence[Job], costs: Sequence[float], length: int, seats: Seats, at_length: bool = False, meter: Meter | None = None,
    meets: int = 0, swept: int = 0, depths: Sequence[float] = (),
) -> list[Clocked]:
    """Time all `jobs` of one scene of `length` frames, as `rounds` says for what a frame of each `costs` [s], for the frame in
    which the user `meets` something, and for how deep the user is in something where that decides (`depths`); of an everyday
    scene all, `at_length`; of one that a sweep times all too, as often as it does (`swept` times, 0: no sweep does), so that both
    find one time. Loading is done side by side."""
    gated = [(job.engine, job.preset) == GATED for job in jobs]
    if at_length:
        plan = [Round(REPEATS, 0, MOST_FRAMES)] * len(jobs)
    elif swept:
        plan = [Round(REPEATS if promised else swept, 0, MOST_FRAMES) for promised in gated]
    else:
        plan = rounds(costs, length, meets, gated, depths)
    return timed_pass(
        jobs, True, frames=[each.frames for each in plan], repeats=[each.repeats for each in plan],
        seats=[seats.at(job.run) for job in jobs], meter=meter, firsts=[each.first for each in plan],
    )


class Round(NamedTuple):
    """So many repeats of so many frames from frame `first` on."""

    repeats: int
    first: int
    frames: int


def rounds(
    costs: Sequence[float], length: int, meets: int = 0, gated: Sequence[bool] = (), depths: Sequence[float] = (),
) -> list[Round]:
    """What is timed of each engine of a scene. All have the same window, by which they are compared: what fits into a SLICE, with
    the frame in which the user `meets` something in it, or where the user is deepest in something, by `depths` [m] of all states
    (none: the former), of the windows that begin no later than that or before which frames take no more than LEAD. Those of which
    TAIL_FRAMES take little have that many, those of which the whole scene takes little have all of it, and those of which a
    repeat takes little have REPEATS. The `gated` engine has REPEATS of the whole scene, since its slowest frame is to be the
    slowest of all: that takes it two seconds in a hundred scenes."""
    tail, whole = min(length, TAIL_FRAMES), min(length, MOST_FRAMES)
    cost = sum(costs)
    same = min(tail, max(LEAST, round(SLICE / cost))) if cost > 0.0 else tail
    first = max(0, min(meets - same // BEFORE, whole - same))
    if len(depths) > whole:
        reached = round(LEAD / cost) if cost > 0.0 else whole
        first = deepest(depths[1 : whole + 1], same, min(max(first, reached), whole - same))
    plan = []
    for each, promised in zip(costs, gated or [False] * len(costs), strict=True):
        if promised:
            plan.append(Round(REPEATS, 0, whole))
            continue
        if each * whole <= CHEAP:
            begins, frames = 0, whole
        elif each * tail <= CHEAP:
            begins, frames = min(first, whole - tail), tail
        else:
            begins, frames = first, same
        plan.append(Round(1 if each * frames > CHEAP else REPEATS, begins, frames))
    return plan


def deepest(depths: Sequence[float], frames: int, last: int) -> int:
    """The first frame of the window of so many `frames`, beginning at frame `last` at the latest, over which the `depths` [m] by
    frame are largest on the mean: the earliest of equals. What is no number counts as 0."""
    whole = np.concatenate([[0.0], np.cumsum(np.nan_to_num(np.asarray(depths[: last + frames], dtype=np.float64)))])
    return int(np.argmax(whole[frames:] - whole[:-frames]))
