"""The commands `list` and `metrics`: scenes, the effects of each, definitions of figures."""

import argparse
import json
from collections.abc import Sequence
from dataclasses import fields
from textwrap import fill
from typing import Any

from avatarsim.scene.effects import CALLS, KEPT
from avatarsim.scene.scene import Scene
from runfiles.metrics import FAMILIES, METRICS
from scenarios.cli.commands import nothing_matched
from scenarios.cli.plan import scenes

LISTED = 3
"""Parts of a scene that are named; more are counted."""


def listing(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Print names, lengths and titles; with `--effects` the effects of each scene, and the parts that need them."""
    listed = scenes(options)
    if not listed:
        return nothing_matched(options)
    entries: list[dict[str, Any]] = []
    for scenario in listed.values():
        names = ("name", "frames", "short", "dt", "everyday", "title", "judged")
        effects = effects_of(scenario.build()) if options.effects else {}
        entries.append({name: getattr(scenario, name) for name in names} | effects)
    if options.json:
        print(json.dumps(entries, indent=1))
        return 0
    if options.effects:
        print(table_of_calls())
    for entry in entries:
        length = f"{entry['frames']}" if entry["short"] is None else f"{entry['frames']}/{entry['short']}"
        print(f"{entry['name']:24} {length:>10} frames  {entry['title']}")
        for effect in entry.get("effects", ()):
            parts = entry["called_by"].get(effect, ["forced: nothing calls for it"])
            more = f" and {len(parts) - LISTED} more" if len(parts) > LISTED else ""
            print(f"{'':24} {effect:16} {', '.join(parts[:LISTED])}{more}")
        for effect, promise in entry.get("lapsed", {}).items():
            print(f"{'':24} {effect:16} left out by its author: promise {promise} lapses")
    return 0


def effects_of(scene: Scene) -> dict[str, object]:
    """Return the effects of a scene, the parts that need them, and those that its author left out."""
    on = scene.effects
    return {
        "effects": [effect.name for effect in fields(on) if getattr(on, effect.name)],
        "called_by": {effect: list(parts) for effect, parts in scene.calls.items() if parts},
        "switched_off": list(on.missing_from(scene.derived_effects)), "lapsed": dict(scene.lapsed),
    }


def table_of_calls() -> str:
    """Return a paragraph per effect: the part of a scene that needs it, and the promise that lapses without it."""
    rows = ["An effect runs in a scene if a part of it calls for it:", ""]
    for call in CALLS:
        without = "Cannot be left out." if call.effect in KEPT else f"Left out, promise {call.lapses} lapses."
        text = f"{call.part}: {call.why}. {without}"
        rows.append(fill(text, 120, initial_indent=f"{call.effect:16} ", subsequent_indent=" " * 17))
    return "\n".join([*rows, ""])


def metrics(options: argparse.Namespace, words: Sequence[str]) -> int:
    """Print the definitions of all figures."""
    entries = (*METRICS.values(), *FAMILIES)
    if options.json:
        rows = [{"metric": one.name, "unit": one.unit, "label": one.label, "meaning": one.definition} for one in entries]
        print(json.dumps(rows, indent=1))
        return 0
    for one in entries:
        print(f"{one.name:26} {f'[{one.unit}]' if one.unit else '':9} {one.definition}")
    return 0
