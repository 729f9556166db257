"""Timing pass: serial, one thread, warm, nothing recorded, the engines of a scene in turns repeat by repeat.

With many scenes each is timed quickly: engines are compared by one window of its frames that contains contact, and one process
per engine and preset serves all scenes. Hashes of the last frames are compared with those of processes that ran one scene only,
so that an engine that carries anything from scene to scene is found.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import nan

import numpy as np

from runfiles.naming import GATED
from runfiles.timing_protocol import PHASE_FRAMES, REPEATS, TAIL_FRAMES, WARM_FRAMES
from scenarios.job import Job
from scenarios.measure.timing import Round, Timed
from scenarios.run.machine import Meter, clock, load_average, reading_ns
from scenarios.run.timed_worker import Repeat, TimedWorker, TimedWorkers

MOST_FRAMES = 900
"""Timed frames: all of every everyday scene at its short length, and a quarter of a minute of a longer one. Fewer: the hand
over the table, which comes down slowly, would be timed in the air."""
ENGINE_TIME = 6.0
"""Time [s] after which an engine gets no further repeat in a quick comparison; its row has their number."""
LONGEST_REPEAT = 20.0
"""Time [s] of the frames of one repeat at length. Longer: an engine of a second a frame is timed for a quarter of an hour.
Shorter: engines next to one of 50 ms are compared in frames before the first contact alone."""
QUICK_FROM = 12
"""Scenes of a comparison from which on each is timed quickly, unless full lengths are requested: a hundred scenes at length, in
fresh processes, take a quarter of an hour."""
QUICK_TIMEOUT = 60.0
"""Longest wait [s] for one answer in quick timing."""
ROUND_TIME = 0.3
"""Time [s] of one round of all engines through the same frames of a scene; it decides the number of these."""
LEAST_FRAMES = TAIL_FRAMES // 5
"""Least window. Fewer: falling bodies would be timed in the air, and the 95th percentile of these frames could lie above the
99th of all TAIL_FRAMES of a fast engine."""
CHEAP_TIME = 0.015
"""Time [s] of one repeat up to which an engine is run REPEATS times, or over TAIL_FRAMES frames, or over the whole scene. Twice
as much: the pass takes a tenth longer; half: a fifth of avatarsim's rows lose their tail."""
BEFORE_CONTACT = 3
"""One of so many frames of the window lies before the user's first contact, as a base for the cost of contact."""
LEAD_TIME = 1.5
"""Time [s] of all engines of a scene together for untimed frames before a window at the deepest contact. All of up to 500 such
frames in six rooms would take ten seconds more; with half of it, three rooms would be timed at a first touch."""


@dataclass(frozen=True, eq=False)
class Clocked:
    """Times of one job, or the reason that there are none."""

    job: Job
    timed: Timed | None
    note: str = ""


WHOLE = Round(REPEATS, 0, MOST_FRAMES)


def at_most(cost: float) -> Round:
    """Return the timed frames at length of an engine of `cost` [s] a frame: WHOLE, or those that fit into LONGEST_REPEAT."""
    fitting = MOST_FRAMES if cost <= 0.0 else max(LEAST_FRAMES, int(LONGEST_REPEAT / cost))
    return Round(REPEATS, 0, min(MOST_FRAMES, fitting))


class TimedJob:
    """Repeats of one job so far, as its `round` plans them."""

    def __init__(self, job: Job, worker: TimedWorker, plan: Round = WHOLE) -> None:
        self.job, self.worker, self.round = job, worker, plan
        self.note, self.warmup, self.warm_frames, self.spent = "", nan, 0, 0.0
        self.repeats: list[Repeat] = []

    def answer(self) -> Repeat | None:
        """Wait for the worker. None where it has loaded, or has ended, which is noted."""
        answer = self.worker.answer()
        if isinstance(answer, str):
            self.note = answer
            return None
        self.spent += answer[0]
        return answer[1]

    @property
    def led_in(self) -> bool:
        """True if enough frames run before the window to warm it up."""
        return self.round.first >= WARM_FRAMES

    def warmed(self, fresh: bool) -> None:
        """Take the answer to the warm-up, whose time is a figure of a fresh process and none of the repeats."""
        if not self.note and (answer := self.answer()):
            self.warm_frames = len(answer[0])
        if fresh:
            self.warmup = self.spent
        self.spent = 0.0

    def turn(self, meter: Meter) -> None:
        """Run the loaded frames, while no other engine runs."""
        with meter.running():
            self.worker.start()
            repeat = self.answer()
        if repeat:
            self.repeats.append(repeat)

    def clocked(self) -> Clocked:
        """Return all repeats."""
        if not self.repeats:
            return Clocked(self.job, None, self.note or "no repeat was run")
        around = np.array([repeat[0] for repeat in self.repeats], dtype=np.int64)
        names = sorted({name for repeat in self.repeats for name in repeat[1]})
        zeros = [0] * around.shape[1]
        stages = {name: np.array([repeat[1].get(name, zeros) for repeat in self.repeats], dtype=np.int64) for name in names}
        hashes = tuple(repeat[2] for repeat in self.repeats)
        timed = Timed(around, stages, self.warmup, hashes, self.warm_frames, self.round.first)
        return Clocked(self.job, timed, self.note or timed.protocol.said)


def load(table: Sequence[TimedJob], warm: bool = False) -> list[TimedJob]:
    """Load jobs side by side, each with its own frames, or with the scene's first to get `warm`; return those ready."""
    waiting = [each for each in table if not each.note]
    for each in waiting:
        each.worker.prepare(each.job, *((WARM_FRAMES, 0) if warm else (each.round.frames, each.round.first)))
    for each in waiting:
        each.answer()
    return [each for each in waiting if not each.note]


