"""Parallel recording and serial timing of many runs; what other engines showed is kept on disk by a hash of all it depends on."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TextIO

import numpy as np

from avatarsim.running.processes import Died
from runfiles.naming import GATED
from runfiles.record import load
from scenarios.job import Job
from scenarios.measure.timing import Timed
from scenarios.posture_table import probes
from scenarios.posture_table.series import Array, Series, series_from, series_of
from scenarios.results.fingerprint import find, key_of, sources
from scenarios.results.store import Store
from scenarios.running.asked import asked
from scenarios.running.harness import tidy
from scenarios.running.processes import side_by_side
from scenarios.running.progress import Progress
from scenarios.running.run import accuracy
from scenarios.running.seat import repeat

FIGURES = (
    "residual_overlap_max", "joint_limit_excess_max", "reach_cone_excess_max", "not_finite_frames", "wrong_side_frames",
    "jerk_ratio", "tracker_offset_rms", "tracker_angle_rms",
)
"""Metrics that are taken as the run measured them; everything else is pooled from series."""
KIND = "posture"
"""Kind of the entries that are kept on disk."""


@dataclass(frozen=True, eq=False)
class Seen:
    """One run: its job; how it ended (`job.State`) and why; those of FIGURES that its scene has, nan where the engine gave none;
    its series; engine-only time of each frame [us], empty where it was not timed."""

    job: Job
    state: str
    note: str = ""
    figures: Mapping[str, float] = field(default_factory=dict)
    series: Series | None = None
    times: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def where(self) -> str:
        """Scene and, where a seed decides the motion, that."""
        return f"{self.job.scenario} --seed {self.job.seed}" if self.job.seed else self.job.scenario


def seen(job: Job, folder: Path, clips: Path | None) -> Seen:
    """Run, judge and measure one job. Its recording is not kept, and what happens inside frames is judged once: no column needs
    more."""
    probes.use(clips)
    outcome = accuracy(job, folder, judged=1)
    if outcome.state != "measured" or outcome.recording is None:
        return Seen(job, outcome.state, outcome.note)
    recording = load(outcome.recording)
    outcome.recording.unlink()
    found = {name: outcome.values[name] for name in FIGURES if name in outcome.values}
    figures = {name: value if isinstance(value, float) else math.nan for name, value in found.items()}
    return Seen(job, "measured", "", figures, series_of(recording, asked(job).known))


def timed(job: Job, repeats: int, clips: Path | None) -> list[float]:
    """Engine-only time [us] of every frame, the least of `repeats` runs, each on a load of its own."""
    probes.use(clips)
    found = [repeat(job, asked(job).scenario.frames) for _ in range(repeats)]
    # a stage that one of the repeats did not report took no time there
    silent = [0] * len(found[0][0])
    names = dict.fromkeys(name for one in found for name in one[1])
    stages = {name: np.array([one[1].get(name, silent) for one in found]) for name in names}
    best: list[float] = Timed(np.array([one[0] for one in found]), stages).best_us.tolist()
    return best


class Kept:
    """Runs of other engines in a folder, found again while scene, motion, engine and measures stay the same."""

    def __init__(self, folder: Path) -> None:
        self.store = Store(folder)
        self.here = sources([find("scenarios.posture_table.runs")])[:8]

    def key(self, job: Job) -> str:
        """Of the job and of the sources that make series of it."""
        return f"{key_of(job)}-{self.here}"

    def get(self, job: Job) -> Seen | None:
        """The run as it was, if it is there."""
        entry = self.store.get(KIND, self.key(job))
        if entry is None:
            return None
        figures = {name: float(value) for name, value in entry["figures"].items()}
        times = np.array([float(value) for value in entry["times"]])
        return Seen(job, "measured", "", figures, series_from(entry["series"]), times)

    def put(self, run: Seen) -> None:
        """Keep a run that was measured."""
        if run.series is not None:
            told = {"figures": run.figures, "times": run.times, "series": run.series.told()}
            self.store.put(KIND, self.key(run.job), told)


def recorded(jobs: Sequence[Job], folder: Path, clips: Path | None, workers: int, stream: TextIO) -> Iterator[Seen]:
    """Every job run, as many side by side as there are `workers`, in the order in which they end."""
    work = partial(seen, folder=folder, clips=clips)
    with Progress("postures", len(jobs), stream) as progress:
        for job, answer in side_by_side(work, jobs, workers, tidy):
            found = Seen(job, "crashed", str(answer)) if isinstance(answer, Died) else answer
            progress.step(f"{found.where} {job.run} {found.state}")
            yield found


def clocked(runs: Sequence[Seen], repeats: int, clips: Path | None, stream: TextIO) -> list[Seen]:
    """The same runs with times, one after the other, where nothing else of this command runs."""
    by_job = {run.job.stem: run for run in runs if run.state == "measured"}
    work = partial(timed, repeats=repeats, clips=clips)
    with Progress("times", len(by_job), stream) as progress:
        for job, answer in side_by_side(work, [run.job for run in by_job.values()], 1, tidy):
            run = by_job[job.stem]
            if isinstance(answer, Died):
                by_job[job.stem] = replace(run, note=f"not timed: {answer}")
            else:
                by_job[job.stem] = replace(run, times=np.array(answer))
            progress.step(f"{run.where} {job.run}")
    return [by_job.get(run.job.stem, run) for run in runs]


def measured(
    jobs: Sequence[Job], folder: Path, clips: Path | None, workers: int, repeats: int, kept: Kept | None, stream: TextIO,
) -> list[Seen]:
    """All jobs run and, with `repeats`, timed, in their order; those of other engines from `kept`, where they are there."""
    probes.use(clips)
    # a run that was kept without times does for a table without times only
    earlier = {} if kept is None else {
        job.stem: run for job in jobs if job.engine != GATED[0] and (run := kept.get(job)) and (run.times.size or not repeats)
    }
    fresh = list(recorded([job for job in jobs if job.stem not in earlier], folder, clips, workers, stream))
    if repeats:
        fresh = clocked(fresh, repeats, clips, stream)
    if kept is not None:
        for run in fresh:
            if run.job.engine != GATED[0]:
                kept.put(run)
    found = earlier | {run.job.stem: run for run in fresh}
    return [found[job.stem] for job in jobs]
