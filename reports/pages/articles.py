"""Pages beside the index: method, engines, glossary, and tables of benchmarks."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from reports.pages import scripts
from reports.pages.index import environment
from reports.tables.changes import TIME_FACTOR
from reports.tables.figures import quantity, rounded
from reports.tables.run import Run
from runfiles.engines import about, run_label
from runfiles.metrics import METRICS, label
from runfiles.published import MOST_BYTES
from runfiles.timing_protocol import REPEATS, TAIL_FRAMES, WARM_FRAMES

JUDGE = "judge.json"

BENCHES: Mapping[str, str] = {
    "table_2.csv": "Table 2 of the paper",
    "figure_7.csv": "Figure 7: time of a frame",
    "figure_7_shares.csv": "Figure 7: shares of a frame",
    "figure_8.csv": "Figure 8",
    "growth.csv": "Growth with links, avatars and objects",
    "narrow_phase_engines.csv": "Narrow phase",
    "broad_phase.csv": "Broad phase",
}
"""Files of benchmarks that a run folder may hold, and their titles."""

MOST_ROWS = 60
"""Rows of a benchmark on the page; the file has all."""


def articles(run: Run) -> dict[str, str]:
    """Return the pages by file name."""
    made = {"method.html": _method(run), "engines.html": _engines(run), "glossary.html": _glossary()}
    return made | ({"bench.html": _bench(run.folder)} if benches(run.folder) else {})


def benches(folder: Path) -> list[str]:
    """Return the files of benchmarks in a run folder."""
    return [name for name in BENCHES if (folder / name).exists()]


def _rendered(template: str, title: str, **values: Any) -> str:
    js = scripts.source("theme.js") + "onTheme(() => {});\n"
    return (
        environment()
        .get_template(template)
        .render(title=title, css=scripts.source("base.css"), js=js, policy=scripts.policy([js]), **values)
    )


def _method(run: Run) -> str:
    info = run.results.provenance
    shown = {name: value for name, value in info.items() if isinstance(value, str | int | float)}
    shown |= {f"{name} version": value for name, value in dict(info.get("versions") or {}).items()}  # type: ignore[call-overload]
    return _rendered(
        "method.html.j2",
        "Method",
        judge=_judge(run.folder),
        repeats=REPEATS,
        warm=WARM_FRAMES,
        tail=TAIL_FRAMES,
        noise=f"{100.0 * (TIME_FACTOR - 1.0):.0f} %",
        provenance=shown,
        notes=run.results.notes,
    )


def _judge(folder: Path) -> dict[str, str] | None:
    """Return the results of the test of the judge; None without it, or for a damaged file."""
    path = folder / JUDGE
    if not path.exists():
        return None
    try:
        found: Any = read_json(path, str(path), "the whole file that one command wrote", MOST_BYTES)
        whole = found["all"]
        return {
            "pairs": f"{whole['pairs']:,}",
            "error": quantity(float(whole["largest_depth_error"]), "m"),
            "misses": str(whole["misses"]),
            "alarms": str(whole["false_alarms"]),
        }
    except (InvalidFile, KeyError, TypeError, ValueError, OverflowError):
        return None


def _engines(run: Run) -> str:
    found: dict[str, dict[str, Any]] = {}
    for note in run.results.engines:
        name = note.run.partition("/")[0]
        one = about(name)
        entry = found.setdefault(
            name,
            {
                "name": name,
                "label": one.label,
                "colour": one.both,
                "version": note.version,
                "features": {},
                "presets": {},
                "issues": one.issues,
                "unlike": one.unlike,
            },
        )
        for feature, said in note.cannot_say.items():
            entry["features"].setdefault(feature, said)
        # show the settings of a preset in an everyday scene, where it ran one
        kept = entry["presets"].get(note.run)
        if note.settings and (
            kept is None or (note.scenario in run.results.everyday and kept["scene"] not in run.results.everyday)
        ):
            entry["presets"][note.run] = {"label": run_label(note.run), "scene": note.scenario, "settings": note.settings}
    for name, entry in found.items():
        lacking = about(name).unsupported
        entry["unsupported"] = [
            {
                "feature": feature,
                "lacks": lacking[feature].lacks if feature in lacking else "",
                "metrics": ", ".join(label(one) for one in lacking[feature].metrics) if feature in lacking else "",
                "note": said,
            }
            for feature, said in entry.pop("features").items()
        ]
        entry["presets"] = list(entry["presets"].values())
    return _rendered("engines.html.j2", "Engines and settings", engines=list(found.values()))


def _glossary() -> str:
    metrics = [
        {
            "name": one.name,
            "label": one.label,
            "definition": one.definition,
            "tolerance": ""
            if one.level is None
            else f"{100.0 * one.share:.0f} %"
            if one.share
            else quantity(one.level, one.unit),
            "compared": "yes" if one.level is not None else f"no: {one.unranked}",
        }
        for one in METRICS.values()
    ]
    return _rendered("glossary.html.j2", "Glossary", metrics=metrics)


def _bench(folder: Path) -> str:
    tables = []
    for name in benches(folder):
        try:
            table = pd.read_csv(folder / name)
        except (ValueError, pd.errors.ParserError, UnicodeDecodeError):
            continue
        rows = [[_cell(value) for value in row] for row in table.head(MOST_ROWS).itertuples(index=False)]
        tables.append(
            {
                "name": name.partition(".")[0],
                "title": BENCHES[name],
                "file": name,
                "columns": list(table.columns),
                "rows": rows,
                "more": max(0, len(table) - MOST_ROWS),
            }
        )
    return _rendered("bench.html.j2", "Benchmarks", tables=tables)


def _cell(value: object) -> dict[str, Any]:
    if isinstance(value, float):
        return {"text": "" if value != value else rounded(value), "is_number": True}
    return {"text": str(value), "is_number": isinstance(value, int)}
