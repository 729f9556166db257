"""`index.html`: the page of a comparison."""

import json
import math
from collections.abc import Collection, Mapping, Sequence
from functools import cache
from typing import Any

import pandas as pd
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from reports.charts import cells, curves, marks, strips
from reports.drawing.stills import Stills
from reports.pages import scripts
from reports.replay.moments import moment
from reports.tables.changes import Changes
from reports.tables.checks import Checks
from reports.tables.figures import quantity
from reports.tables.run import Run
from reports.tables.settings import LEVELS
from runfiles.engines import about, run_label
from runfiles.metrics import label

DIGITS = 4
"""Significant digits of the figures in the table of the page; results.csv has all."""


@cache
def environment() -> Environment:
    """The templates; text from outside stays text."""
    return Environment(
        loader=FileSystemLoader(scripts.FOLDER), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )


def linked(run: Run, rows: pd.DataFrame, instants: Mapping[str, Mapping[str, float]]) -> list[dict[str, str]]:
    """Return rows of checks as text, each with the address of its moment."""
    return [
        {
            "scene": row.scenario,
            "run": run_label(row.run),
            "label": label(row.metric),
            "value": quantity(row.value, row.unit) if row.value == row.value else "NaN",
            "limit": quantity(row.bound, row.unit),
            "waiver": quantity(row.waiver, row.unit),
            "href": f"scenes/{row.scenario}.html{moment(run.results, row.scenario, row.run, row.metric, instants)}",
        }
        for row in rows.itertuples()
    ]


def missing(checks: Checks) -> list[dict[str, str]]:
    """Return runs and figures that were not measured, as text."""
    rows = pd.concat([checks.crashed, checks.unmeasured])
    return [
        {
            "scene": row.scenario,
            "run": run_label(row.run),
            "label": "" if row.metric == "run" else label(row.metric),
            "note": row.note,
        }
        for row in rows.itertuples()
    ]


def page(
    run: Run,
    checks: Checks,
    changes: Changes | None,
    tables: Mapping[str, pd.DataFrame | None],
    losses: pd.DataFrame,
    stills: Mapping[str, Stills],
    instants: Mapping[str, Mapping[str, float]],
    damage: Sequence[str],
    files: Sequence[str],
) -> str:
    """Return the page as text. ``tables`` has the keys settings, cases and effects."""
    settings = tables["settings"]
    specs: dict[str, Any] = {
        name: strips.strip(run, chart, f"{chart.title}, a dot per scene.", name == "overlap")
        for name, chart in strips.STRIPS.items()
    }
    engines = list(dict.fromkeys(name.partition("/")[0] for name in run.runs))
    if settings is not None:
        specs["settings"] = curves.error_against_time(list(dict.fromkeys(settings.engine)))
    if tables["cases"] is not None:
        specs["hard"] = cells.hard_cases(run, tables["cases"])
    if tables["effects"] is not None:
        specs["effects"] = cells.effects(tables["effects"])
    specs["losses"] = cells.bars(losses)
    extra = {name: (about(name).colour, about(name).dark) for name in {*engines, *([] if settings is None else settings.engine)}}
    payload = {
        "specs": specs,
        "palette": marks.palette(extra),
        "gated": run.gated.partition("/")[0],
        "stills": {name: one.pictures for name, one in stills.items()} or None,
        "instants": {name: one.time for name, one in stills.items()},
        "settings": None if settings is None else by_scene(settings, run.avatars),
        "first": None if settings is None else first_scene(settings),
    }
    info, js = run.results.provenance, "".join(map(scripts.source, ("theme.js", "quantity.js", "index.js")))
    content = scripts.data(payload)
    packed, (tables_js, tables_css) = scripts.packed(figures(run).encode()), scripts.data_tables()
    versions: Any = info.get("versions") or {}
    timing: Any = info.get("timing") or {}
    return (
        environment()
        .get_template("index.html.j2")
        .render(
            policy=scripts.policy([scripts.vega(), js], " blob:"),
            css=scripts.source("base.css"),
            vega=scripts.vega(),
            js=js,
            data=content,
            rows=packed,
            tables=tables_js,
            tables_css=tables_css,
            damage=damage,
            verdict=verdict(checks),
            sound=checks.is_sound,
            scenes=run.rows.scenario.nunique(),
            failed=linked(run, checks.failed, instants),
            waived=linked(run, checks.waived, instants),
            missing=missing(checks),
            stills=list(stills),
            shown_first=next((name for name in stills if name in run.avatars), ""),
            titles={name: (chart.title, chart.subtitle) for name, chart in strips.STRIPS.items()},
            has_settings=settings is not None,
            has_cases=tables["cases"] is not None,
            has_effects=tables["effects"] is not None,
            levels=LEVELS,
            figures=f"{len(run.rows):,}",
            files=files,
            bench="bench.html" in files,
            commit=str(info.get("commit", ""))[:8],
            machine=f"{info.get('cpus', '')} × {info.get('cpu', '')}",
            versions=" · ".join(f"{about(name).label} {version}" for name, version in versions.items() if name in engines),
            repeats=timing.get("repeats", 3),
            **change_words(run, changes, instants),
        )
    )


