"""One run of the harness: plan the jobs, run both passes, and every few seconds write down all that is known so far."""

import sys
import time
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from avatarsim.errors import AvatarsimError, InvalidInput, MissingPackage, UnknownName, described
from avatarsim.running.cluster import lost_said
from avatarsim.running.processes import Died, Workers
from runfiles.engines import about
from runfiles.naming import BASELINE, UNSEEN_PREFIX
from runfiles.table import Row
from scenarios.engines import opened
from scenarios.job import Job, Outcome, reuses_process
from scenarios.measure.overlap import SEEN
from scenarios.measure.timing import frame_times, time_notes
from scenarios.run import results
from scenarios.run.accuracy import accuracy
from scenarios.run.effects_said import lapse_said
from scenarios.run.gate import Ceilings, bounds_of, exit_code, rows_of
from scenarios.run.machine import Meter, load_average
from scenarios.run.processes import side_by_side
from scenarios.run.progress import Progress
from scenarios.run.results import Results
from scenarios.run.sweep_scenes import repeats_of, short_errors_of
from scenarios.run.timed_worker import TimedWorkers
from scenarios.run.timing import (
    MOST_FRAMES,
    QUICK_FROM,
    QUICK_TIMEOUT,
    Clocked,
    compared,
    quick_timing,
    timed_pass,
    timing_facts,
)
from scenarios.scenario import Scenario

OFTEN = 3.0
"""Least time [s] between two writings of what is known while runs go on. Each holds everything so far, so writing after every one
of hundreds of runs takes longer than the runs; what a kill loses is in the recordings."""
SELDOM = 50.0
"""The same in multiples of what the last writing took: at most a fiftieth of a run is spent on writing."""


@dataclass(frozen=True)
class Offer:
    """What one engine offers: its presets, the default first; or why it cannot be opened, with the presets known all the same."""

    presets: tuple[str, ...] = ()
    trouble: str = ""
    crashed: bool = False

    def chosen(self, asked: Collection[str]) -> tuple[str, ...]:
        """The presets to run where `asked` names some; all where it names none."""
        return tuple(preset for preset in self.presets if preset in asked) if asked else self.presets


def offer(name: str) -> Offer:
    """Open engine `name` only to ask for its presets."""
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
    """What each engine offers, asked in processes of their own: importing an engine may print, leak or crash."""
    for name in names:
        # a malformed file of facts ends a command before anything has run
        about(name)
    found = {}
    for name, answer in side_by_side(offer, names, workers):
        found[name] = Offer(trouble=str(answer), crashed=True) if isinstance(answer, Died) else answer
    return {name: found[name] for name in names}


def named_runs(option: str, words: Sequence[str]) -> list[tuple[str, str]]:
    """Return the runs that `option` names as ENGINE/PRESET. Raises InvalidInput for an engine that does not open, UnknownName for
    a preset that there is not."""
    runs = [(engine, preset) for engine, _, preset in (word.partition("/") for word in words)]
    # in processes of their own: what another engine prints or leaves on import stays there
    found = offers(list(dict.fromkeys(engine for engine, _ in runs)), 1)
    for (engine, preset), word in zip(runs, words, strict=True):
        offered = (*found[engine].presets, *about(engine).variants)
        if found[engine].trouble:
            raise InvalidInput(option, word, f"an engine that can be opened ({found[engine].trouble})")
        if preset not in offered:
            raise UnknownName(f"preset of engine {engine}", preset, offered)
    return runs


def outcomes(jobs: Sequence[Job], folder: Path, workers: Workers) -> Iterator[Outcome]:
    """The accuracy pass over `jobs`: each in a process of its own, but for engines that are tidy; with 0 workers here, one after
    the other."""
    for job, answer in side_by_side(partial(accuracy, folder=folder), jobs, workers, reuses_process):
        yield Outcome(job, "crashed", str(answer)) if isinstance(answer, Died) else answer


def lapsed(outcome: Outcome) -> str:
    """What the author of the scene gave up, in a sentence; empty if nothing."""
    found = outcome.about.get("lapsed")
    return lapse_said(outcome.job.scenario, found) if isinstance(found, Mapping) else ""


