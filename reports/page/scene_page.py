"""`scenes/<name>.html`: one scene played again in every engine side by side, its course over time, its rows of the table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from avatarsim.errors import InvalidFile
from reports.deciding.columns import COLUMNS
from reports.deciding.conclusions import CAVEAT, asleep_sentence
from reports.deciding.cut_short import scene_sentence
from reports.deciding.marked import cell_note
from reports.deciding.moments import Instants, instants
from reports.deciding.tables import RAW_TRACKER, Block, engine_of
from reports.deciding.verdict import Verdict, believed
from reports.drawing.charts import Panel
from reports.drawing.palette import ALARM, GRID, MUTED, TEXT, Stroke, dark_rules
from reports.drawing.thumbnail import telling, thumbnail
from reports.page import scripts
from reports.page.as_run import AsRun, as_run
from reports.page.extra_sections import UNDRAWABLE
from reports.page.finished import labelled
from reports.page.gallery import Picture
from reports.reading.kept import Drawn, Shown, drawn, fitting, shown
from reports.reading.load import Results, Series
from reports.replay import three_js
from reports.replay.courses import Course, charts, courses
from reports.replay.scene import MOST_FRAMES, counts_of, replay
from reports.sections.your_project import grasped
from reports.words.metric_words import words
from reports.words.wording import count, limit, quantity, ratio
from runfiles.timing_protocol import repeats_of

POINTS = MOST_FRAMES
"""Points of a line of a scene's own charts, as many as states are drawn beside them."""


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
    """What the page of a scene is made of: its file, its lines over time, the length of a frame [s], its replay, its picture, the
    settings in force; `damage` is a sentence for each file that could not be used, and is left out; `grasped` says where what
    hands close on ends, `cut` how much of the scene ran where it was cut short, `instants` when figures of our engine are
    largest, `repeats` how often the frames of its times were run, 0 where that is not known."""

    scene: Drawn | None
    lines: Mapping[str, list[Course]]
    dt: float
    replay: Mapping[str, object] | None
    picture: Picture
    settings: Sequence[AsRun]
    damage: tuple[str, ...] = ()
    grasped: str = ""
    cut: str = ""
    instants: Instants = Instants()
    repeats: int = 0


def kept(run_dir: Path, name: str, results: Results, ours: str) -> Kept:
    """Everything that a run kept of a scene and that can be used."""
    series: Mapping[str, Series] = results.series.get(name, {})
    runs = list(dict.fromkeys([*series, *(row.run for row in results.of(name))]))
    # with several seeds a page shows the first, as the series do
    seed = next((row.seed for row in results.of(name)), 0)
    scene, recorded, damage = _readable(run_dir, name, runs, seed)
    depths = {run: one.overlap for run, one in series.items()}
    dt = next((float(one.times[1] - one.times[0]) for one in recorded if len(one.times) > 1), 1.0)
    settings, cut = as_run(run_dir, results, name, seed), scene_sentence(results, name)
    repeats = max((repeats_of(row.note) for row in results.of(name) if row.metric == "frame_time_p50"), default=0)
    try:
        replayed = replay(scene, recorded, ours, depths) if scene else None
        # what cannot be written into the page is noticed here
        scripts.data(replayed)
        lines, picture = courses(series, recorded, scene), _picture(name, scene, recorded, ours, series, replayed)
        own = next((one for one in recorded if one.run == ours), None)
        times = instants(own, scene) if own else Instants()
    except UNDRAWABLE as error:
        said = f"what was recorded cannot be drawn ({type(error).__name__}: {error})"
        return Kept(None, courses(series, (), None), dt, None, Picture("", 0.0), settings, (*damage, said), cut=cut,
                    repeats=repeats)
    return Kept(scene, lines, dt, replayed, picture, settings, damage, grasped(results.of(name)), cut, times, repeats)


def _readable(run_dir: Path, name: str, runs: Sequence[str], seed: int) -> tuple[Drawn | None, list[Shown], tuple[str, ...]]:
    """The file of a scene and its recordings, so far as they can be used, and a sentence for each that cannot."""
    scene, recorded, damage = None, list[Shown](), list[str]()
    try:
        scene = drawn(run_dir, name)
    except InvalidFile as error:
        damage.append(str(error))
    for run in runs:
        try:
            recorded += [fitting(one, scene) for one in shown(run_dir, name, [run], seed)]
        except InvalidFile as error:
            damage.append(str(error))
    # pages travel: where the run lay on this machine is nothing to others
    return scene, recorded, tuple(said.replace(f"{run_dir}/", "") for said in damage)


def _picture(
    name: str, scene: Drawn | None, recorded: Sequence[Shown], ours: str, series: Mapping[str, Series],
    replayed: Mapping[str, object] | None,
) -> Picture:
    """The scene at its telling instant, as our engine shows it; as another does where ours shows nothing, such as in a scene
    that ours refuses."""
    engines = [one for one in recorded if engine_of(one.run) != RAW_TRACKER]
    if scene is None or replayed is None or not engines:
        return Picture("", 0.0)
    main = next((one for one in engines if one.run == ours), engines[0])
    raw = next((one for run, one in series.items() if engine_of(run) == RAW_TRACKER), None)
    state = telling(main, raw)
    time = float(main.times[state])
    label = f"The scene {name} at {time:.3g} s, as {main.run} shows it."
    return Picture(thumbnail(scene, main, state, float(str(replayed["azimuth"])), label), time)


def page(
    block: Block, found: Kept, verdict: Verdict, strokes: Mapping[str, Stroke], around: Neighbours, panels: Sequence[Panel] = (),
) -> str:
    """The whole page of one scene as text; `panels`: its static charts."""
    library = three_js.library() if found.replay else None
    sources = [scripts.source("courses.js")] if found.lines else []
    if library and found.replay:
        sources = [library, scripts.source("gif.js"), scripts.source("replay.js"), *sources]
    sources += [scripts.source("quantity.js")] if sources else []
    replayed = found.replay or {}
    drawn_charts = charts(found.lines, found.dt, POINTS, int(str(replayed.get("stride", 0))), found.repeats)
    gated = [row for row in (*verdict.failed, *verdict.waived, *verdict.passed) if row.scenario == block.scene]
    return labelled(environment().get_template("scene.html.j2").render(
        block=block, damage=found.damage, grasped=found.grasped, columns=COLUMNS, strokes=strokes, around=around, caveat=CAVEAT,
        gated=gated,
        believed=lambda row: believed(row, verdict.gated), cell_note=lambda cell: cell_note(cell, verdict.gated),
        quantity=quantity, limit=limit, ratio=ratio, count=count, words_of=words, panels=panels,
        policy=scripts.policy(sources), library=library, words=three_js.WORDS,
        replay=replayed, replay_data=scripts.data(found.replay) if library and found.replay else "",
        states=counts_of(found.replay) if found.replay else 0,
        replay_js=scripts.source("replay.js"), gif_js=scripts.source("gif.js"),
        quantity_js=scripts.source("quantity.js"), courses_js=scripts.source("courses.js"),
        asleep_said=asleep_sentence(block), cut_said=found.cut, as_run=found.settings, charts=drawn_charts,
        courses_data=scripts.data({"scenes": {block.scene: drawn_charts}} | strokes_data(strokes)),
        css=scripts.source("page.css") + scripts.source("scene.css") + dark_rules(),
    ))
