"""The README's part that a run writes: the table of engines, and the four strip charts as one picture."""

import json
import re
from pathlib import Path

import vl_convert

from avatarsim.errors import InvalidFile
from reports.charts.marks import coloured, palette
from reports.charts.strips import strip, strips
from reports.summaries.text import foot, table
from reports.tables.run import Run

BEGINS, ENDS = "<!-- headline: written by `python -m reports headline` -->", "<!-- end of headline -->"
PICTURE = Path("reports/pictures/strips.svg")

WIDTHS = (260, 190, 190, 190)
"""Widths of the four charts [px]."""
NAMES = 24
"""Margin [px] left of the names, whose fonts are wider in some browsers than where they were measured."""


def origin(run: Run) -> dict[str, str]:
    """Return the run, commit and day of its figures."""
    info = run.results.provenance
    return {"run": run.name, "commit": str(info.get("commit", "unknown")), "date": str(info.get("started", "unknown"))[:10]}


def block(run: Run) -> str:
    """Return the text between the marks."""
    info, of = run.results.provenance, origin(run)
    machine = f"{info.get('cpus', '?')} cores of {info.get('cpu', '?')}"
    ran = f"Run `{of['run']}` at commit `{of['commit'][:12]}`, {of['date']}, on {machine}"
    shown = "Overlap left, bounce error, angle beyond joint limits and frame time of all engines, a dot per scene."
    scenes = f"{run.rows.scenario.nunique()} scenes. A dot is a scene, a tick the median."
    how = f"{foot(run)} `method.html` beside every report says how it is measured."
    return "\n".join([BEGINS, f"{ran}; {scenes}", how, "", f"![{shown}]({PICTURE})", "", *table(run), ENDS])


def picture(run: Run) -> str:
    """Return the four strip charts as one SVG, in light colours."""
    charts = []
    for (name, chart), width in zip(strips(run).items(), WIDTHS, strict=True):
        title = {"text": chart.title, "anchor": "start"}
        spec = strip(run, chart, chart.title, name == "overlap") | {"width": width, "title": title}
        # a static picture has nothing to point with
        spec["layer"][0]["encoding"]["opacity"] = {"value": 0.65}
        charts.append({key: value for key, value in spec.items() if key != "params"})
    # thousands of dots need no label each: the picture has its words
    config = {
        "aria": False, "view": {"stroke": None}, "font": "sans-serif",
        "axis": {"labelColor": "@muted", "gridColor": "@grid"}, "title": {"color": "@ink", "fontSize": 13},
    }
    margins = {"left": NAMES, "right": 10, "top": 10, "bottom": 10}
    whole = {"hconcat": charts, "background": "@paper", "padding": margins, "config": config}
    svg = vl_convert.vegalite_to_svg(json.dumps(coloured(whole, palette()["light"])))
    # a hundredth of a pixel is enough, and a third of the bytes; texts between tags keep their digits
    return re.sub(r"(\.\d\d)\d+(?=[^<>]*>)", r"\1", svg)


def write(run: Run, readme: Path) -> None:
    """Write the picture, and the text between the marks of the README. Raises InvalidFile without the marks."""
    text = readme.read_text(encoding="utf-8")
    before, begun, rest = text.partition(BEGINS)
    _, ended, after = rest.partition(ENDS)
    if not (begun and ended):
        raise InvalidFile(str(readme), "without the marks of the headline", f"{BEGINS} and {ENDS}")
    (readme.parent / PICTURE).write_text(picture(run), encoding="utf-8")
    readme.write_text(before + block(run) + after, encoding="utf-8")
