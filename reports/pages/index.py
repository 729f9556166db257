"""`index.html`: the page of a comparison."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any
from urllib.parse import quote

import pandas as pd

from reports.charts import cells, curves, marks, strips
from reports.drawing.stills import Stills
from reports.pages import copying, scripts
from reports.replay.moments import moment
from reports.tables.changes import Changes
from reports.tables.checks import Checks
from reports.tables.figures import quantity
from reports.tables.run import Run
from reports.tables.settings import LEVELS
from runfiles.engines import about, main_runs, run_label
from runfiles.metrics import label

DIGITS = 4
"""Significant digits of the figures in the table of the page; results.csv has all."""

EVERYDAY = "hand_over_table"
"""Scene whose settings are shown first where it has some: an avatar and loose bodies."""

Instants = Mapping[str, Mapping[str, float]]
"""Times [s] of largest figures by scene and metric."""


def page(
    run: Run, checks: Checks, changes: Changes | None, tables: Mapping[str, pd.DataFrame | None], losses: pd.DataFrame,
    stills: Mapping[str, Stills], replayed: Sequence[str], instants: Instants, damage: Sequence[str], files: Sequence[str],
) -> str:
    """Return the page as text. ``tables`` has the keys settings, cases, effects and law; ``replayed`` scenes have a replay."""
    settings, cases, effects, law = (tables[name] for name in ("settings", "cases", "effects", "law"))
    specs = _charts(run, settings, cases, effects, losses)
    lines = curves.dashes([] if law is None else [one for one in main_runs() if one in set(law.run)])
    if law is not None:
        specs |= {name: curves.obtained(law, name, lines) for name in dict.fromkeys(law.law)}
    engines = list(dict.fromkeys(name.partition("/")[0] for name in run.runs))
    payload = {
        "specs": specs,
        "palette": marks.palette({*engines, *([] if settings is None else settings.engine)}),
        "gated": run.gated.partition("/")[0],
        "stills": {name: one.pictures for name, one in stills.items()} or None,
        "instants": {name: one.time for name, one in stills.items()},
        "settings": None if settings is None else by_scene(settings, run),
        "first": None if settings is None else first_scene(settings),
    }
    info: Any = run.results.provenance

    def rows(table: pd.DataFrame) -> list[Any]:
        return list(table.itertuples())

    def place(scene: str, metric: str, name: str = run.gated, beside: str = "") -> str:
        at = moment(run.results, scene, name, metric, instants)
        only = f"only={quote('|'.join(map(run_label, (name, beside))))}" if beside else ""
        return f"scenes/{scene}.html{at}{'&' if at and only else '#' if only else ''}{only}"

    js, vega = "".join(map(scripts.source, ("theme.js", "index.js"))), scripts.vega()
    tables_js, tables_css = scripts.data_tables()
    return scripts.rendered(
        "index.html.j2", f"Contact benchmark: {verdict(checks)}", [vega, js], payload, more="blob:",
        rows=scripts.packed(figures(run).encode()), tables=tables_js, tables_css=tables_css,
        damage=damage, verdict=verdict(checks), sound=checks.is_sound, scenes=run.rows.scenario.nunique(),
        failed=rows(checks.failed), waived=rows(checks.waived), missing=rows(pd.concat([checks.crashed, checks.unmeasured])),
        slow=slow(run), stills=list(stills), replayed=sorted(replayed),
        shown_first=next((name for name in stills if name in run.avatars), ""), strips=strips.strips(run),
        has_settings=settings is not None, has_cases=cases is not None,
        has_left=cases is not None and any(cell["lost"] for cell in specs["hard"]["data"]["values"]),
        has_effects=effects is not None, levels=LEVELS,
        laws=[] if law is None else list(dict.fromkeys(law.law)), lines=lines,
        figures=f"{len(run.rows):,}", files=files, bench="bench.html" in files, commit=str(info.get("commit") or "")[:8],
        machine=f"{info.get('cpus', '')} × {info.get('cpu', '')}",
        versions=" · ".join(map(" ".join, run.versions.items())),
        repeats=dict(info.get("timing") or {}).get("repeats", 3), changes=changes and changes.of(run.gated), place=place,
        lost=rows(losses[losses.lost > 0]), rivals=dict.fromkeys(one.partition("/")[0] for one in run.rivals),
    )


def _charts(
    run: Run, settings: pd.DataFrame | None, cases: pd.DataFrame | None, effects: pd.DataFrame | None, losses: pd.DataFrame
) -> dict[str, marks.Spec]:
    """Return the charts of the page by name; those of tables that the run has not are left out."""
    specs = {
        name: strips.strip(run, chart, f"{chart.title}, a dot per scene.", name == "overlap")
        for name, chart in strips.strips(run).items()
    }
    if settings is not None:
        specs["settings"] = curves.error_against_time(list(dict.fromkeys(settings.engine)))
    if cases is not None:
        specs["hard"] = cells.hard_cases(run, cases)
    if effects is not None:
        specs["effects"] = cells.effects(effects)
    if losses.lost.any():
        specs["losses"] = cells.bars(losses)
    return specs


def verdict(checks: Checks) -> str:
    """Return the verdict in a few words."""
    if len(checks.failed):
        return f"{len(checks.failed)} of {checks.total} checks fail"
    if checks.missing:
        return f"incomplete: {checks.missing} not measured"
    return f"{len(checks.passed)} of {checks.total} checks pass" if checks.finished else "incomplete: the run did not end"


def by_scene(settings: pd.DataFrame, run: Run) -> dict[str, list[dict[str, Any]]]:
    """Return the settings of each scene for the page's script; an error of null does not follow its user."""
    grouped: dict[str, list[dict[str, Any]]] = {}
    for row in settings.itertuples():
        named = {name: getattr(row, name) for name in ("error", "median", "p95", "slowest")}
        numbers = {name: value if math.isfinite(value) else None for name, value in named.items()}
        shown = {"error": quantity(row.error, "m") if math.isfinite(row.error) else "does not follow"}
        shown |= {name: quantity(numbers[name], "us") for name in ("median", "p95", "slowest")}
        flags = {name: bool(getattr(row, name)) for name in ("preset", "asleep", "measured", "few")}
        grouped.setdefault(row.scenario, []).append({
            "engine": row.engine, "label": about(row.engine).label, "setting": row.setting, "base": row.base,
            "step": None if math.isnan(row.step) else round(row.step), "worst": label(row.worst) if row.worst else "",
            "copy": copying.lines(run, row), "alone": bool(row.alone or row.preset), "avatar": row.scenario in run.avatars,
            **numbers, **flags, "shown": shown,
        })
    return grouped


