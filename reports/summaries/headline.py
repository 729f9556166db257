"""The table of the README: from a run to a small committed file, from that file to the words between two marks. Never by hand."""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from avatarsim.errors import InvalidFile
from reports.deciding.columns import COLUMNS, Column
from reports.deciding.tables import Block, Cell, blocks, together
from reports.reading.load import Results
from reports.words import timing_words
from reports.words.wording import MISSING, quantity
from runfiles.csv_rows import lines
from runfiles.naming import UNSEEN_PREFIX
from runfiles.timing_protocol import brief

BEGINS, ENDS = "<!-- headline: written by `python -m reports headline` -->", "<!-- end of headline -->"
HEAD = ("scene", "measure", "unit", "run", "value", "best")
MEASURES = {
    "overlap": "overlap", "truth": "error to closed form", "offset": "offset from the user",
    "chatter": "frames in contact that shake", "p50": "frame time", "python": "as called from Python",
}
"""Columns of the verdict table that the README shows, and what they are called there."""
ROOMS = "motion not tuned for, worst of {} rooms"
"""What the last rows of the table are called: clips recombined by a seed drawn from the commit."""
IN_ROOMS = ("overlap", "offset", "chatter")
"""Columns of the verdict table in those rows: times would be the worst of scenes that differ."""
LEFT_OUT = (
    "Joint limits are not in this table: our adapters make ball joints without all limits of swing and twist (MuJoCo limits "
    "their whole turn, Bullet swing and twist in URDF files alone), and three limited hinges in their place limit other angles; "
    "the report has the figures."
)
"""Why a measure of the verdict table is missing here. With hinges at angles a and b across the limb, the twist about it is off
by 2 atan(tan(a / 2) tan(b / 2)), 19 degrees at 45, and the second hinge locks at 90 degrees, inside the cone of a shoulder."""
ROUNDING = 1e-9
"""Smaller figures, in any unit of the table, are rounding of numbers of everyday size, and are written as 0."""
CLOCK, ELSEWHERE = "clock", "busy elsewhere"
"""Facts about the machine, by the names that they have in the file."""
ABOUT = "about"
"""Scene of the lines that say where the figures come from."""
DAY = len("2026-11-24")
"""Characters of a time in ISO 8601 that say the day."""
UNKNOWN = "unknown"
"""Stands for what a run did not keep."""
SHORT_COMMIT = 12
"""Characters of a commit's hash that are printed: enough to be the only one that begins so."""


@dataclass(frozen=True)
class Figure:
    """One number of the headline table, or one fact about the run (scene ABOUT, the fact in `run`)."""

    scene: str
    measure: str
    unit: str
    run: str
    value: float | None
    best: bool


def origin(results: Results, run: str) -> dict[str, str]:
    """Where the figures and pictures of the README come from: the name of the `run`, its day, and the commit that ran."""
    started, commit = results.provenance.get("started"), results.provenance.get("commit")
    return {"run": run, "commit": str(commit or UNKNOWN), "date": str(started or UNKNOWN)[:DAY]}


def numbers(results: Results, run: str = "") -> str:
    """The committed file for a run, which it names where the `run` has a name: every engine in its everyday scenes; in all its
    scenes where it has none of those."""
    written = io.StringIO()
    writer = csv.writer(written, lineterminator="\n")
    writer.writerow(HEAD)
    for name, text in origin(results, run).items() if run else ():
        writer.writerow([ABOUT, name, "", text, "", ""])
    for name, text in _facts(results.provenance):
        writer.writerow([ABOUT, name, "", text, "", ""])
    for figure in _shown(results):
        value = "" if figure.value is None else "0" if abs(figure.value) < ROUNDING else f"{figure.value:.4g}"
        writer.writerow([figure.scene, figure.measure, figure.unit, figure.run, value, "best" if figure.best else ""])
    return written.getvalue()


def _shown(results: Results) -> list[Figure]:
    """Every everyday scene, or every scene of a run without any; then the rooms of unseen motions as one."""
    found = [figure for block in blocks(results) if block.scene in results.everyday or not results.everyday
             for figure in _figures(block, tuple(MEASURES))]
    rooms = {row.scenario for row in results.rows if row.scenario.startswith(UNSEEN_PREFIX)
             and results.family(row.scenario) == row.scenario}
    return found + (_figures(together(results, rooms, ROOMS.format(len(rooms))), IN_ROOMS) if rooms else [])


def _facts(provenance: Mapping[str, object]) -> list[tuple[str, str]]:
    versions = provenance.get("versions")
    known = dict(versions) if isinstance(versions, Mapping) else {}
    facts = {"cpu": provenance.get("cpu"), "cpus": provenance.get("cpus"), "Python": provenance.get("python"),
             "MuJoCo": known.get("mujoco"), "PyBullet": known.get("pybullet"), **_machine(provenance)}
    return [(name, str(value)) for name, value in facts.items() if value is not None]


