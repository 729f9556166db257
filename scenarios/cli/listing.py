"""What can be run, in words: the scenes, what each calls for, what every figure means."""

import argparse
import json
from collections.abc import Sequence
from typing import Any

from runfiles.metrics import FAMILIES, METRICS
from scenarios.cli.commands import nothing, scenes
from scenarios.run.effects_said import effects_of, lines_of, table_of_calls
from scenarios.scenario import Scenario


def listing(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """Names, lengths and titles; with `--effects` what each scene calls for and by which part, and what its author took away."""
    found = scenes(asked)
    if not found:
        return nothing(asked)
    entries = [entry_of(scenario, asked.effects) for scenario in found.values()]
    if asked.json:
        print(json.dumps(entries, indent=1))
        return 0
    if asked.effects:
        print(table_of_calls())
    for entry in entries:
        length = f"{entry['frames']}" if entry["short"] is None else f"{entry['frames']}/{entry['short']}"
        print(f"{entry['name']:24} {length:>10} frames  {entry['title']}")
        if asked.effects:
            for line in lines_of(found[entry["name"]].build()):
                print(f"{'':24} {line}")
    return 0


def entry_of(scenario: Scenario, effects: bool) -> dict[str, Any]:
    """What `list` says of one scene."""
    told = ("name", "frames", "short", "dt", "everyday", "title", "judged")
    entry: dict[str, Any] = {key: getattr(scenario, key) for key in told}
    if effects:
        entry |= effects_of(scenario.build())
    return entry


def metrics(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """The definitions."""
    known_metrics = (*METRICS.values(), *FAMILIES)
    if asked.json:
        rows = [{"metric": one.name, "unit": one.unit, "label": one.label, "meaning": one.definition} for one in known_metrics]
        print(json.dumps(rows, indent=1))
        return 0
    for one in known_metrics:
        print(f"{one.name:26} {f'[{one.unit}]' if one.unit else '':9} {one.definition}")
    return 0
