"""Cost and consequence of each effect: scenes again without each of their effects, and with all others forced on."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.effects import KEPT, Effects
from avatarsim.scene.scene import Scene
from runfiles import record
from runfiles.naming import GATED
from runfiles.table import Row
from runfiles.timing_protocol import REPEATS
from scenarios.job import Job, Outcome
from scenarios.measure.value import Missing
from scenarios.run.accuracy import accuracy
from scenarios.run.gate import bounds_of
from scenarios.run.machine import Meter
from scenarios.run.progress import Progress
from scenarios.run.timed_worker import TimedWorkers
from scenarios.run.timing import MOST_FRAMES, Clocked, TimedJob, load
from scenarios.scenario import Scenario
from scenarios.studies.checkpoint import Entry, key_of
from scenarios.studies.study import Head, Request, Study, answers

ENGINE, PRESET = GATED
"""The only engine with these switches."""
NAME, FORCED = "effects", "forced"
"""The study, and the change in which all effects are on that the scene does not need."""


def jobs(name: str, scene: Scene, request: Request) -> dict[str, Job]:
    """Return by change: the scene as it is, without each effect that can be left out, and with all that nothing needs."""
    on = [effect.name for effect in fields(Effects) if getattr(scene.effects, effect.name)]
    off = tuple(effect.name for effect in fields(Effects) if not getattr(scene.derived_effects, effect.name))
    plain = Job(name, ENGINE, PRESET, request.seed, request.full, request.frames)
    by_change = {"": plain}
    for effect in on:
        if effect not in KEPT:
            by_change[f"without {effect}"] = replace(plain, preset=f"without-{effect}", base=PRESET, narrow=(effect,))
    return by_change | {FORCED: replace(plain, preset=FORCED, base=PRESET, force=off)}


def figures(job: Job) -> Entry:
    """Return state, note, values and `moved`: the largest distance [m] of a body from its place in the scene as it is."""
    with TemporaryDirectory(prefix="effects-") as folder:
        outcome = accuracy(job, Path(folder))
        here = _positions(outcome)
    plain = here if job.preset == PRESET else _plain(job.scenario, job.seed, job.full, job.frames)
    frames = min(len(plain), len(here))
    moved = float(np.linalg.norm(here[:frames] - plain[:frames], axis=-1).max()) if frames else None
    values = {name: value for name, value in outcome.values.items() if not isinstance(value, Missing)}
    return {"state": outcome.state, "note": outcome.note, "frames": outcome.frames, "values": values, "moved": moved}


@lru_cache(maxsize=1)
def _plain(scenario: str, seed: int, full: bool, frames: int | None) -> NDArray[np.float64]:
    """Return the places of a scene as it is: the jobs of one scene come one after the other."""
    with TemporaryDirectory(prefix="effects-") as folder:
        return _positions(accuracy(Job(scenario, ENGINE, PRESET, seed, full, frames), Path(folder)))


def _positions(outcome: Outcome) -> NDArray[np.float64]:
    return np.zeros((0, 0, 3)) if outcome.recording is None else record.load(outcome.recording).positions


def timed_in_turn(jobs: Sequence[Job], workers: TimedWorkers) -> list[Clocked]:
    """Time jobs of one scene in one process, turn by turn: the compared times then differ in the effect alone."""
    table, meter = list[TimedJob](), Meter()
    for _ in range(REPEATS):
        for k, job in enumerate(jobs):
            worker = workers.at(ENGINE)
            if k == len(table):
                table.append(TimedJob(job, worker))
            table[k].worker = worker
            for ready in load([table[k]]):
                ready.turn(meter)
    return [each.clocked() for each in table]


def ask(request: Request) -> tuple[list[Row], list[str]]:
    """Run and time the effects of the scenes: of a comparison those of everyday, of the long form all that are given."""
    scenarios = {name: scenario for name, scenario in request.scenarios.items() if scenario.everyday or request.long}
    if not scenarios or PRESET not in request.presets.get(ENGINE, ()):
        return [], []
    planned = {name: jobs(name, scenario.as_run(request.full).build(), request) for name, scenario in scenarios.items()}
    tasks = {key_of(NAME, job): job for group in planned.values() for job in group.values()}
    keys = {job.stem: key for key, job in tasks.items()}
    checkpoint = request.checkpoint(NAME)
    done = dict(answers(figures, tasks, request, checkpoint, NAME, lambda job: True))
    rows, troubles = list[Row](), list[str]()
    with Progress("effects, times", len(planned), sys.stderr, part=True) as progress, TimedWorkers() as workers:
        for name, group in planned.items():
            sound = {change: job for change, job in group.items() if done[keys[job.stem]]["state"] == "measured"}
            time_key = key_of(NAME, "times", *sound.values())
            times = checkpoint.get(time_key)
            if times is None:
                clocked = timed_in_turn(list(sound.values()), workers)
                times = dict(zip(sound, map(_p50, clocked), strict=True))
                checkpoint.put(time_key, times)
            for change, job in group.items():
                rows += _rows(scenarios, change, job, done[keys[job.stem]], times.get(change))
            troubles += [f"{name} {change or 'as it is'} was not timed" for change, time in times.items() if time is None]
            progress.step(name)
    return rows, troubles


def _p50(clocked: Clocked) -> float | None:
    """Return the median frame [us], engine only; None where nothing was timed."""
    return float(np.median(clocked.timed.best_us)) if clocked.timed else None


def _rows(scenarios: Mapping[str, Scenario], change: str, job: Job, entry: Entry, p50: float | None) -> list[Row]:
    head = Head(NAME, job.scenario, ENGINE, PRESET, change, "", job.seed, entry["frames"])
    if entry["state"] != "measured":
        return [head.without(entry["state"], entry["note"])]
    rows = [head.row("frame_time_p50", p50, f"{REPEATS} x {min(entry['frames'], MOST_FRAMES)} frames")]
    rows += [head.row("pose_distance_max", entry["moved"])] if change else []
    for metric, bound in bounds_of(scenarios[job.scenario]).items():
        value = entry["values"].get(metric)
        rows.append(head.row(metric, None if value is None else float(value), bound=bound.limit))
    return rows


STUDY = Study(NAME, ask, lambda scenario: scenario.everyday)
