"""How much of each scene is timed when there are many: all of an everyday one, of others what an engine's speed allows.

One process per engine and preset serves all scenes. Whether an engine carries anything from one scene into the next shows: the
hashes of its last frames are compared with those of processes that ran one scene only.
"""

from collections.abc import Sequence

from scenarios.job import Job
from scenarios.machine import Meter
from scenarios.measure.protocol import REPEATS, TAIL_FRAMES
from scenarios.seats import Seats
from scenarios.timing import MOST_FRAMES, Clocked, timed_pass

MANY = 12
"""Scenes in a comparison from which on each gets a glance only, unless full lengths are asked for: measured at their own lengths
in fresh processes, a hundred scenes take a quarter of an hour."""
SLICE = 0.3
"""Time [s] that one round of all engines through the same frames of a scene should take; it decides how many these are."""
LEAST = TAIL_FRAMES // 5
"""Frames timed at least. With fewer, what falls would be timed in the air, and the 95th percentile of these frames could lie
above the 99th of all TAIL_FRAMES that a fast engine runs."""
CHEAP = 0.015
"""Time [s] that one repeat of an engine may take so that it is run REPEATS times, or over TAIL_FRAMES frames. With twice as much
the pass takes a tenth longer; with half of it, a fifth of our own rows lose their tail."""
PATIENCE = 60.0
"""Longest a glance may wait for one answer [s]."""


def glance(
    jobs: Sequence[Job], costs: Sequence[float], length: int, seats: Seats, at_length: bool = False, meter: Meter | None = None,
) -> list[Clocked]:
    """Time all `jobs` of one scene of `length` frames, as often and over as many frames as `rounds` says for what a frame of each
    `costs` [s]; of an everyday scene all, `at_length`. Loading is done side by side."""
    plan = [(REPEATS, MOST_FRAMES)] * len(jobs) if at_length else rounds(costs, length)
    return timed_pass(
        jobs, True, frames=[frames for _, frames in plan], repeats=[repeats for repeats, _ in plan],
        seats=[seats.at(job.run) for job in jobs], meter=meter,
    )


def rounds(costs: Sequence[float], length: int) -> list[tuple[int, int]]:
    """(repeats, frames) of each engine of a scene. All have the same first frames, by which they are compared: what fits into a
    SLICE. Those of which TAIL_FRAMES take little go on to that many, and those of which a repeat takes little have REPEATS."""
    whole = min(length, TAIL_FRAMES)
    cost = sum(costs)
    same = min(whole, max(LEAST, round(SLICE / cost))) if cost > 0.0 else whole
    plan = []
    for each in costs:
        frames = same if each * whole > CHEAP else whole
        plan.append((1 if each * frames > CHEAP else REPEATS, frames))
    return plan
