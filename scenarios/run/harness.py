"""One run of the harness: both passes over its jobs, and files that are kept up to date."""

import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from avatarsim.errors import AvatarsimError, MissingPackage, described
from avatarsim.running.cluster import lost_worker_message
from avatarsim.running.processes import Died, Workers
from runfiles.engines import FILE, about
from runfiles.naming import BASELINE, UNSEEN_PREFIX
from runfiles.table import Row
from scenarios.engines import opened
from scenarios.job import Job, Outcome, reuses_process
from scenarios.measure.overlap import SEEN
from scenarios.measure.timing import frame_times, time_notes
from scenarios.run import results, timing
from scenarios.run.accuracy import accuracy
from scenarios.run.gate import Ceilings, bounds_of, exit_code, rows_of
from scenarios.run.machine import Meter, load_average
from scenarios.run.processes import side_by_side
from scenarios.run.progress import Progress
from scenarios.run.results import Results
from scenarios.run.sweep_scenes import repeats_of, short_errors_of
from scenarios.run.timed_worker import TimedWorkers
from scenarios.run.timing import QUICK_FROM, QUICK_TIMEOUT, Clocked, at_most, compared, quick_timing, timed_pass, timing_facts
from scenarios.scenario import Scenario

SAVE_INTERVAL = 3.0
"""Least time [s] between two writings of the results so far. Writing them after each of hundreds of jobs takes longer than the
jobs; a kill loses nothing that is not in the recordings."""
SAVE_SHARE = 0.02
"""Largest share of a run that is spent on writing."""


@dataclass(frozen=True)
class Offer:
    """Presets of an engine, the default first, and the reason where it does not open."""

    presets: tuple[str, ...] = ()
    trouble: str = ""
    crashed: bool = False


def offer(name: str) -> Offer:
    """Open an engine to read its presets."""
    try:
        return Offer(tuple(opened(name).presets))
    except MissingPackage as error:
        one = about(name)
        hint = one.when_missing if error.package in one.packages else ""
        presets = tuple(sorted(one.presets, key=lambda preset: preset != "default"))
        return Offer(presets, f"{name} is not installed: {hint}" if hint else str(error))
    except AvatarsimError as error:
        return Offer(trouble=str(error))
    except Exception as error:
        return Offer(trouble=described(error), crashed=True)


def offers(names: Sequence[str], workers: int) -> dict[str, Offer]:
    """Open engines, each in a process of its own: importing one may print, leak or crash. Raises InvalidFile."""
    for name in names:
        # a malformed file of facts ends a command before anything has run
        if about(name).path is None:
            print(f"{name} has no {FILE}: its name is its label, and no unsupported features are known", file=sys.stderr)
    by_name = {}
    for name, answer in side_by_side(offer, names, workers):
        by_name[name] = Offer(trouble=str(answer), crashed=True) if isinstance(answer, Died) else answer
    return {name: by_name[name] for name in names}


def outcomes(jobs: Sequence[Job], folder: Path, workers: Workers) -> Iterator[Outcome]:
    """Yield the outcome of each job, run in a process of its own or of an engine that reuses it; with 0 workers here."""
    for job, answer in side_by_side(partial(accuracy, folder=folder), jobs, workers, reuses_process):
        yield Outcome(job, "crashed", str(answer)) if isinstance(answer, Died) else answer


def lapse_note(outcome: Outcome) -> str:
    """Return a sentence on the promises that a scene's author gave up by leaving effects out, "" without any."""
    lapsed = outcome.about.get("lapsed")
    if not lapsed or not isinstance(lapsed, Mapping):
        return ""
    without = ", ".join(f"{effect} (promise {promise})" for effect, promise in lapsed.items())
    return f"{outcome.job.scenario} is not gated, since its author left out {without}"


def is_timed(job: Job) -> bool:
    """Return whether the frames of a job are timed."""
    variant = about(job.engine).variants.get(job.preset)
    return job.engine != BASELINE and not (variant and variant.metrics)


