"""The pages of all scenes of a run, by the path at which they stand beside index.html."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from reports.deciding.moments import Instants
from reports.deciding.tables import blocks
from reports.deciding.verdict import Verdict
from reports.drawing.charts import Panel
from reports.drawing.palette import strokes
from reports.page.gallery import Picture
from reports.page.scene_page import Neighbours, kept, page
from reports.reading.load import Results
from reports.replay.courses import charts

POINTS = 160
"""Points of a line in the charts of index.html, which holds those of all scenes."""


class Made(NamedTuple):
    """A scene, the text of its page, and what index.html shows of it: its charts over time, its picture, which of its files
    could not be used, and when figures of our engine are largest."""

    scene: str
    text: str
    charts: list[dict[str, object]]
    picture: Picture
    damage: tuple[str, ...]
    instants: Instants


def scene_pages(
    run_dir: Path, results: Results, verdict: Verdict, panels: Mapping[str, Sequence[Panel]] | None = None,
) -> Iterator[Made]:
    """Every scene in the order of the table, one after the other: all at once would be large. `panels`: the static charts that
    the page of a scene holds."""
    shown = blocks(results)
    runs = [line.run for block in shown for line in block.lines]
    colours = strokes(dict.fromkeys([verdict.gated, *runs] if verdict.gated in runs else runs))
    names = [block.scene for block in shown]
    for k, block in enumerate(shown):
        around = Neighbours(names[k - 1] if k else None, names[k + 1] if k + 1 < len(names) else None)
        own = {run: stroke for run, stroke in colours.items() if any(line.run == run for line in block.lines)}
        found = kept(run_dir, block.scene, results, verdict.gated)
        text = page(block, found, verdict, own, around, (panels or {}).get(block.scene, ()))
        yield Made(block.scene, text, charts(found.lines, found.dt, POINTS, repeats=found.repeats), found.picture, found.damage,
                   found.instants)
