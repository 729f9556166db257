"""`python -m scenarios tune ENGINE`: search for settings of an engine on scenes and motions that are drawn by a seed.

A coordinate search: from a preset on, each number is halved and doubled, each flag is switched, and each setting of the engine's
`sweep.toml` is tried, all on the same draws; the best change is taken, and the search goes on from it. The result is judged on
other draws: those of the next seeds, which `python -m scenarios drawn` takes.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd

from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput, UnknownName
from runfiles.engines import about
from runfiles.naming import TUNED
from scenarios.cli.commands import nothing_matched, print_end
from scenarios.cli.drawn import picked
from scenarios.cli.plan import catalogue_of
from scenarios.engines import known, opened
from scenarios.job import Job, Outcome
from scenarios.measure.value import Missing
from scenarios.run.accuracy import prepare
from scenarios.run.harness import outcomes
from scenarios.run.progress import Progress
from scenarios.studies.settings.grid import settings_of
from scenarios.unseen import seeds

FLOOR = {"residual_overlap_max": 1e-6, "tracker_offset_rms_free": 1e-4}
"""Figures that decide, in their order, and the size [m] below which a smaller one is no better."""
ALIKE = 0.1
"""Share of a figure, in the mean over scenes, by which a setting has to be better: less is luck."""
FACTORS = (0.5, 2.0)
"""Factors that a number is multiplied by."""


@dataclass(frozen=True)
class Candidate:
    """Options over a preset, and their `change` from those before."""

    change: str
    options: Mapping[str, object]


def tune(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Search for settings of one engine; print every setting that was tried and the options of the best."""
    if options.tuned not in known():
        raise UnknownName("engine", options.tuned, known())
    if min(options.count, options.rounds) < 1:
        raise InvalidInput("--count and --rounds", min(options.count, options.rounds), "1 at least")
    engine = options.tuned
    preset = (options.preset or [TUNED if TUNED in about(engine).presets else about(engine).presets[0]])[0]
    first = seeds.draw().seed if options.seed[0] == seeds.OWN else options.seed[0]
    scenes = picked(options.filter, first, options.count)
    if not scenes:
        return nothing_matched(options)
    jobs = [Job(scene, engine, preset, seed, catalogue=catalogue_of(scene), frames=options.frames) for scene, seed in scenes]
    print(f"{engine}/{preset} on {len(jobs)} draws, --seed {first}", file=sys.stderr)
    at = Candidate("as it is", {})
    figures = tried(jobs, [at], options.jobs)
    table = [figures.assign(round=0)]
    for number in range(1, options.rounds + 1):
        trials = tried(jobs, list(neighbours(jobs[0], at.options)), options.jobs)
        table.append(trials.assign(round=number))
        best = min(trials.index, key=lambda k: ranked(trials.loc[k], figures.iloc[0]))
        if ranked(trials.loc[best], figures.iloc[0]) >= ranked(figures.iloc[0], figures.iloc[0]):
            break
        at, figures = trials.candidate[best], trials.loc[[best]]
    shown = pd.concat(table).drop(columns="candidate").set_index(["round", "change"])
    print(shown.to_string(float_format="{:.3g}".format))
    print("best: " + (", ".join(f"{name} = {value}" for name, value in at.options.items()) or "the preset as it is"))
    print_end(options, 0, None)
    return 0


def neighbours(job: Job, options: Mapping[str, object]) -> Iterator[Candidate]:
    """Yield `options` with one setting of the engine changed, or with those of an entry of its sweep.

    An entry knows values that halving and doubling do not reach: from 0 on, words, and settings that go together.
    """
    engine, prepared = opened(job.engine), prepare(job)
    engine.load(prepared.scene, Settings(job.preset, options), prepared.scenario.dt)
    run = engine.settings_as_run()
    engine.close()
    changes: list[tuple[str, Mapping[str, object]]] = []
    for name, entry in run.items():
        value = entry[0] if isinstance(entry, tuple) else entry
        if isinstance(value, bool):
            changes.append((f"{name} = {not value}", {name: not value}))
        elif isinstance(value, int | float) and value:
            scaled = [max(1, round(factor * value)) if isinstance(value, int) else factor * value for factor in FACTORS]
            changes += [(f"{name} = {other:g}", {name: other}) for other in scaled if other != value]
    swept = [one for one in settings_of(job.engine, (job.preset,)) if one.base == job.preset and one.options]
    changes += [(one.name, one.options) for one in swept if one.options.keys() != {"dt"}]
    for change, changed in changes:
        made = {**options, **changed}
        try:
            engine.load(prepared.scene, Settings(job.preset, made), prepared.scenario.dt)
        except InvalidInput:
            # no option, but a fact listed with them, or not of this scene
            continue
        engine.close()
        yield Candidate(change, made)


def tried(jobs: Sequence[Job], candidates: Sequence[Candidate], workers: int) -> pd.DataFrame:
    """Return a row for each candidate: the geometric mean of each figure over the draws, and the time of a frame."""
    numbered = [
        replace(job, preset=str(k), base=job.preset, options=one.options) for k, one in enumerate(candidates) for job in jobs
    ]
    rows: dict[int, list[Outcome]] = {k: [] for k in range(len(candidates))}
    with TemporaryDirectory(prefix="tune-") as folder, Progress("tune", len(numbered), sys.stderr) as progress:
        for outcome in outcomes(numbered, Path(folder), workers):
            if outcome.recording is not None:
                outcome.recording.unlink(missing_ok=True)
            rows[int(outcome.job.preset)].append(outcome)
            progress.step(f"{outcome.job.scenario} {candidates[int(outcome.job.preset)].change}")
    return pd.DataFrame([
        {"change": one.change, "candidate": one,
         **{metric: geometric_mean(rows[k], metric, floor) for metric, floor in FLOOR.items()},
         "frame_ms": 1e3 * float(np.median([outcome.frame_seconds for outcome in rows[k]]))}
        for k, one in enumerate(candidates)
    ])


def geometric_mean(outcomes: Sequence[Outcome], metric: str, floor: float) -> float:
    """Return the mean over the draws that have the figure; infinite where one of them did not run to its end."""
    if any(outcome.state != "measured" for outcome in outcomes):
        return float("inf")
    values = [value for outcome in outcomes if not isinstance(value := outcome.values.get(metric), Missing | None)]
    numbers = np.array([float(value) for value in values])
    # of a figure that no draw has all settings have the same
    numbers = numbers if len(numbers) else np.array([floor])
    return float(np.exp(np.log(np.maximum(numbers, floor)).mean())) if np.isfinite(numbers).all() else float("inf")


def ranked(figures: "pd.Series[float]", before: "pd.Series[float]") -> tuple[float, ...]:
    """Return the sort key of settings: each figure in steps of ALIKE of the one before, and time last, doubled or halved."""
    ratios = [float(figures[metric]) / float(before[metric]) for metric in FLOOR]
    slower = float(figures["frame_ms"]) / float(before["frame_ms"])
    return *(float(np.round(np.log(ratio) / np.log1p(ALIKE))) for ratio in ratios), float(np.round(np.log2(slower)))