class Run:
    """Collects outcomes and times, turns them into rows, and keeps the run folder's files up to date."""

    def __init__(
        self, folder: Path, scenarios: Mapping[str, Scenario], jobs: Iterable[Job], gated: frozenset[tuple[str, str]],
        limits: Ceilings, provenance: Mapping[str, object], stays: bool = False,
    ) -> None:
        """`stays`: results that lie in the folder are those of a whole run, and stay until this one has ended."""
        self.folder, self.scenarios, self.jobs, self.gated = folder, scenarios, list(jobs), gated
        self.limits, self.provenance, self.begun = limits, dict(provenance), time.monotonic()
        self.outcomes: dict[str, Outcome] = {}
        self.clocked: dict[str, Clocked] = {}
        self.lost: Sequence[str] = ()
        self.note, self.written, self.writing, self.stays = "", self.begun, 0.0, stays

    def measure(self, ready: Sequence[Outcome], workers: Workers) -> None:
        """The accuracy pass; `ready` are outcomes of engines that could not even be opened."""
        for outcome in ready:
            self.outcomes[outcome.job.stem] = outcome
        runnable = [job for job in self.jobs if job.stem not in self.outcomes]
        if not isinstance(workers, int):
            self.lost = workers.lost
        with Progress("accuracy", len(runnable), sys.stderr) as progress:
            for outcome in outcomes(runnable, self.folder, workers):
                self.outcomes[outcome.job.stem] = outcome
                progress.step(f"{outcome.job.scenario} {outcome.job.run} {outcome.state}")
                self.write_now_and_then()

    def clock(self, full: bool, at_length: bool = False) -> None:
        """The timing pass over everything that ran through, scene by scene, many of them at a glance unless `at_length`. The raw
        tracker is left out: it computes nothing."""
        ran = [job for job in self.jobs if job.stem in self.outcomes and self.outcomes[job.stem].state == "measured"]
        sound = [job for job in ran if job.engine != BASELINE]
        seeds = {job.seed for job in sound}
        meter, begun, before = Meter(), time.monotonic(), load_average()
        with Progress("timing", len(sound), sys.stderr) as progress, TimedWorkers(QUICK_TIMEOUT) as workers:
            names = list(dict.fromkeys(job.scenario for job in sound))
            few = full or at_length or len(names) < QUICK_FROM
            for scene in names:
                for seed in sorted(seeds):
                    chosen = [job for job in sound if (job.scenario, job.seed) == (scene, seed)]
                    for clocked in compared(self._timed(chosen, workers, full, few, meter)):
                        self.clocked[clocked.job.stem] = clocked
                        progress.step(f"{scene} {clocked.job.run}")
                    spent = round(time.monotonic() - begun, 1)
                    self.provenance["timing"] = {"seconds": spent, "load_before": before, **timing_facts(meter)}
                    self.write_now_and_then()

    def _timed(self, jobs: Sequence[Job], workers: TimedWorkers, full: bool, few: bool, meter: Meter) -> list[Clocked]:
        """The timing pass over one scene: at length where there are few of them, otherwise a glance."""
        if few or not jobs:
            return timed_pass(jobs, full, meter=meter)
        ran = [self.outcomes[job.stem] for job in jobs]
        costs, length = [outcome.frame_seconds for outcome in ran], max((outcome.frames for outcome in ran), default=0)
        at_length = any(self.scenarios[job.scenario].everyday for job in jobs)
        swept = any(short_errors_of(job.scenario, self.scenarios[job.scenario]) for job in jobs)
        often = repeats_of(min(length, MOST_FRAMES)) if swept else 0
        depths = self._depths(jobs[0])
        meets = next((k for k, depth in enumerate(depths) if depth > SEEN), 0)
        deep = depths if jobs[0].scenario.startswith(UNSEEN_PREFIX) else ()
        return quick_timing(jobs, costs, length, workers, at_length, meter, meets, often, deep)

    def _depths(self, job: Job) -> Sequence[float]:
        """How deep [m] the user of a scene is in something in each state, by the raw tracker's own overlaps; empty without."""
        raw = self.outcomes.get(replace(job, engine=BASELINE, preset="default").stem)
        return raw.overlap_m if raw else ()

    def _known(self) -> list[tuple[Job, Outcome]]:
        return [(job, self.outcomes[job.stem]) for job in self.jobs if job.stem in self.outcomes]

    def rows(self) -> list[Row]:
        """All rows known so far, in the order of the plan."""
        found: list[Row] = []
        for job, outcome in self._known():
            clocked = self.clocked.get(job.stem)
            if clocked and clocked.timed:
                times = frame_times(clocked.timed, outcome.hashes, outcome.resting)
                notes = {**outcome.notes, **time_notes(clocked.timed, times, outcome.resting)}
                if clocked.note != clocked.timed.protocol.said:
                    # it went on for a while, and then not
                    notes["frame_time_p50"] += f"; {clocked.note}"
                outcome = replace(outcome, values={**outcome.values, **times}, notes=notes)
            limits = self.limits.get(job.scenario, {})
            gated = (job.engine, job.preset) in self.gated
            if gated and (said := lapsed(outcome)):
                gated, bounded = False, bounds_of(self.scenarios[job.scenario])
                outcome = replace(outcome, notes={**outcome.notes, **dict.fromkeys(bounded, said)})
            rows = rows_of(outcome, self.scenarios[job.scenario], limits, gated)
            if clocked and not clocked.timed:
                rows.append(replace(rows[0], metric="frame_time_p50", value=None, unit="us", bound=None, ceiling=None,
                                    status="crashed", note=clocked.note))
            found += rows
        return found

    def series(self) -> dict[str, dict[str, dict[str, Sequence[float | None]]]]:
        """Numbers per frame for the pages: overlap [m] of every state shown, frame time [us] of every frame that all engines of
        the scene were timed over."""
        found: dict[str, dict[str, dict[str, Sequence[float | None]]]] = {}
        for job in self.jobs:
            outcome, clocked = self.outcomes.get(job.stem), self.clocked.get(job.stem)
            if outcome is None or outcome.state != "measured" or job.run in found.get(job.scenario, {}):
                # with several seeds the pages show the first
                continue
            times: list[float | None] = []
            if clocked and clocked.timed:
                times = [None] * clocked.timed.compared.first + clocked.timed.compared_us.tolist()
            found.setdefault(job.scenario, {})[job.run] = {"overlap_m": outcome.overlap_m, "frame_time_us": times}
        return found

    def write_now_and_then(self) -> None:
        """Write what is known, unless that was done a moment ago."""
        if time.monotonic() - self.written > max(OFTEN, SELDOM * self.writing):
            self.write(None)

    def write(self, code: int | None) -> Results:
        """Write what is known; `code` is None while the run goes on, so that a killed run says that it was not finished."""
        begun = time.monotonic()
        known = Results(
            rows=self.rows(), series=self.series(),
            outcomes=[self.outcomes[job.stem] for job in self.jobs if job.stem in self.outcomes],
            scenes={
                name: {"title": s.title, "judged": s.judged, "everyday": s.everyday, "family": s.family or name, "dt": s.dt,
                       "scale": s.scale, "frames": s.frames}
                for name, s in self.scenarios.items()
            },
            provenance={**self.provenance, "seconds": round(time.monotonic() - self.begun, 1)}, exit_code=code,
            notes=[note for note in (self.note, *self.remarks()) if note],
        )
        if code is not None or not self.stays:
            results.write(known, self.folder)
        self.written = time.monotonic()
        self.writing = self.written - begun
        return known

    def lapses(self) -> list[str]:
        """What the authors of gated scenes gave up, a sentence each."""
        gated = [outcome for job, outcome in self._known() if (job.engine, job.preset) in self.gated]
        return list(dict.fromkeys(said for outcome in gated if (said := lapsed(outcome))))

    def remarks(self) -> list[str]:
        """Sentences that a run ends with: what authors gave up, and workers of a cluster that were lost."""
        return [*self.lapses(), *map(lost_said, self.lost)]

    def code(self) -> int:
        """The exit code that all rows so far call for."""
        return exit_code(self.rows())