class Run:
    """Outcomes and times of one run; turns them into rows, and keeps the files in its folder up to date.

    Args:
        stays: results in the folder are of a run that has ended, and stay until this one has.
    """

    def __init__(
        self, folder: Path, scenarios: Mapping[str, Scenario], jobs: Iterable[Job], gated: frozenset[tuple[str, str]],
        limits: Ceilings, provenance: Mapping[str, object], stays: bool = False,
    ) -> None:
        self.folder, self.scenarios, self.jobs, self.gated = folder, scenarios, list(jobs), gated
        self.limits, self.provenance, self.begun = limits, dict(provenance), time.monotonic()
        self.outcomes: dict[str, Outcome] = {}
        self.clocked: dict[str, Clocked] = {}
        self.judged: dict[str, tuple[Outcome, Clocked | None, list[Row]]] = {}
        self.lost: Sequence[str] = ()
        self.note, self.written, self.writing, self.stays = "", self.begun, 0.0, stays

    def measure(self, ready: Sequence[Outcome], workers: Workers) -> None:
        """Run the accuracy pass; `ready` are outcomes of engines that did not open."""
        for outcome in ready:
            self.outcomes[outcome.job.stem] = outcome
        runnable = [job for job in self.jobs if job.stem not in self.outcomes]
        if not isinstance(workers, int):
            self.lost = workers.lost
        with Progress("accuracy", len(runnable), sys.stderr) as progress:
            for outcome in outcomes(runnable, self.folder, workers):
                self.outcomes[outcome.job.stem] = outcome
                progress.step(f"{outcome.job.scenario} {outcome.job.run} {outcome.state}")
                self._save()

    def clock(self, full: bool, at_length: bool = False) -> None:
        """Run the timing pass over measured jobs, scene by scene; many scenes are timed quickly unless `at_length`.

        The raw tracker is left out: it computes nothing. So are variants that replace a preset in some metrics only.
        """
        timed = [job for job, outcome in self._known() if outcome.state == "measured" and is_timed(job)]
        names, seeds = list(dict.fromkeys(job.scenario for job in timed)), sorted({job.seed for job in timed})
        at_length = full or at_length or len(names) < QUICK_FROM
        meter, begun, before = Meter(), time.monotonic(), load_average()
        with Progress("timing", len(timed), sys.stderr) as progress, TimedWorkers(QUICK_TIMEOUT) as workers:
            for scene, seed in ((scene, seed) for scene in names for seed in seeds):
                chosen = [job for job in timed if (job.scenario, job.seed) == (scene, seed)]
                rounds = [at_most(self.outcomes[job.stem].frame_seconds) for job in chosen]
                results = timed_pass(chosen, full, rounds, meter=meter) if at_length else self._quickly(chosen, workers, meter)
                for clocked in compared(results):
                    self.clocked[clocked.job.stem] = clocked
                    progress.step(f"{scene} {clocked.job.run}")
                spent = round(time.monotonic() - begun, 1)
                self.provenance["timing"] = {"seconds": spent, "load_before": before, **timing_facts(meter)}
                self._save()

    def _quickly(self, jobs: Sequence[Job], workers: TimedWorkers, meter: Meter) -> list[Clocked]:
        """Time the jobs of one scene quickly, by the results of the accuracy pass."""
        if not jobs:
            return []
        name, ran = jobs[0].scenario, [self.outcomes[job.stem] for job in jobs]
        scenario, length = self.scenarios[name], max(outcome.frames for outcome in ran)
        swept = repeats_of(min(length, timing.MOST_FRAMES)) if short_errors_of(name, scenario) else 0
        # overlap of the user, by the raw tracker
        raw = self.outcomes.get(replace(jobs[0], engine=BASELINE, preset="default").stem)
        depths = raw.overlap_m if raw else ()
        meets = next((k for k, depth in enumerate(depths) if depth > SEEN), None)
        costs = [outcome.frame_seconds for outcome in ran]
        deep = depths if name.startswith(UNSEEN_PREFIX) else ()
        return quick_timing(jobs, costs, length, workers, scenario.everyday, meter, meets, swept, deep)

    def _known(self) -> list[tuple[Job, Outcome]]:
        return [(job, self.outcomes[job.stem]) for job in self.jobs if job.stem in self.outcomes]

    def rows(self) -> list[Row]:
        """Return all rows so far, in the order of the plan; a job is judged again only when it has been timed since."""
        rows: list[Row] = []
        for job, outcome in self._known():
            clocked, judged = self.clocked.get(job.stem), self.judged.get(job.stem)
            if judged is None or judged[0] is not outcome or judged[1] is not clocked:
                judged = self.judged[job.stem] = outcome, clocked, self._rows_of(job, outcome, clocked)
            rows += judged[2]
        return rows

    def _rows_of(self, job: Job, outcome: Outcome, clocked: Clocked | None) -> list[Row]:
        scenario = self.scenarios[job.scenario]
        if clocked and clocked.timed:
            times = frame_times(clocked.timed, outcome.hashes, outcome.resting)
            notes = {**outcome.notes, **time_notes(clocked.timed, times, outcome.resting)}
            if clocked.note != clocked.timed.protocol.said:
                # it ended after a while
                notes["frame_time_p50"] += f"; {clocked.note}"
            outcome = replace(outcome, values={**outcome.values, **times}, notes=notes)
        gated = (job.engine, job.preset) in self.gated
        if gated and (note := lapse_note(outcome)):
            gated, notes = False, dict.fromkeys(bounds_of(scenario), note)
            outcome = replace(outcome, notes={**outcome.notes, **notes})
        rows = rows_of(outcome, scenario, self.limits.get(job.scenario, {}), gated)
        if clocked and not clocked.timed:
            rows.append(replace(rows[0], metric="frame_time_p50", value=None, unit="us", bound=None, ceiling=None,
                                status="crashed", note=clocked.note))
        return rows

    def series(self) -> dict[str, dict[str, dict[str, Sequence[float | None]]]]:
        """Return numbers per frame: overlap [m] of every state, time [us] of every frame that all engines of the scene had."""
        series: dict[str, dict[str, dict[str, Sequence[float | None]]]] = {}
        for job, outcome in self._known():
            if outcome.state != "measured" or job.run in series.get(job.scenario, {}):
                # with several seeds the pages show the first
                continue
            clocked = self.clocked.get(job.stem)
            times: list[float | None] = []
            if clocked and clocked.timed:
                times = [None] * clocked.timed.compared.first + clocked.timed.compared_us.tolist()
            series.setdefault(job.scenario, {})[job.run] = {"overlap_m": outcome.overlap_m, "frame_time_us": times}
        return series

    def _save(self) -> None:
        """Write the results so far, unless that was done a moment ago."""
        if time.monotonic() - self.written > max(SAVE_INTERVAL, self.writing / SAVE_SHARE):
            self.write(None)

    def write(self, code: int | None) -> None:
        """Write the results; `code` is None while the run goes on, so that a killed run is known as unfinished."""
        begun = time.monotonic()
        scenes: dict[str, Mapping[str, str | bool | float]] = {
            name: {"title": s.title, "judged": s.judged, "everyday": s.everyday, "family": s.family or name, "dt": s.dt,
                   "scale": s.scale, "frames": s.frames}
            for name, s in self.scenarios.items()
        }
        if code is not None or not self.stays:
            results.write(Results(
                rows=self.rows(), outcomes=[outcome for _, outcome in self._known()], series=self.series(), scenes=scenes,
                provenance={**self.provenance, "seconds": round(begun - self.begun, 1)}, exit_code=code,
                notes=[note for note in (self.note, *self.notes()) if note],
            ), self.folder)
        self.written = time.monotonic()
        self.writing = self.written - begun

    def notes(self) -> list[str]:
        """Return sentences that a run ends with: promises that authors gave up, and workers of a cluster that were lost."""
        gated = [lapse_note(outcome) for job, outcome in self._known() if (job.engine, job.preset) in self.gated]
        return [*dict.fromkeys(filter(None, gated)), *map(lost_worker_message, self.lost)]

    def code(self) -> int:
        """Return the exit code of all rows so far."""
        return exit_code(self.rows())
