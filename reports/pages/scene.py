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
from reports.reading.kept import Drawn, Shown, drawn, shown
from reports.replay import three_js
from reports.replay.courses import MEASURES, courses
from reports.replay.moments import instants
from reports.replay.scene import replay
from reports.tables.run import Run
from runfiles.engines import about
from runfiles.metrics import METRICS
from runfiles.native_files import steps_written, written

UNDRAWABLE = (ArithmeticError, IndexError, KeyError, TypeError, ValueError)
"""Raised where a recording holds something that no picture shows."""


@dataclass(eq=False)
class Played:
    """Drawable parts of a scene.

    replay    data of the replay, None without one
    specs     charts over time by name
    stills    for the index, None without them
    instants  times [s] of largest figures by metric
    damage    a sentence for each file that cannot be read or drawn
    """

    replay: Any = None
    specs: Mapping[str, marks.Spec] = field(default_factory=dict)
    stills: Stills | None = None
    instants: Mapping[str, float] = field(default_factory=dict)
    damage: list[str] = field(default_factory=list)


def scene_pages(run: Run, with_stills: frozenset[str]) -> Iterator[tuple[str, str, Played]]:
    """Make (name, page, parts) of each scene, one by one; ``with_stills`` names scenes whose stills the index shows."""
    groups = dict(tuple(run.rows.groupby("scenario", sort=False)))
    names = list(groups)
    for before, name, after in zip([None, *names], names, [*names[1:], None], strict=False):
        seed = int(groups[name].seed.iloc[0])
        played = _played(run, name, groups[name], seed, name in with_stills)
        yield name, _page(run, name, groups[name], (before, after), played, seed), played


def _played(run: Run, name: str, rows: pd.DataFrame, seed: int, with_stills: bool) -> Played:
    series, dt, found = run.results.series.get(name, {}), run.results.frame_times.get(name, 1.0 / 60.0), Played()
    scene, recorded = _files(run.folder, name, list(dict.fromkeys([*series, *rows.run])), seed, found.damage)
    by_run = {one.run: one for one in recorded}
    try:
        found.replay = replay(scene, recorded, run.gated, {one: own.overlap for one, own in series.items()}) if scene else None
        scripts.data(found.replay)
        found.instants = instants(by_run[run.gated], scene) if run.gated in by_run else {}
        main = [by_run[one] for one in run.runs if one in by_run and not about(one.partition("/")[0]).baseline]
        if with_stills and found.replay and scene and main:
            found.stills = stills(scene, main, run.gated, found.replay["azimuth"])
        lines = courses(series, recorded, scene, dt)
    except UNDRAWABLE as error:
        found.damage.append(f"a recording cannot be drawn ({type(error).__name__}: {error})")
        found.replay, lines = None, courses(series, (), None, dt)
    found.specs = {
        key: curves.over_time(lines[key], unit, f"{title} over time, a line per engine.", floor)
        for key, (title, unit, floor) in MEASURES.items()
        if key in lines
    }
    return found


def _files(folder: Path, name: str, runs: Sequence[str], seed: int, damage: list[str]) -> tuple[Drawn | None, list[Shown]]:
    """Load the file of the scene and its recordings; ``damage`` gets a sentence without paths for each unreadable one."""
    scene, recorded = None, list[Shown]()
    for run in ("", *runs):
        try:
            if run:
                recorded += shown(folder, name, [run], seed, scene)
            else:
                scene = drawn(folder, name)
        except InvalidFile as error:
            damage.append(str(error).replace(f"{folder}/", ""))
    return scene, recorded


@cache
def _libraries() -> dict[str, str]:
    """Return three.js, where it is installed, and Vega, packed."""
    three = three_js.library()
    # a classic script as a module whose declarations stay global
    module = f"(0, (function () {{ {three}\nif (typeof THREE !== 'undefined') window.THREE = THREE; }}).call(window));"
    return {"three": scripts.packed(module.encode()) if three else "", "vega": scripts.packed(scripts.vega().encode())}


def _page(
    run: Run, name: str, rows: pd.DataFrame, around: tuple[str | None, str | None], played: Played, seed: int
) -> str:
    runs = [one for one in dict.fromkeys([*run.runs, *rows.run]) if one in set(rows.run)]
    packed = _libraries()
    shown = played.replay if packed["three"] else None
    sources = ["theme.js", *(["gif.js", "replay.js"] if shown else []), "scene.js"]
    palette = marks.palette({one.partition("/")[0] for one in runs})
    return scripts.rendered(
        "scene.html.j2", f"{name} · Contact benchmark", ["".join(map(scripts.source, sources))],
        {"specs": played.specs, "palette": palette, "replay": shown}, css=["scene.css"], more=" blob:",
        libraries={key: packed[key] for key, used in (("three", shown), ("vega", played.specs)) if used},
        scene=name, sentence=run.results.titles.get(name, ""), before=around[0], after=around[1], damage=played.damage,
        cut=_cut(run, name, rows), replay=shown, states=max(one["frames"] for one in shown["runs"]) if shown else 0,
        no_replay="Nothing was recorded." if packed["three"] or not played.replay else three_js.WORDS,
        charts={key: MEASURES[key][:2] for key in played.specs}, runs=runs, figures=_figures(rows), gated=run.gated,
        settings=_settings(run, name, seed),
    )


def _cut(run: Run, name: str, rows: pd.DataFrame) -> str:
    """Return the simulated and the whole length of a scene that was cut short, "" for others."""
    whole, ran = run.results.lengths.get(name), int(rows.frames.max())
    dt = run.results.frame_times.get(name, 1.0 / 60.0)
    return f"Cut short: {ran * dt:.3g} s of {whole * dt:.3g} s." if whole and 0 < ran < whole else ""


def _figures(rows: pd.DataFrame) -> dict[str, dict[str, Any]]:
    """Return the worst row of each run by metric, in the order of the registry: ranked ones first."""
    order = {metric: k for k, metric in enumerate(METRICS)}
    worst = rows[rows.measured].sort_values("value", na_position="last").drop_duplicates(["run", "metric"], keep="last")
    found: dict[str, dict[str, Any]] = {
        metric: {} for metric in sorted(worst.metric.unique(), key=lambda one: (one not in METRICS, order.get(one, 0), one))
    }
    for row in worst.itertuples():
        found[row.metric][row.run] = row
    return found


def _settings(run: Run, name: str, seed: int) -> list[dict[str, Any]]:
    """Return settings in force, and files in each engine's own words."""
    found: dict[str, dict[str, Any]] = {}
    for note in run.results.engines:
        if note.scenario == name and note.settings and note.run not in found:
            files = (written(run.folder, name, note.run, seed), *steps_written(run.folder, name, note.run, seed))
            paths = [f"../{path}" for path in files if path]
            found[note.run] = {"run": note.run, "version": note.version, "settings": note.settings, "files": paths}
    return list(found.values())
