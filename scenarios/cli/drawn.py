"""`python -m scenarios drawn`: many scenes and motions that nothing was tuned for, drawn by seed and put to their bounds."""

import argparse
import json
import re
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from itertools import count, islice
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from avatarsim.errors import InvalidInput
from runfiles.files import plain
from runfiles.naming import GATED
from runfiles.table import Row
from scenarios import drawn_crowds, unseen
from scenarios.cli.commands import nothing_matched, print_end
from scenarios.cli.plan import filtered, plan
from scenarios.job import Outcome
from scenarios.measure.value import Missing
from scenarios.run.gate import exit_code, meaning, rows_of
from scenarios.run.harness import outcomes
from scenarios.run.progress import Progress
from scenarios.unseen import seeds


def drawn(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Run drawn scenes at full length; print the worst figures of each kind, and each broken bound with its seed.

    The first engine is gated.
    """
    if options.count < 1:
        raise InvalidInput("--count", options.count, "1 at least")
    first = seeds.draw().seed if options.seed[0] == seeds.OWN else options.seed[0]
    pairs = picked(options.filter, first, options.count)
    if not pairs:
        return nothing_matched(options)
    options.full = True
    made = plan(options, options.engine or [GATED[0]], True, pairs)
    gated, by_job = (made.jobs[0].engine, made.jobs[0].preset), dict[str, list[Row]]()
    closed = [outcome.job for outcome in made.ready]
    runnable = [job for job in made.jobs if job not in closed]
    print(f"{len(pairs)} scenes drawn, --seed {first}", file=sys.stderr)
    with TemporaryDirectory(prefix="drawn-") as folder, Progress("drawn", len(runnable), sys.stderr) as progress:
        for outcome in (*made.ready, *outcomes(runnable, Path(folder), options.jobs)):
            job = outcome.job
            if outcome.recording is not None:
                outcome.recording.unlink(missing_ok=True)
            job_rows = rows_of(outcome, made.scenarios[job.scenario], {}, (job.engine, job.preset) == gated)
            by_job[job.stem] = [replace(row, status="info") if no_occasion(outcome, row.metric) else row for row in job_rows]
            progress.step(f"{job.scenario} {job.seed} {outcome.state}")
    rows = [row for job in made.jobs for row in by_job[job.stem]]
    if options.json:
        print(json.dumps(plain([asdict(row) for row in rows]), allow_nan=False))
    else:
        metrics = {metric for scenario in made.scenarios.values() for metric in scenario.metrics}
        print(summary(rows, metrics))
        for row in rows:
            if row.status in ("fail", "crashed", "not-measured"):
                value = "" if row.value is None else f" {row.value:.4g}"
                print(f"{row.status}: {row.scenario} --seed {row.seed} {row.run} {row.metric}{value} {row.note}".rstrip())
    code = exit_code(rows)
    print_end(options, code, None, meaning(code, rows, frozenset({gated})))
    return code


def no_occasion(outcome: Outcome, metric: str) -> bool:
    """Return whether a figure is missing since the scene gave no occasion for it: a drawn one may lead nowhere near a wall."""
    value = outcome.values.get(metric)
    return isinstance(value, Missing) and value.fault == "scene"


def picked(patterns: str | None, first: int, number: int) -> list[tuple[str, int]]:
    """Return name and seed of so many motions in each room, and of so many crowds, from the seed `first` on.

    Of crowds those whose kind has an example among the next seeds that a pattern matches.
    """
    examples = {drawn_crowds.draw(first + k).name: k for k in range(len(drawn_crowds.KINDS))}
    offered = unseen.scenarios() | {name: drawn_crowds.get(name) for name in examples}
    chosen = offered if patterns is None else filtered(offered, patterns)
    kinds = {examples[name] for name in chosen if name in examples}
    crowds = islice((seed for seed in count(first) if (seed - first) % len(examples) in kinds), number if kinds else 0)
    rooms = [name for name in chosen if name not in examples]
    motions = [(room, seed) for seed in range(first, first + number) for room in rooms]
    return motions + [(drawn_crowds.draw(seed).name, seed) for seed in crowds]


def summary(rows: Sequence[Row], metrics: set[str]) -> str:
    """Return median and worst of each bounded figure, and of `metrics`, of a kind and engine, and how many break their bound."""
    table = pd.DataFrame([
        {"kind": re.sub(r"_\d+$", "", row.scenario), "run": row.run, "metric": row.metric, "value": row.value,
         "worst_in": f"{row.scenario} --seed {row.seed}", "outside": row.bound is not None and not row.value <= row.bound}
        for row in rows if row.value is not None and (row.bound is not None or row.metric in metrics)
    ])
    if table.empty:
        return "no figures"
    groups = table.groupby(["kind", "run", "metric"], sort=False)
    # of figures that are no number the first is the worst
    worst = groups.value.apply(lambda values: values.fillna(float("inf")).idxmax())
    lines = groups.agg(median=("value", "median"), outside=("outside", "sum"), of=("outside", "size"))
    lines.insert(1, "worst", table.value[worst].to_numpy())
    text: str = lines.assign(worst_in=table.worst_in[worst].to_numpy()).to_string(float_format="{:.3g}".format)
    return text
