"""scenes/<name>.html: one scene played again in every engine side by side, its course over time, its rows of the table."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from reports import scripts, three_js
from reports.columns import COLUMNS
from reports.conclusions import CAVEAT
from reports.courses import Course, charts, courses
from reports.kept import Drawn, drawn, shown
from reports.load import Results, Series
from reports.marked import cell_note
from reports.palette import ALARM, GRID, MUTED, TEXT, Stroke, dark_rules
from reports.replay import counts_of, replay
from reports.tables import Block
from reports.verdict import Verdict, believed
from reports.wording import count, limit, quantity, ratio

POINTS = 400
"""Points of a line of a scene's own charts: one per state up to seven seconds."""


@dataclass(frozen=True)
class Neighbours:
    """Names of the scenes before and after, or None at the ends."""

    before: str | None
    after: str | None


@cache
def environment() -> Environment:
    """The templates, with text from outside kept text."""
    return Environment(
        loader=FileSystemLoader(scripts.FOLDER), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True,
    )


def strokes_data(strokes: Mapping[str, Stroke]) -> dict[str, object]:
    """Colours and inks as the scripts want them."""
    dashes = {run: " ".join(map(str, stroke.dash)) if stroke.dash[1] else "" for run, stroke in strokes.items()}
    return {
        "strokes": {run: {"light": stroke.light, "dash": dashes[run]} for run, stroke in strokes.items()},
        "grid": GRID[0], "muted": MUTED[0], "ink": TEXT[0], "alarm": ALARM[0],
    }


@dataclass(frozen=True, eq=False)
class Kept:
    """What the page of a scene is made of: its file, its lines over time, the length of a frame [s], its replay."""

    scene: Drawn | None
    lines: Mapping[str, list[Course]]
    dt: float
    replay: Mapping[str, object] | None


def kept(run_dir: Path, name: str, results: Results, ours: str) -> Kept:
    """Everything that a run kept of a scene. Raises InvalidFile for a damaged file."""
    series: Mapping[str, Series] = results.series.get(name, {})
    runs = list(dict.fromkeys([*series, *(row.run for row in results.of(name))]))
    # with several seeds a page shows the first, as the series do
    seed = next((row.seed for row in results.of(name)), 0)
    scene, recorded = drawn(run_dir, name), shown(run_dir, name, runs, seed)
    depths = {run: one.overlap for run, one in series.items()}
    dt = next((float(one.times[1] - one.times[0]) for one in recorded if len(one.times) > 1), 1.0)
    return Kept(scene, courses(series, recorded, scene), dt, replay(scene, recorded, ours, depths) if scene else None)


def page(block: Block, found: Kept, verdict: Verdict, strokes: Mapping[str, Stroke], around: Neighbours) -> str:
    """The whole page of one scene as text."""
    library = three_js.library() if found.replay else None
    sources = [scripts.source("courses.js")] if found.lines else []
    if library and found.replay:
        sources = [library, scripts.source("replay.js"), *sources]
    drawn_charts = charts(found.lines, found.dt, POINTS)
    replayed = found.replay or {}
    gated = [row for row in (*verdict.failed, *verdict.ceiling, *verdict.held) if row.scenario == block.scene]
    return environment().get_template("scene.html.j2").render(
        block=block, columns=COLUMNS, strokes=strokes, around=around, caveat=CAVEAT, gated=gated,
        believed=lambda row: believed(row, verdict.gated), cell_note=lambda cell: cell_note(cell, verdict.gated),
        quantity=quantity, limit=limit, ratio=ratio, count=count,
        policy=scripts.policy(sources), library=library, words=three_js.WORDS,
        replay=replayed, replay_data=scripts.data(found.replay) if library and found.replay else "",
        states=counts_of(found.replay) if found.replay else 0,
        replay_js=scripts.source("replay.js"), courses_js=scripts.source("courses.js"),
        charts=drawn_charts, courses_data=scripts.data({"scenes": {block.scene: drawn_charts}} | strokes_data(strokes)),
        css=scripts.source("page.css") + scripts.source("scene.css") + dark_rules(),
    )
