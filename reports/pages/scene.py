"""`scenes/NAME.html`: one scene played in every engine side by side, its charts over time, figures and settings."""

import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pandas as pd

from avatarsim.errors import InvalidFile
from avatarsim.player import three_js
from reports.charts import curves, marks
from reports.drawing.stills import Stills, stills
from reports.pages import scripts
from reports.reading.kept import Drawn, Shown, read_scene, shown
from reports.replay.courses import MEASURES, courses
from reports.replay.moments import instants
from reports.replay.scene import replay
from reports.tables.run import Run
from runfiles.engines import about
from runfiles.metrics import METRICS
from runfiles.native_files import steps_written, written

Task = tuple[str | None, str, str | None]

IN_PARALLEL, CHUNK = 16, 4
"""Scenes from which on pages are made in parallel, as a process takes some three seconds to start; pages it makes at a time."""

UNDRAWABLE = (ArithmeticError, IndexError, KeyError, TypeError, ValueError)
"""Raised where a recording holds something that no picture shows."""


@dataclass(eq=False)
class Played:
    """Drawable parts of a scene.

    replay    data of the replay, None without one
    specs     charts over time by name
    lines     dashes of their lines by run
    stills    for the index, None without them
    instants  times [s] of largest figures by metric
    damage    a sentence for each file that cannot be read or drawn
    """

    replay: Any = None
    specs: Mapping[str, marks.Spec] = field(default_factory=dict)
    lines: Mapping[str, Sequence[int]] = field(default_factory=dict)
    stills: Stills | None = None
    instants: Mapping[str, float] = field(default_factory=dict)
    damage: list[str] = field(default_factory=list)


def scene_pages(run: Run, with_stills: frozenset[str]) -> Iterator[tuple[str, str, Played]]:
    """Make (name, page, parts) of each scene; ``with_stills`` names scenes whose stills the index shows.

    Many pages are made by a process per core, since each reads its recordings. The parts come without replay and charts then."""
    groups = dict(tuple(run.rows.groupby("scenario", sort=False)))
    tasks = list(zip([None, *groups], groups, [*list(groups)[1:], None], strict=False))
    pages = Pages(run, groups, with_stills)
    if len(tasks) < IN_PARALLEL:
        yield from map(pages.made, tasks)
        return
    with ProcessPoolExecutor(os.cpu_count() or 1, get_context("spawn"), _keep, (pages,)) as pool:
        yield from pool.map(_made, tasks, chunksize=CHUNK)


@dataclass(frozen=True, eq=False)
class Pages:
    """Maker of the pages of a run: rows by scene, and the scenes whose stills are wanted."""

    run: Run
    rows: Mapping[str, pd.DataFrame]
    with_stills: frozenset[str]

    def made(self, task: Task) -> tuple[str, str, Played]:
        """Make (name, page, parts) of a scene, by its name between those of its neighbours."""
        before, name, after = task
        rows = self.rows[name]
        seed = int(rows.seed.iloc[0])
        played = _played(self.run, name, rows, seed, name in self.with_stills)
        return name, _page(self.run, name, rows, (before, after), played, seed), played


_PAGES: list[Pages] = []
"""In a process of the pool: the maker of pages, which is sent once."""


def _keep(pages: Pages) -> None:
    _PAGES.append(pages)


def _made(task: Task) -> tuple[str, str, Played]:
    name, page, played = _PAGES[0].made(task)
    return name, page, replace(played, replay=None if played.replay is None else {}, specs={}, lines={})


