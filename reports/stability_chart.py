"""A heat map per figure: kinds of change down, engines across, the darker the worse, each cell with its figure."""

import math
from collections.abc import Mapping, Sequence

import altair as alt

from reports.charts import Panel
from reports.marks import FONT
from reports.palette import ALARM, MUTED, TEXT
from reports.picture import picture
from reports.wording import quantity

CELL, ROW = 54, 22
"""Width and height of a cell [px]."""
PALEST, DARKEST = 0.0, 0.6
"""Opacity of the best and of the worst cell; beyond it the figure on top could not be read."""
DECADES = 9.0
"""So many powers of ten below the worst, a cell is as pale as the best."""
Values = Mapping[tuple[str, str, str], float]


def shade(value: float, worst: float, unit: str) -> float:
    """Opacity of a cell: in proportion for shares, by powers of ten for lengths and energies."""
    if not value > 0.0 or not worst > 0.0:
        return PALEST
    if unit == "%":
        return DARKEST * value / 100.0
    return DARKEST * max(0.0, 1.0 + math.log10(value / worst) / DECADES)


def panels(values: Values, runs: Sequence[str], kinds: Sequence[str], units: Mapping[str, str]) -> list[Panel]:
    """A panel for each figure that anybody has."""
    made: list[Panel] = []
    for figure, unit in units.items():
        cells = {(kind, run): v for kind in kinds for run in runs if (v := values.get((figure, kind, run), math.nan)) == v}
        if not cells:
            continue
        worst = max(cells.values())
        kind, run = max(cells, key=lambda at: cells[at])
        said = f"Worst: {quantity(worst, unit)}, {run}, {kind}." if worst > 0.0 else "Nothing."
        dots: list[dict[str, object]] = [
            {"kind": kind, "run": run, "shade": round(shade(v, worst, unit), 3), "word": quantity(v, unit)}
            for (kind, run), v in cells.items()
        ]
        text = f"{figure} by engine and kind of change. {said}"
        made.append(Panel(figure, picture(_spec(dots, runs, kinds), text, f"st{len(made)}"), said))
    return made


def _spec(dots: list[dict[str, object]], runs: Sequence[str], kinds: Sequence[str]) -> dict[str, object]:
    slant = alt.Axis(orient="top", labelAngle=-28, labelAlign="left", ticks=False, domain=False, labelLimit=200)
    x = alt.X("run:N", sort=list(runs), title=None, axis=slant)
    y = alt.Y("kind:N", sort=list(kinds), title=None, axis=alt.Axis(ticks=False, domain=False, labelColor=TEXT[0]))
    base = alt.Chart({"values": dots}).encode(x=x, y=y)
    opacity = alt.Opacity("shade:Q", scale=None, legend=None)
    chart = alt.layer(
        base.mark_rect(color=ALARM[0], cornerRadius=2).encode(opacity=opacity),
        base.mark_text(color=TEXT[0], fontSize=9).encode(text="word:N"),
    ).properties(width=CELL * len(runs), height=ROW * len(kinds), background="transparent").configure(
        font=FONT, padding={"left": 4, "top": 2, "right": 48, "bottom": 2}, view=alt.ViewConfig(stroke=None)
    ).configure_axis(labelColor=MUTED[0], labelFontSize=10, grid=False)
    return dict(chart.to_dict())