def verdict(checks: Checks) -> str:
    """Return the verdict in a few words."""
    if len(checks.failed):
        return f"{len(checks.failed)} of {checks.total} checks fail"
    missing = len(checks.crashed) + len(checks.unmeasured)
    if missing:
        return f"incomplete: {missing} not measured"
    if not checks.finished:
        return "incomplete: the run did not end"
    return f"{len(checks.passed)} of {checks.total} checks pass"


def change_words(run: Run, changes: Changes | None, instants: Mapping[str, Mapping[str, float]]) -> dict[str, Any]:
    """Return what the template shows of changes of the gated engine."""
    if changes is None:
        return {"changed": None, "worse": 0, "better": 0, "since": "", "no_times": ""}
    own = changes.of(run.gated)
    rows = [
        {
            "verdict": row.verdict,
            "scene": row.scenario,
            "label": label(row.metric),
            "old": quantity(row.old, row.unit) if math.isfinite(row.old) else "NaN",
            "new": quantity(row.new, row.unit) if math.isfinite(row.new) else "missing",
            "factor": f"×{row.new / row.old:.3g}" if row.old > 0.0 and math.isfinite(row.new / row.old) else "",
            "href": f"scenes/{row.scenario}.html{moment(run.results, row.scenario, row.run, row.metric, instants)}",
        }
        for row in own.table.itertuples()
    ]
    return {
        "changed": rows,
        "worse": own.count("worse"),
        "better": own.count("better"),
        "since": own.since,
        "no_times": own.no_times,
    }


def by_scene(settings: pd.DataFrame, avatars: Collection[str]) -> dict[str, list[dict[str, Any]]]:
    """Return the settings of each scene for the page's script; an error of null does not follow its user."""
    found: dict[str, list[dict[str, Any]]] = {}
    for row in settings.itertuples():
        found.setdefault(row.scenario, []).append(
            {
                "engine": row.engine,
                "label": about(row.engine).label,
                "setting": row.setting,
                "preset": bool(row.preset),
                "base": row.base,
                "step": None if math.isnan(row.step) else round(row.step),
                "error": row.error if math.isfinite(row.error) else None,
                "worst": label(row.worst) if row.worst else "",
                "median": None if math.isnan(row.median) else row.median,
                "p95": None if math.isnan(row.p95) else row.p95,
                "asleep": bool(row.asleep),
                "measured": bool(row.measured),
                "native": row.native,
                "alone": bool(row.alone),
                "options": row.options,
                "avatar": row.scenario in avatars,
            }
        )
    return found


def first_scene(settings: pd.DataFrame) -> str:
    """Return the scene with most measured settings, one with an avatar and loose bodies first: hands over tables."""
    measured = settings[settings.measured].scenario.value_counts()
    return (
        "hand_over_table"
        if "hand_over_table" in measured.index
        else str(measured.index[0] if len(measured) else settings.scenario.iloc[0])
    )


def figures(run: Run) -> str:
    """Return all figures as JSON columns; texts as [distinct texts, place of each row]."""
    rows, columns = run.rows, dict[str, Any]()
    named = rows.assign(
        run=rows.run.map({name: run_label(name) for name in rows.run.unique()}),
        metric=rows.metric.map({m: label(m) for m in rows.metric.unique()}),
        comparable=rows.why.where(rows.why != "", "yes"),
    )
    named["unit"] = named.unit.replace({"us": "µs", "deg": "°"})
    for name in ("scenario", "run", "metric", "unit", "status", "comparable"):
        kinds = named[name].astype("category")
        columns[name] = [[str(one) for one in kinds.cat.categories], kinds.cat.codes.tolist()]
    for name in ("value", "bound"):
        columns[name] = [None if not math.isfinite(value) else float(f"{value:.{DIGITS}g}") for value in rows[name]]
    return json.dumps(columns, separators=(",", ":"))
