"""`python -m scenarios study`: studies in their long form, added to a run; what was finished before is not done again."""

import argparse
import json
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, replace

import pandas as pd

from avatarsim.errors import InvalidInput, UnknownName
from runfiles.files import last_comparison, plain
from runfiles.naming import BASELINE
from runfiles.table import Row
from scenarios.cli.commands import Plan, nothing, plan, say_last
from scenarios.engines import known
from scenarios.run.gate import INCOMPLETE, STOPPED
from scenarios.run.processes import workers_of
from scenarios.studies import contact_law, effects, hard_cases, settings
from scenarios.studies.study import Request, Study

STUDIES: dict[str, Study] = {study.name: study for study in (settings.STUDY, hard_cases.STUDY, effects.STUDY, contact_law.STUDY)}
KEPT = "studies"
"""Folder below that of all runs: checkpoints, and the rows before there is a comparison."""


def study(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """Carry out the studies that are named, print a table of each, and add their files to the last comparison."""
    for name in asked.name:
        if name not in STUDIES:
            raise UnknownName("study", name, STUDIES)
    if asked.resume is not None:
        raise InvalidInput("--resume", str(asked.resume), "none: a study goes on by itself when its command is repeated")
    made = plan(asked, asked.engine or [name for name in known() if name != BASELINE], False)
    if not made.scenarios:
        return nothing(asked)
    folder = last_comparison(asked.out.resolve(), KEPT) if asked.run is None else asked.run
    folder.mkdir(parents=True, exist_ok=True)
    absent = {outcome.job.engine: outcome.note for outcome in made.ready}
    code, rows = INCOMPLETE if absent else 0, list[Row]()
    for name in asked.name:
        try:
            found, troubles = STUDIES[name].carry_out(request_of(asked, made, STUDIES[name]))
        except KeyboardInterrupt:
            code = STOPPED
            with suppress(OSError):
                # a terminal that was closed takes no words
                print("stopped; what was finished is kept, and the same command goes on from there", file=sys.stderr)
            break
        rows += found
        for trouble in troubles:
            print(f"{name}: {trouble}", file=sys.stderr)
        code = code or (INCOMPLETE if troubles or any(row.status == "crashed" and not row.change for row in found) else 0)
        if not asked.json:
            print(f"{name}\n{table(found)}\n")
    if asked.json:
        print(json.dumps(plain([asdict(row) for row in rows]), allow_nan=False))
    for engine, note in absent.items():
        print(f"{engine} is left out: {note}", file=sys.stderr)
    # nothing is gated here
    say_last(asked, code, folder, "" if code else f"{', '.join(asked.name)}: {len(rows)} figures")
    return code


def request_of(asked: argparse.Namespace, made: Plan, study: Study) -> Request:
    """Return what a study is asked about: scenes that are named, or those that it usually takes."""
    every = asked.full or asked.filter is not None
    scenarios = {name: one for name, one in made.scenarios.items() if every or study.usual(one)}
    presets: dict[str, tuple[str, ...]] = {}
    ready = {outcome.job.engine for outcome in made.ready}
    for job in made.jobs:
        if job.engine not in ready and not job.base and job.preset not in presets.get(job.engine, ()):
            presets[job.engine] = (*presets.get(job.engine, ()), job.preset)
    folder = last_comparison(asked.out.resolve(), KEPT) if asked.run is None else asked.run
    request = Request(folder, scenarios, presets, workers_of(asked), asked.seed[0], asked.full, frames=asked.frames, own=made.own)
    return replace(request, kept=asked.out.resolve() / KEPT)


def table(rows: Sequence[Row]) -> str:
    """Return a line per run and change, a column per metric: the median over scenes; and how many runs have no figures."""
    if not rows:
        return "nothing to do in these scenes"
    found = pd.DataFrame([{"run": row.run, "change": row.change, "metric": row.metric, "value": row.value} for row in rows])
    found["value"] = found.value.astype(float)
    shown = found.pivot_table("value", ["run", "change"], "metric", "median", sort=False)
    failed = found[found.metric == "run"].groupby(["run", "change"], sort=False).size()
    shown = shown.assign(without_figures=failed.reindex(shown.index).fillna(0).astype(int))
    text: str = shown.to_string(float_format="{:.3g}".format)
    return text
