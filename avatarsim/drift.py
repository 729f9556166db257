"""Drift gate: figures of a scene, kept in a small file, against those of a later version of an engine.

A figure has moved where it differs from the kept one by more than its metric resolves.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json

FORMAT = 1
"""Layout of the file."""
MOST_BYTES = 2**22
"""Largest file [bytes] that is read: a scene of ten engines has some 50 kB."""
VALID = "a file that --update-drift wrote"
TIMES = "frame_time_", "warmup"
"""Beginnings of metrics that differ from machine to machine, and are not kept."""

Document = Mapping[str, Any]
"""A comparison as `avatarsim compare --json` prints it."""
Figures = Mapping[str, Mapping[str, Any]]
"""Scene and run, "cell mujoco/tuned" -> version, and figures by metric."""


@dataclass(frozen=True)
class Moved:
    """A figure that has moved.

    run           scene, engine and preset
    old, new      value kept and value now, None where it was not measured
    was, version  versions of the engine
    """

    run: str
    metric: str
    unit: str
    old: float | None
    new: float | None
    was: str
    version: str


def figures_of(results: Document) -> Figures:
    """Return the figures that are kept: finite ones of metrics with a resolution, without times."""
    metrics, figures = results["metrics"], dict[str, dict[str, Any]]()
    for one in results["runs"]:
        if one["state"] == "measured":
            figures[f"{one['scenario']} {one['run']}"] = {"version": one["version"], "figures": {}}
    for row in results["rows"]:
        name, value = row["metric"], row["value"]
        of_run = figures.get(f"{row['scenario']} {row['engine']}/{row['preset']}")
        ranked = metrics[name]["level"] is not None and not name.startswith(TIMES)
        if of_run is not None and ranked and isinstance(value, int | float) and math.isfinite(value):
            of_run["figures"][name] = value
    return figures


def update(path: Path, results: Document) -> None:
    """Write the file anew."""
    text = json.dumps({"format": FORMAT, "runs": figures_of(results)}, indent=1, sort_keys=True)
    path.write_text(text + "\n", encoding="utf-8")


def read_figures(path: Path) -> Figures:
    """Return the figures in the file at `path`. Raises InvalidFile where it is missing or of another layout."""
    if not path.exists():
        raise InvalidFile(f"kept figures {path}", "missing", f"{VALID}: run once with --update-drift, and commit it")
    content = read_json(path, f"kept figures {path}", VALID, MOST_BYTES)
    if not isinstance(content, dict) or content.get("format") != FORMAT or not isinstance(content.get("runs"), dict):
        raise InvalidFile(f"kept figures {path}", "of another layout", VALID)
    try:
        return {
            str(run): {"version": str(one["version"]), "figures": {name: float(value) for name, value in one["figures"].items()}}
            for run, one in content["runs"].items()
        }
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InvalidFile(f"kept figures {path}", f"{type(error).__name__}: {error}", VALID) from error


def drifted(baseline: Figures, results: Document, share: float = 0.0) -> list[Moved]:
    """Return the figures that have moved from the kept ones; runs and metrics that are new have not.

    Args:
        share: difference, as a share of the larger value, up to which a figure has not moved either.
    """
    return [one for run, before in baseline.items() for one in _moved(run, before, results, share)]


def _moved(run: str, before: Mapping[str, Any], results: Document, share: float) -> list[Moved]:
    """Return the figures of one run that have moved."""
    after, moved = figures_of(results).get(run, {"version": "", "figures": {}}), list[Moved]()
    for name, old in before["figures"].items():
        new, entry = after["figures"].get(name), results["metrics"].get(name, {"unit": ""})
        if new is None or _differs(old, new, entry["level"], max(entry["share"], share)):
            moved.append(Moved(run, name, entry["unit"], old, new, before["version"], after["version"]))
    return moved


def _differs(old: float, new: float, level: float, share: float) -> bool:
    return abs(new - old) > level and abs(new - old) > share * max(abs(old), abs(new))


def drift_table(moved: Sequence[Moved]) -> str:
    """Return a line per figure that has moved: old, new, versions."""
    rows = [("engine", "metric", "kept", "now", "kept with", "now with")]
    for one in moved:
        old, new = ("not measured" if value is None else f"{value:.4g} {one.unit}".strip() for value in (one.old, one.new))
        rows.append((one.run, one.metric, old, new, one.was, one.version or "not run"))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join("  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip() for row in rows)
