"""Pages beside the index: method, engines, glossary, and tables of benchmarks."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from reports.charts.cells import EFFECTS
from reports.pages import scripts
from reports.tables.changes import TIME_FACTOR
from reports.tables.figures import quantity, rounded
from reports.tables.run import Run
from runfiles.metrics import METRICS
from runfiles.published import MAX_BYTES
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

MAX_ROWS = 60
"""Rows of a benchmark on the page; the file has all."""


def articles(run: Run) -> dict[str, str]:
    """Return the pages by file name."""
    glossary = _rendered("glossary.html.j2", "Glossary", metrics=METRICS.values())
    made = {"method.html": _method(run), "engines.html": _engines(run), "glossary.html": glossary}
    benches = [name for name in BENCHES if (run.folder / name).exists()]
    return made | ({"bench.html": _bench(run.folder, benches)} if benches else {})


def _rendered(template: str, title: str, **values: Any) -> str:
    js = scripts.source("theme.js") + "onTheme(() => {});\n"
    return scripts.rendered(template, f"{title} · Contact benchmark", [js], {"palette": {}}, heading=title, **values)


def _method(run: Run) -> str:
    info: Any = run.results.provenance
    shown = {name: value for name, value in info.items() if isinstance(value, str | int | float)}
    shown |= {f"{name} version": value for name, value in dict(info.get("versions") or {}).items()}
    return _rendered(
        "method.html.j2", "Method", judge=_judge(run.folder), repeats=REPEATS, warm=WARM_FRAMES, tail=TAIL_FRAMES,
        noise=f"{100.0 * (TIME_FACTOR - 1.0):.0f} %", provenance=shown, notes=run.results.notes, effects=EFFECTS,
    )


def _judge(folder: Path) -> dict[str, Any] | None:
    """Return the results of the test of the judge; None without it, or for a damaged file."""
    path = folder / JUDGE
    if not path.exists():
        return None
    try:
        content: Any = read_json(path, str(path), "the whole file that one command wrote", MAX_BYTES)
        whole = content["all"]
        error = quantity(float(whole["largest_depth_error"]), "m")
        return {"pairs": f"{whole['pairs']:,}", "error": error, "misses": whole["misses"], "alarms": whole["false_alarms"]}
    except (InvalidFile, KeyError, TypeError, ValueError, OverflowError):
        return None


def _engines(run: Run) -> str:
    by_engine: dict[str, dict[str, Any]] = {}
    for note in run.results.engines:
        name = note.run.partition("/")[0]
        entry = by_engine.setdefault(name, {"version": note.version, "features": {}, "presets": {}, "reasons": {}})
        for feature, consequence in note.unsupported.items():
            entry["features"].setdefault(feature, (consequence, {}))[1][note.run] = None
        # show the settings of a preset in an everyday scene, where it ran one
        known, everyday = entry["presets"].get(note.run), run.results.everyday
        if note.settings and (known is None or (note.scenario in everyday and known["scene"] not in everyday)):
            entry["presets"][note.run] = {"scene": note.scenario, "settings": note.settings}
    rows = run.rows[run.rows.why != ""]
    counts = rows.groupby(["why", "run"]).size() if len(rows) else {}
    for (why, name), count in counts.items():
        by_engine.get(name.partition("/")[0], {"reasons": {}})["reasons"].setdefault(why, {})[name] = count
    return _rendered("engines.html.j2", "Engines and settings", engines=by_engine)


def _bench(folder: Path, names: Sequence[str]) -> str:
    tables = []
    for name in names:
        try:
            table = pd.read_csv(folder / name)
        except (ValueError, pd.errors.ParserError, UnicodeDecodeError):
            continue
        rows = [[_cell(value) for value in row] for row in table.head(MAX_ROWS).itertuples(index=False)]
        more = max(0, len(table) - MAX_ROWS)
        tables.append({"title": BENCHES[name], "file": name, "columns": list(table.columns), "rows": rows, "more": more})
    return _rendered("bench.html.j2", "Benchmarks", tables=tables)


def _cell(value: object) -> tuple[str, bool]:
    """Return a cell's text, and whether it is a number."""
    if isinstance(value, float):
        return "" if value != value else rounded(value), True
    return str(value), isinstance(value, int)
