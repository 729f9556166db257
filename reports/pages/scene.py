"""`scenes/NAME.html`: one scene played in every engine side by side, its charts over time, figures and settings."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import pandas as pd

from avatarsim.errors import InvalidFile
from reports.charts import curves, marks
from reports.drawing.stills import Stills, stills
from reports.pages import scripts
from reports.pages.index import environment
from reports.reading.kept import Drawn, Shown, drawn, fitting, shown
from reports.replay import three_js
from reports.replay.courses import MEASURES, courses
from reports.replay.moments import instants
from reports.replay.scene import replay
from reports.tables.figures import quantity
from reports.tables.run import Run
from runfiles.engines import about, run_label
from runfiles.metrics import METRICS, label
from runfiles.native_files import steps_written, written

UNDRAWABLE = (ArithmeticError, IndexError, KeyError, TypeError, ValueError)
"""Raised where a recording holds something that no picture shows."""

FOLDER = "scenes"


@dataclass(frozen=True, eq=False)
class Made:
    """A page: its path in the run folder and text; and for the index stills of the scene, and when figures are largest."""

    path: str
    text: str
    scene: str
    stills: Stills | None = None
    instants: Mapping[str, float] = field(default_factory=dict)
    damage: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Files:
    """Readable files of a scene, and a sentence for each that is not."""

    scene: Drawn | None
    shown: Sequence[Shown] = ()
    damage: list[str] = field(default_factory=list)


def scene_pages(run: Run, with_stills: frozenset[str]) -> Iterator[Made]:
    """Make the page of each scene, one after the other; ``with_stills`` names scenes whose stills the index shows."""
    names = list(dict.fromkeys(run.rows.scenario))
    groups = dict(tuple(run.rows.groupby("scenario", sort=False)))
    for k, name in enumerate(names):
        around = names[k - 1] if k else None, names[k + 1] if k + 1 < len(names) else None
        yield _made(run, name, groups[name], around, name in with_stills)


def _made(run: Run, name: str, rows: pd.DataFrame, around: tuple[str | None, str | None], with_stills: bool) -> Made:
    series = run.results.series.get(name, {})
    seed = int(rows.seed.iloc[0])
    files = _files(run.folder, name, list(dict.fromkeys([*series, *rows.run])), seed)
    played, pictures, times = None, None, dict[str, float]()
    dt = run.results.frame_times.get(name, 1.0 / 60.0)
    depths = {one: own.overlap for one, own in series.items()}
    try:
        played = replay(files.scene, files.shown, run.gated, depths) if files.scene else None
        scripts.data(played)
        own = next((one for one in files.shown if one.run == run.gated), None)
        times = dict(instants(own, files.scene)) if own else {}
        shown_runs = {one.run: one for one in files.shown}
        main = [shown_runs[one] for one in run.runs if one in shown_runs and not about(one.partition("/")[0]).baseline]
        if with_stills and played and files.scene and main:
            pictures = stills(files.scene, main, run.gated, float(str(played["azimuth"])))
        lines = courses(series, files.shown, files.scene, dt)
    except UNDRAWABLE as error:
        files.damage.append(f"a recording cannot be drawn ({type(error).__name__}: {error})")
        played, lines = None, courses(series, (), None, dt)
    specs = {
        key: curves.over_time(lines[key], unit, f"{title} over time, a line per engine.", floor)
        for key, (title, unit, floor) in MEASURES.items()
        if key in lines
    }
    text = _page(run, name, rows, around, played, specs, files, seed)
    return Made(f"{FOLDER}/{name}.html", text, name, pictures, times, tuple(f"{name}: {said}" for said in files.damage))


def _files(folder: Path, name: str, runs: Sequence[str], seed: int) -> Files:
    """Load the file of the scene and its recordings; report unreadable ones without paths of this machine."""
    scene, recorded, damage = None, list[Shown](), list[str]()
    try:
        scene = drawn(folder, name)
    except InvalidFile as error:
        damage.append(str(error))
    for run in runs:
        try:
            recorded += [fitting(one, scene) for one in shown(folder, name, [run], seed)]
        except InvalidFile as error:
            damage.append(str(error))
    return Files(scene, recorded, [said.replace(f"{folder}/", "") for said in damage])


@cache
def _libraries() -> tuple[str, str]:
    """Vega and three.js, packed; "" for one that is not installed."""
    three = three_js.library()
    return scripts.packed(scripts.vega().encode()), scripts.packed(_as_module(three).encode()) if three else ""


def _as_module(library: str) -> str:
    """Return a classic script as a module whose declarations stay global."""
    return f"(0, (function () {{ {library}\nif (typeof THREE !== 'undefined') window.THREE = THREE; }}).call(window));"


def _page(
    run: Run,
    name: str,
    rows: pd.DataFrame,
    around: tuple[str | None, str | None],
    played: Any,
    specs: dict[str, Any],
    files: Files,
    seed: int,
) -> str:
    vega, three = _libraries()
    runs = [one for one in dict.fromkeys([*run.runs, *rows.run]) if one in set(rows.run)]
    playable = played is not None and three != ""
    sources = ["theme.js", "quantity.js", *(["gif.js", "replay.js"] if playable else []), "scene.js"]
    js = "".join(map(scripts.source, sources))
    extra = {one.partition("/")[0]: (about(one.partition("/")[0]).colour, about(one.partition("/")[0]).dark) for one in runs}
    libraries = {**({"three": three} if playable else {}), **({"vega": vega} if specs else {})}
    return (
        environment()
        .get_template("scene.html.j2")
        .render(
            policy=scripts.policy([js], " blob:"),
            css=scripts.source("base.css") + scripts.source("scene.css"),
            js=js,
            libraries=libraries,
            data=scripts.data({"specs": specs, "palette": marks.palette(extra), "replay": played if playable else None}),
            scene=name,
            title=run.results.titles.get(name, ""),
            before=around[0],
            after=around[1],
            damage=files.damage,
            cut=_cut(run, name, rows),
            replay=played if playable else None,
            states=max((run["frames"] for run in played["runs"]), default=0) if played else 0,
            no_replay=three_js.WORDS if played and not three else "Nothing was recorded.",
            charts={key: MEASURES[key][:2] for key in specs},
            runs=runs,
            labels={one: run_label(one) for one in runs},
            colours={one: about(one.partition("/")[0]).both for one in runs},
            figures=_figures(run, rows, runs),
            settings=_settings(run, name, seed),
        )
    )


def _cut(run: Run, name: str, rows: pd.DataFrame) -> str:
    """Return the simulated and the whole length of a scene that was cut short, "" for others."""
    whole, ran = run.results.lengths.get(name), int(rows.frames.max())
    dt = run.results.frame_times.get(name, 1.0 / 60.0)
    return f"Cut short: {ran * dt:.3g} s of {whole * dt:.3g} s." if whole and 0 < ran < whole else ""


def _figures(run: Run, rows: pd.DataFrame, runs: Sequence[str]) -> list[dict[str, Any]]:
    """A row per metric in the order of the registry: ranked ones first."""
    order = {metric: k for k, metric in enumerate(METRICS)}
    best = rows[rows.measured].sort_values("value", na_position="last").drop_duplicates(["run", "metric"], keep="last")
    cells = {(row.run, row.metric): row for row in best.itertuples()}
    found = []
    for metric in sorted(best.metric.unique(), key=lambda one: (one not in METRICS, order.get(one, 0), one)):
        row: dict[str, Any] = {"label": label(metric), "limit": "", "outcome": "", "cells": []}
        for one in runs:
            cell = cells.get((one, metric))
            row["cells"].append(
                {"text": "–", "why": "", "bad": False}
                if cell is None
                else {
                    "text": quantity(cell.value, cell.unit) if cell.value == cell.value else "NaN",
                    "why": cell.why,
                    "bad": one == run.gated and cell.bound == cell.bound and not cell.value <= cell.bound,
                }
            )
        own = cells.get((run.gated, metric))
        if own is not None and own.bound == own.bound:
            limit = own.waiver if own.waiver == own.waiver else own.bound
            row["limit"] = quantity(own.bound, own.unit)
            row["outcome"] = "pass" if own.value <= own.bound else "waived" if own.value <= limit else "fail"
        found.append(row)
    return found


def _settings(run: Run, name: str, seed: int) -> list[dict[str, Any]]:
    """Settings in force, and files in each engine's own words."""
    found: dict[str, dict[str, Any]] = {}
    for note in run.results.engines:
        if note.scenario == name and note.settings and note.run not in found:
            path = written(run.folder, name, note.run, seed)
            found[note.run] = {
                "run": note.run,
                "version": note.version,
                "settings": note.settings,
                "native": f"../{path}" if path else "",
                "steps": [f"../{one}" for one in steps_written(run.folder, name, note.run, seed)],
            }
    return list(found.values())
