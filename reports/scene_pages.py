"""The pages of all scenes of a run, by the path at which they stand beside index.html."""

from collections.abc import Iterator
from pathlib import Path

from reports.courses import charts
from reports.load import Results
from reports.palette import strokes
from reports.scene_page import Neighbours, kept, page
from reports.tables import blocks
from reports.verdict import Verdict

POINTS = 160
"""Points of a line in the charts of index.html, which holds those of all scenes."""


def scene_pages(run_dir: Path, results: Results, verdict: Verdict) -> Iterator[tuple[str, str, list[dict[str, object]]]]:
    """(scene, text of its page, its charts for index.html), in the order of the table, one after the other: all at once would be
    large."""
    shown = blocks(results)
    runs = [line.run for block in shown for line in block.lines]
    colours = strokes(dict.fromkeys([verdict.gated, *runs] if verdict.gated in runs else runs))
    names = [block.scene for block in shown]
    for k, block in enumerate(shown):
        around = Neighbours(names[k - 1] if k else None, names[k + 1] if k + 1 < len(names) else None)
        own = {run: stroke for run, stroke in colours.items() if any(line.run == run for line in block.lines)}
        found = kept(run_dir, block.scene, results, verdict.gated)
        yield block.scene, page(block, found, verdict, own, around), charts(found.lines, found.dt, POINTS)
