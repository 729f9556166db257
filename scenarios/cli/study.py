"""`python -m scenarios study`: studies in their long form, added to a run; finished parts are not done again."""

import argparse
import json
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

import pandas as pd

from avatarsim.errors import InvalidInput, UnknownName
from runfiles.files import last_comparison, plain
from runfiles.naming import BASELINE
from runfiles.table import Row
from scenarios.cli.commands import nothing_matched, print_end
from scenarios.cli.comparison import presets_of
from scenarios.cli.plan import Plan, plan
from scenarios.engines import engines_to_run
from scenarios.run.gate import INCOMPLETE, STOPPED
from scenarios.run.processes import workers_of
from scenarios.studies import contact_law, effects, hard_cases, settings
from scenarios.studies.study import Request, Study

STUDIES: dict[str, Study] = {one.name: one for one in (settings.STUDY, hard_cases.STUDY, effects.STUDY, contact_law.STUDY)}
CHECKPOINTS = "studies"
"""Folder below that of all runs: checkpoints, and the rows before there is a comparison."""


def study(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Carry out the studies that are named, print a table of each, and add their files to the last comparison."""
    for name in options.name:
        if name not in STUDIES:
            raise UnknownName("study", name, STUDIES)
    if options.resume is not None:
        raise InvalidInput("--resume", str(options.resume), "none: a study resumes by itself when its command is repeated")
    made = plan(options, [name for name in engines_to_run(options.engine) if options.engine or name != BASELINE], False)
    if not made.scenarios:
        return nothing_matched(options)
    folder = last_comparison(options.out.resolve(), CHECKPOINTS) if options.run is None else options.run
    folder.mkdir(parents=True, exist_ok=True)
    absent = {outcome.job.engine: outcome.note for outcome in made.ready}
    code, rows = INCOMPLETE if absent else 0, list[Row]()
    for name in options.name:
        try:
            study_rows, troubles = STUDIES[name].carry_out(request_of(options, made, STUDIES[name], folder))
        except KeyboardInterrupt:
            code = STOPPED
            with suppress(OSError):
                # a terminal that was closed takes no text
                print("stopped; finished parts are kept, and the same command resumes the study", file=sys.stderr)
            break
        rows += study_rows
        for trouble in troubles:
            print(f"{name}: {trouble}", file=sys.stderr)
        code = code or (INCOMPLETE if troubles or any(row.status == "crashed" and not row.change for row in study_rows) else 0)
        if not options.json:
            print(f"{name}\n{table(study_rows)}\n")
    if options.json:
        print(json.dumps(plain([asdict(row) for row in rows]), allow_nan=False))
    for engine, note in absent.items():
        print(f"{engine} is left out: {note}", file=sys.stderr)
    # nothing is gated here
    print_end(options, code, folder, "" if code else f"{', '.join(options.name)}: {len(rows)} figures")
    return code


def request_of(options: argparse.Namespace, made: Plan, study: Study, folder: Path) -> Request:
    """Return the request to a study: scenes that are named, or those that it usually takes."""
    every = options.full or options.filter is not None
    scenarios = {name: one for name, one in made.scenarios.items() if every or study.usual(one)}
    closed = {outcome.job.engine for outcome in made.ready}
    presets = presets_of(job for job in made.jobs if job.engine not in closed)
    return Request(
        folder, scenarios, presets, workers_of(options), options.seed[0], options.full, frames=options.frames, own=made.own,
        checkpoints=options.out.resolve() / CHECKPOINTS,
    )


def table(rows: Sequence[Row]) -> str:
    """Return a line per run and change, a column per metric: the median over scenes; and the number of runs without figures."""
    if not rows:
        return "nothing to do in these scenes"
    values = pd.DataFrame([{"run": row.run, "change": row.change, "metric": row.metric, "value": row.value} for row in rows])
    values["value"] = values.value.astype(float)
    shown = values.pivot_table("value", ["run", "change"], "metric", "median", sort=False)
    failed = values[values.metric == "run"].groupby(["run", "change"], sort=False).size()
    shown = shown.assign(without_figures=failed.reindex(shown.index).fillna(0).astype(int))
    text: str = shown.to_string(float_format="{:.3g}".format)
    return text