def _machine(provenance: Mapping[str, object]) -> dict[str, object]:
    """Clock, and how many processors other work kept busy while frames were timed; None where it is not known."""
    timing = timing_words.record(provenance)
    clock = timing.get("mhz", provenance.get("mhz"))
    return {CLOCK: None if clock is None else f"{clock} MHz", ELSEWHERE: timing.get("busy_elsewhere")}


def _called(column: Column, cells: Sequence[Cell]) -> str:
    """What a measure is called: a time with its repeats and frames, which are the same for every engine of a scene."""
    notes = [cell.row.note for cell in cells if column.unit == "us" and cell.row and cell.row.note and cell.value is not None]
    how = brief(notes[0]).partition(";")[0] if notes else ""
    return f"{MEASURES[column.key]}, {how}" if how else MEASURES[column.key]


def _figures(block: Block, measures: Sequence[str]) -> list[Figure]:
    found = []
    for index, column in enumerate(COLUMNS):
        if column.key in measures:
            cells = [(line.run, line.cells[index]) for line in block.lines]
            if any(cell.value is not None and not run.startswith("tracker/") for run, cell in cells):
                unit = next((cell.row.unit for _, cell in cells if cell.row), column.unit)
                called = _called(column, [cell for _, cell in cells])
                found += [Figure(block.scene, called, unit, run, cell.value, cell.best) for run, cell in cells]
    return found


def load(path: Path) -> tuple[Figure, ...]:
    """The committed file. Raises InvalidFile when it is damaged or empty."""
    def figure(row: Mapping[str, str]) -> Figure:
        value = float(row["value"]) if row["value"] else None
        if value is not None and not math.isfinite(value):
            value = math.nan
        return Figure(row["scene"], row["measure"], row["unit"], row["run"], value, row["best"] == "best")

    found = lines(path, figure)
    if not found:
        raise InvalidFile(str(path), "no row", "a file that `python -m reports headline` wrote")
    return found


def block(figures: Sequence[Figure]) -> str:
    """The words between the marks, as Markdown: where the figures come from, then the table. The best stands in bold."""
    facts = {figure.measure: figure.run for figure in figures if figure.scene == ABOUT}
    shown = [figure for figure in figures if figure.scene != ABOUT]
    runs = tuple(dict.fromkeys(figure.run for figure in shown if not figure.run.startswith("tracker/")))
    clock = f" at {facts[CLOCK]}" if CLOCK in facts else ""
    said = [f"{facts.get('cpus', 'some')} cores of {facts.get('cpu', 'an unknown processor')}{clock}"]
    said += [f"{name} {facts[name]}" for name in ("Python", "MuJoCo", "PyBullet") if name in facts]
    table = ["| scene | | " + " | ".join(runs) + " | raw tracker |", "|---|---|" + "---:|" * (len(runs) + 1)]
    for scene in dict.fromkeys(figure.scene for figure in shown):
        own = [figure for figure in shown if figure.scene == scene]
        for place, measure in enumerate(dict.fromkeys(figure.measure for figure in own)):
            by_run = {figure.run: figure for figure in own if figure.measure == measure}
            raw = next((_text(figure) for run, figure in by_run.items() if run.startswith("tracker/")), MISSING)
            cells = [_text(by_run[run]) if run in by_run else MISSING for run in runs]
            table.append(f"| {scene if place == 0 else ''} | {measure} | {' | '.join(cells)} | {raw} |")
    load = f"; other work kept {facts[ELSEWHERE]} cores busy while frames were timed" if ELSEWHERE in facts else ""
    return "\n".join([f"Measured on {', '.join(said)}{load}.", "", *table, "", LEFT_OUT])


def _text(figure: Figure) -> str:
    text = quantity(figure.value, figure.unit)
    return f"**{text}**" if figure.best else text


def replaced(readme: str, words: str) -> str:
    """The README with `words` between its marks. Raises InvalidFile when it has not exactly one pair of them, in order."""
    before, begins, rest = readme.partition(BEGINS)
    _, ends, after = rest.partition(ENDS)
    if not begins or not ends or BEGINS in rest or ENDS in after:
        raise InvalidFile("README.md", "no marks for the table, or several", f"{BEGINS} and {ENDS}, once each")
    return f"{before}{BEGINS}\n{words}\n{ENDS}{after}"


def facts_of(figures: Sequence[Figure]) -> dict[str, str]:
    """What the committed file says of the run behind its figures, by name."""
    return {figure.measure: figure.run for figure in figures if figure.scene == ABOUT}


def told(figures: Sequence[Figure]) -> str:
    """What stands between the README's marks: the run behind table and pictures where the committed file names one, then the
    words of `block`."""
    facts = facts_of(figures)
    if "run" not in facts:
        return block(figures)
    commit = facts.get("commit", UNKNOWN)
    named = f"commit `{commit[:SHORT_COMMIT]}`" if commit != UNKNOWN else "an unknown commit"
    when = facts.get("date", "an unknown day")
    return f"Table and pictures are of one run, `{facts['run']}`, at {named}, on {when}.\n\n{block(figures)}"
