"""`python -m scenarios ablate`: each scene as it is, without each of its effects, and with all others."""

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict

from runfiles.files import latest, plain
from scenarios.cli.commands import Plan, begun, finished, lead_to, nothing, passes, scenes
from scenarios.results.gate import STOPPED
from scenarios.studies.ablation import LONG, idle, jobs, lines, table, write


def ablate(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """Each scene as it is, without each of its effects, and with all others: accuracy, then time, our engine only."""
    found = scenes(asked)
    if not found:
        return nothing(asked)
    built = {name: scenario.as_run(asked.full).build() for name, scenario in found.items()}
    planned = [
        job for name, scene in built.items() for seed in asked.seed[:1]
        for job in jobs(name, scene, seed, asked.full, asked.frames)
    ]
    made = Plan(found, planned, [], frozenset())
    ran = begun(asked, words, made, {})
    code = passes(asked, made, ran, timed=True)
    told = lines(planned, ran.outcomes, ran.clocked, built, ran.scenarios)
    beside = latest(asked.out.resolve())
    # of a run that was stopped nothing goes beside a whole one
    also = [beside] if code != STOPPED and beside.is_dir() else []
    write(told, idle(planned, ran.clocked), LONG, [ran.folder, *also])
    lead_to(ran, asked, code)
    print(json.dumps(plain([asdict(line) for line in told]), allow_nan=False) if asked.json else table(told))
    return finished(asked, words, made, ran, code)
