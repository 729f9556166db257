"""`python -m scenarios sweep`: the cells to measure, which are known already, the rest, and the files for the report."""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.running.processes import Workers
from runfiles.csv_rows import csv_text
from runfiles.files import latest, plain, write_text
from scenarios.cli.commands import nothing, say_last
from scenarios.engines import known
from scenarios.results.gate import INCOMPLETE, STOPPED
from scenarios.results.store import Entry, Store
from scenarios.running.cluster import workers_of
from scenarios.running.harness import Offer, offers
from scenarios.running.own_settings import OwnSettings, read
from scenarios.running.processes import side_by_side
from scenarios.running.progress import Estimate
from scenarios.running.seat import Seats
from scenarios.running.telling import errors_of, swept, swept_engines
from scenarios.scenario import Scenario
from scenarios.studies.sweep import clock, limit, measure
from scenarios.studies.sweep.cell import Cell
from scenarios.studies.sweep.grid import applicable, settings_of
from scenarios.studies.sweep.limits_run import converge
from scenarios.studies.sweep.limits_run import table as limits_table
from scenarios.studies.sweep.rows import Row, rows_of, table, with_fronts
from scenarios.studies.sweep.short import ABOUT, ROWS

FOLDER, LIMITS = "sweep", "convergence.csv"
"""Folder of all sweeps below `--out`, which keeps what was found for ever, and the files of rows."""
ERRORS, TIMES = "errors", "times"
"""Kinds of entries in the store."""


def cells_of(
    scenes: dict[str, Scenario], offered: dict[str, Offer], own: Sequence[OwnSettings], asked: argparse.Namespace
) -> list[Cell]:
    """Every setting that can change something in a scene, scene by scene, for engines that can be opened."""
    found = []
    for name, scenario in scenes.items():
        scene = scenario.as_run(asked.full).build()
        for engine, offer in offered.items():
            for setting in settings_of(engine, offer.presets, own):
                if applicable(setting, scene) and (not asked.preset or setting.base in asked.preset):
                    found += [Cell(name, setting, seed, asked.full, asked.frames) for seed in asked.seed[:1]]
    return found


class Sweep:
    """The cells, what is known of each, and the store in which all of it lies."""

    def __init__(self, cells: Sequence[Cell], store: Store) -> None:
        self.cells, self.store = list(cells), store
        self.errors: dict[Cell, Entry] = {}
        self.times: dict[Cell, Entry] = {}
        for cell in self.cells:
            if (found := store.get(ERRORS, cell.key)) is not None:
                self.errors[cell] = found
            if (found := store.get(TIMES, cell.time_key)) is not None:
                self.times[cell] = found
        self.kept = len(self.times)
        """Settings whose times were known before, kept by the hash of the code and the processor."""

    def measure(self, workers: Workers) -> None:
        """Find the errors that are not known."""
        todo = {cell.job.stem: cell for cell in self.cells if cell not in self.errors}
        said = Estimate("errors", len(todo), sys.stderr)
        for job, entry in measure.told(side_by_side(measure.errors, [cell.job for cell in todo.values()], workers)):
            cell = todo[job.stem]
            self.store.put(ERRORS, cell.key, entry)
            self.errors[cell] = entry
            said.step(f"{cell.scenario} {cell.setting.run}: {entry['state']}")

    def clock(self) -> None:
        """Find the times that are not known, scene by scene, of all cells that ran through."""
        ran = [cell for cell in self.cells if self.errors.get(cell, {}).get("state") == "measured"]
        todo = [cell for cell in ran if cell not in self.times]
        said = Estimate("times", len(todo), sys.stderr)

        def done(cell: Cell, entry: Entry) -> None:
            if entry["p50"] is not None:
                self.store.put(TIMES, cell.time_key, entry)
            self.times[cell] = entry
            said.step(f"{cell.scenario} {cell.setting.run}")

        with Seats() as seats:
            for scenario in dict.fromkeys(cell.scenario for cell in todo):
                clock.times([cell for cell in todo if cell.scenario == scenario], seats, done, errors=self.errors)

    def rows(self) -> list[Row]:
        """All that is known so far."""
        found: list[Row] = []
        for cell in self.cells:
            found += rows_of(cell, errors_of(cell.scenario), self.errors.get(cell), self.times.get(cell))
        return with_fronts(found)


def sweep(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """Every scene with every setting: errors side by side, times one by one; what is known already is not asked again."""
    engines = tuple(dict.fromkeys(asked.engine)) or swept_engines(known())
    for name in engines:
        if name not in known():
            raise UnknownName("engine", name, known())
    for option, value, least in (("--jobs", asked.jobs, 0), ("--frames", asked.frames, 1), ("--seed", min(asked.seed), 0)):
        if value is not None and value < least:
            raise InvalidInput(option, value, f"{least} at least")
    if asked.resume is not None:
        raise InvalidInput("--resume", str(asked.resume), "none: what a sweep has found it keeps, and the same command goes on")
    own = read(asked.settings, known(), engines) if asked.settings else ()
    scenes = swept(asked.filter, asked.full)
    if not scenes:
        return nothing(asked)
    offered = offers(engines, asked.jobs)
    absent = {name: offer.trouble for name, offer in offered.items() if offer.trouble}
    folder = asked.out.resolve() / FOLDER
    there, store = {name: offer for name, offer in offered.items() if name not in absent}, Store(folder / "found")
    ran = Sweep(cells_of(scenes, there, own, asked), store)
    code, limits = 0, list[limit.Row]()
    try:
        ran.measure(workers_of(asked))
        ran.clock()
        presets = {name: offer.chosen(asked.preset) for name, offer in there.items()}
        limits = converge([n for n in limit.SCENES if n in scenes], presets, store, asked.jobs, asked.full, asked.frames)
    except KeyboardInterrupt:
        code = STOPPED
        with suppress(OSError):
            # a terminal that was closed takes no words
            print("stopped; what was finished is kept, and the same command goes on from there", file=sys.stderr)
    rows = ran.rows()
    about = {"form": "long", "settings": len(ran.cells), "kept": ran.kept}
    files = {ROWS: csv_text(rows, Row), ABOUT: json.dumps(about) + "\n"}
    files |= {LIMITS: csv_text(limits, limit.Row)} if limits else {}
    # of a sweep that was stopped nothing goes beside the results of a whole run
    written([folder] if code else [folder, *_last_run(asked.out.resolve())], files)
    text = "\n".join(part for part in (table(rows), limits_table(limits)) if part)
    print(json.dumps(plain([asdict(row) for row in rows]), allow_nan=False) if asked.json else text)
    for name, trouble in absent.items():
        print(f"{name} is left out: {trouble}", file=sys.stderr)
    broken = any(row.state == "crashed" and " " not in row.setting for row in rows)
    code = code or (INCOMPLETE if absent or broken else 0)
    # nothing is gated here: code 0 says that all was asked
    say_last(asked, code, folder, "" if code else f"{len(ran.cells)} settings in {len(scenes)} scenes")
    return code


def written(places: Sequence[Path], files: Mapping[str, str]) -> None:
    """Write the files of the sweep into its own folder and, where there is one, into the last comparison, for its report."""
    for place in places:
        for name, text in files.items():
            write_text(place / name, text)


def _last_run(out: Path) -> list[Path]:
    """The folder of the last comparison; none before there is one."""
    return [latest(out)] if latest(out).is_dir() else []