def _played(run: Run, name: str, rows: pd.DataFrame, seed: int, with_stills: bool) -> Played:
    dt, played = run.results.frame_times.get(name, 1.0 / 60.0), Played()
    series = {one: own for one, own in run.results.series.get(name, {}).items() if not _stands_in(one)}
    runs = [one for one in dict.fromkeys([*series, *rows.run]) if not _stands_in(one)]
    scene, recorded = _files(run.folder, name, runs, seed, played.damage)
    by_run = {one.run: one for one in recorded}
    try:
        played.replay = scene and replay(
            name, scene, recorded, run.gated, {one: own.overlap for one, own in series.items()}
        )
        scripts.data(played.replay)
        played.instants = instants(by_run[run.gated], scene) if run.gated in by_run else {}
        main = [by_run[one] for one in run.runs if one in by_run and not about(one.partition("/")[0]).baseline]
        if with_stills and played.replay and scene and main:
            played.stills = stills(scene, main, run.gated, played.replay["eye"]["azimuth"])
        lines = courses(series, recorded, scene, dt)
    except UNDRAWABLE as error:
        played.damage.append(f"a recording cannot be drawn ({type(error).__name__}: {error})")
        played.replay, lines = None, courses(series, (), None, dt)
    played.lines = curves.dashes([one for one in runs if any(one in by_measure for by_measure in lines.values())])
    played.specs = {
        key: curves.over_time(lines[key], played.lines, unit, f"{title} over time, a line per engine.", floor)
        for key, (title, unit, floor) in MEASURES.items()
        if key in lines
    }
    return played


def _stands_in(run: str) -> bool:
    """Return whether a run is a variant that stands for another preset in some metrics: it shows what that preset shows."""
    engine, _, preset = run.partition("/")
    variant = about(engine).variants.get(preset)
    return variant is not None and bool(variant.of)


def _files(folder: Path, name: str, runs: Sequence[str], seed: int, damage: list[str]) -> tuple[Drawn | None, list[Shown]]:
    """Load the file of the scene and its recordings; ``damage`` gets a sentence without paths for each unreadable one."""
    scene, recorded = None, list[Shown]()
    for run in ("", *runs):
        try:
            if run:
                recorded += shown(folder, name, [run], seed, scene)
            else:
                scene = read_scene(folder, name)
        except InvalidFile as error:
            damage.append(str(error).replace(f"{folder}/", ""))
    return scene, recorded


def _page(
    run: Run, name: str, rows: pd.DataFrame, around: tuple[str | None, str | None], played: Played, seed: int
) -> str:
    runs = [one for one in dict.fromkeys([*run.runs, *rows.run]) if one in set(rows.run)]
    used = [three_js.FILE] * bool(played.replay and three_js.library()) + ["vega.js"] * bool(played.specs) + ["scene.js"]
    return scripts.rendered(
        "scene.html.j2", f"{name} · Contact benchmark", [],
        {"specs": played.specs, "palette": marks.palette({one.partition("/")[0] for one in runs}), "replay": played.replay},
        css=scripts.PLAYER.joinpath("player.css").read_text("utf-8"),
        libraries=[f"../{scripts.LIBRARIES}/{file}" for file in used],
        scene=name, sentence=run.results.titles.get(name, ""), before=around[0], after=around[1], damage=played.damage,
        cut=_cut(run, name, rows),
        has_replay=played.replay is not None,
        charts={key: MEASURES[key][:2] for key in played.specs}, lines=played.lines, runs=runs, figures=_figures(rows),
        gated=run.gated, settings=_settings(run, name, seed),
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
    figures: dict[str, dict[str, Any]] = {
        metric: {} for metric in sorted(worst.metric.unique(), key=lambda one: (one not in METRICS, order.get(one, 0), one))
    }
    for row in worst.itertuples():
        figures[row.metric][row.run] = row
    return figures


def _settings(run: Run, name: str, seed: int) -> list[dict[str, Any]]:
    """Return settings in force, and files in each engine's own words."""
    by_run: dict[str, dict[str, Any]] = {}
    for note in run.results.engines:
        if note.scenario == name and note.settings and note.run not in by_run:
            files = (written(run.folder, name, note.run, seed), *steps_written(run.folder, name, note.run, seed))
            paths = [f"../{path}" for path in files if path]
            by_run[note.run] = {"run": note.run, "version": note.version, "settings": note.settings, "files": paths}
    return list(by_run.values())