def slow(run: Run) -> list[Any]:
    """Return the scenes that take the gated engine longest: rows of 95th percentiles above SLOW, with the slowest frame."""
    rows = run.rows[(run.rows.run == run.gated) & run.rows.measured].sort_values("value", ascending=False)
    tails, slowest = (rows[rows.metric == f"frame_time_{name}"].drop_duplicates("scenario") for name in ("p95", "max"))
    tails = tails[tails.value > strips.SLOW]
    return list(tails.assign(slowest=tails.scenario.map(slowest.set_index("scenario").value)).itertuples())


def first_scene(settings: pd.DataFrame) -> str:
    """Return the scene with most measured settings, EVERYDAY first."""
    measured = settings[settings.measured].scenario.value_counts().index
    return EVERYDAY if EVERYDAY in measured else str(measured[0] if len(measured) else settings.scenario.iloc[0])


def figures(run: Run) -> str:
    """Return all figures as JSON columns; texts as [distinct texts, place of each row]."""
    rows, columns = run.rows, dict[str, Any]()
    named = rows.assign(
        run=rows.run.map({name: run_label(name) for name in rows.run.unique()}),
        metric=rows.metric.map({m: label(m) for m in rows.metric.unique()}),
        comparable=rows.why.where(rows.why != "", "yes"),
        unit=rows.unit.replace({"us": "µs", "deg": "°"}),
    )
    for name in ("scenario", "run", "metric", "unit", "status", "comparable"):
        kinds = named[name].astype("category")
        columns[name] = [[str(one) for one in kinds.cat.categories], kinds.cat.codes.tolist()]
    for name in ("value", "bound"):
        columns[name] = [None if not math.isfinite(value) else float(f"{value:.{DIGITS}g}") for value in rows[name]]
    return json.dumps(columns, separators=(",", ":"))