def timed_pass(
    jobs: Sequence[Job], full: bool, plan: Sequence[Round] = (), workers: Sequence[TimedWorker] = (), meter: Meter | None = None,
) -> list[Clocked]:
    """Time all jobs of one scene. They warm up side by side, each on a load that is thrown away; then they take turns, one at a
    time, each repeat on a load of its own. A process that stays is warmed up by the frames before its window, where they suffice.

    Args:
        full: repeat slow engines as often as others.
        plan: of each job, WHOLE without.
        workers: process of each job, which stays; fresh ones without.
    """
    meter, table = meter or Meter(), list[TimedJob]()
    try:
        for k, job in enumerate(jobs):
            table.append(TimedJob(job, workers[k] if workers else TimedWorker(), plan[k] if plan else WHOLE))
        cold = [each for each in table if not workers or not each.led_in]
        for each in load(cold, warm=True):
            each.worker.start()
        for each in table:
            if each in cold:
                each.warmed(fresh=not workers)
            else:
                each.warm_frames = WARM_FRAMES
        for turn in range(max((each.round.repeats for each in table), default=0)):
            for each in load([one for one in table if turn < one.round.repeats and (full or one.spent < ENGINE_TIME)]):
                each.turn(meter)
    except BaseException:
        for each in table if not workers else ():
            each.worker.close(at_once=True)
        raise
    for each in table if not workers else ():
        each.worker.close()
    return [each.clocked() for each in table]


def quick_timing(
    jobs: Sequence[Job], costs: Sequence[float], length: int, workers: TimedWorkers, at_length: bool = False,
    meter: Meter | None = None, meets: int | None = None, swept: int = 0, depths: Sequence[float] = (),
) -> list[Clocked]:
    """Time all jobs of one scene of `length` frames, all of them `at_length`, else as `rounds` plans.

    Args:
        costs: rough time of a frame [s] of each job.
        meets: frame of the first contact of the user; None: it meets nothing.
        swept: repeats by which a sweep times all frames, 0 without one; so both have one time.
        depths: overlap of the user [m] by state, where the window is that of the deepest.
    """
    gated = [(job.engine, job.preset) == GATED for job in jobs]
    if at_length:
        plan = [WHOLE] * len(jobs)
    elif swept:
        plan = [Round(REPEATS if promised else swept, 0, MOST_FRAMES) for promised in gated]
    else:
        plan = rounds(costs, length, meets, gated, depths)
    return timed_pass(jobs, True, plan, [workers.at(job.run) for job in jobs], meter)


def rounds(
    costs: Sequence[float], length: int, meets: int | None = None, gated: Sequence[bool] = (), depths: Sequence[float] = (),
) -> list[Round]:
    """Plan the timed frames of each engine of a scene; arguments as of `quick_timing`.

    All share one window, by which they are compared: as many frames as fit into ROUND_TIME, with the first contact in it, or
    after WARM_FRAMES where the user meets nothing. With `depths` it is the deepest of the windows before which frames take no
    more than LEAD_TIME. Fast engines have TAIL_FRAMES, or the whole scene, or REPEATS besides. The `gated` engine has REPEATS of
    the whole scene, so that its slowest frame is known.
    """
    tail, whole = min(length, TAIL_FRAMES), min(length, MOST_FRAMES)
    cost = sum(costs)
    same = min(tail, max(LEAST_FRAMES, round(ROUND_TIME / cost))) if cost > 0.0 else tail
    first = max(0, min(WARM_FRAMES if meets is None else meets - same // BEFORE_CONTACT, whole - same))
    if len(depths) > whole:
        reached = round(LEAD_TIME / cost) if cost > 0.0 else whole
        first = deepest(depths[1 : whole + 1], same, min(max(first, reached), whole - same))
    plan = []
    for each, promised in zip(costs, gated or [False] * len(costs), strict=True):
        if promised:
            plan.append(Round(REPEATS, 0, whole))
            continue
        if each * whole <= CHEAP_TIME:
            begins, frames = 0, whole
        elif each * tail <= CHEAP_TIME:
            begins, frames = min(first, whole - tail), tail
        else:
            begins, frames = first, same
        plan.append(Round(1 if each * frames > CHEAP_TIME else REPEATS, begins, frames))
    return plan


def deepest(depths: Sequence[float], frames: int, last: int) -> int:
    """Return the first frame, at most `last`, of the window of so many frames with the largest mean depth; NaN counts as 0."""
    sums = np.concatenate([[0.0], np.cumsum(np.nan_to_num(np.asarray(depths[: last + frames], dtype=np.float64)))])
    return int(np.argmax(sums[frames:] - sums[:-frames]))


def timing_facts(meter: Meter) -> dict[str, object]:
    """Return the protocol at its fullest and the state of the machine, for the provenance of times."""
    others = None if meter.others is None else round(meter.others, 3)
    return {
        "repeats": REPEATS, "warm_frames": WARM_FRAMES, "tail_frames": TAIL_FRAMES, "phase_frames": PHASE_FRAMES,
        "load_after": load_average(), "busy_elsewhere": others, "reading_ns": reading_ns(), **clock(),
    }


def compared(clocked: Sequence[Clocked]) -> list[Clocked]:
    """Return the engines of one scene with the repeats and frames that all of them had, by which they are compared."""
    every = [clocked.timed for clocked in clocked if clocked.timed is not None]
    if not every:
        return list(clocked)
    repeats = min(timed.around_ns.shape[0] for timed in every)
    first, last = max(timed.first for timed in every), min(timed.first + timed.around_ns.shape[1] for timed in every)
    shared = Round(repeats, first, max(0, last - first))
    return [each if each.timed is None else replace(each, timed=replace(each.timed, shared=shared)) for each in clocked]
