"""The map of the contact law as pictures: a panel per law and shape, a cell per engine, step and coefficient."""

import math

import altair as alt

from reports.charts import Panel
from reports.law_map import Cell, LawMap, conclusion
from reports.marks import FONT
from reports.palette import ALARM, MUTED, TEXT
from reports.picture import picture
from reports.wording import MISSING, figures

ROW, WIDTH = 13, 330
"""Height of a row and width of the plotting area [px]."""
SHADES = ((1e-6, 0.0), (0.01, 0.12), (0.03, 0.25), (0.1, 0.45), (math.inf, 0.7))
"""How strongly a cell is coloured by the largest difference from what was asked, up to the first number."""


def shade(cell: Cell) -> float:
    """Opacity of a cell; the strongest where a body gave no figure."""
    return SHADES[-1][1] if math.isnan(cell.worst) else next(opacity for most, opacity in SHADES if cell.worst <= most)


def panels(found: LawMap) -> list[Panel]:
    """One panel per law and shape."""
    made: list[Panel] = []
    for law in found.laws:
        for shape in found.shapes:
            cells = [cell for cell in found.cells if (cell.law, cell.shape) == (law, shape)]
            if cells:
                said = _said(cells)
                text = f"{law} of {shape}: what was obtained for what was asked, by engine and step. {said}"
                title = f"{law}, {shape.replace('_', ' ')}"
                made.append(Panel(title, picture(_spec(cells), text, f"l{len(made)}"), said))
    return made


def _said(cells: list[Cell]) -> str:
    """Which engine is closest and which is farthest, over all steps."""
    worst: dict[str, float] = {}
    for cell in cells:
        before = worst.get(cell.run, 0.0)
        # a body without a figure spoils its engine
        worst[cell.run] = math.nan if math.isnan(cell.worst) or math.isnan(before) else max(before, cell.worst)
    ranked = sorted(worst, key=lambda run: (math.isnan(worst[run]), worst[run]))
    ends = tuple(dict.fromkeys((ranked[0], ranked[-1])))
    told = [f"{run} {'lost bodies' if math.isnan(worst[run]) else figures(worst[run])}" for run in ends]
    return f"Largest difference: {' to '.join(told)}."


def _spec(cells: list[Cell]) -> dict[str, object]:
    names = list(dict.fromkeys(_name(cell) for cell in cells))
    asked = [f"{value:g}" for value in sorted({cell.asked for cell in cells})]
    data = [
        {"row": _name(c), "asked": f"{c.asked:g}", "shade": shade(c), "got": MISSING if math.isnan(c.got) else _short(c.got)}
        for c in cells
    ]
    x = alt.X("asked:N", title=None, sort=asked, axis=alt.Axis(orient="top", labelAngle=0))
    y = alt.Y("row:N", title=None, sort=names, axis=alt.Axis(labelLimit=150))
    base = alt.Chart({"values": data})
    layers = [
        base.mark_rect(color=ALARM[0]).encode(x=x, y=y, opacity=alt.Opacity("shade:Q", scale=None, legend=None)),
        base.mark_text(color=TEXT[0], fontSize=9).encode(x=x, y=y, text="got:N"),
    ]
    chart = alt.layer(*layers).properties(width=WIDTH - 110, height=ROW * len(names), background="transparent").configure(
        font=FONT, padding={"left": 4, "top": 2, "right": 4, "bottom": 2}, view=alt.ViewConfig(stroke=None),
    ).configure_axis(labelColor=MUTED[0], domain=False, ticks=False, labelFontSize=9, grid=False)
    return dict(chart.to_dict())


def _name(cell: Cell) -> str:
    return f"{cell.run} 1/{cell.rate}"


def _short(value: float) -> str:
    """Two decimals; three where the coefficient is less than a tenth."""
    return f"{abs(value):.2f}" if abs(value) < 0.005 else f"{value:.2f}" if abs(value) >= 0.1 else f"{value:.3f}"


def cell_text(cell: Cell) -> str:
    """Median, and the range over bodies where they differ by more than a thousandth."""
    if math.isnan(cell.got):
        return MISSING
    spread = "" if cell.high - cell.low <= 1e-3 else f" ({cell.low:.3f} to {cell.high:.3f})"
    return f"{cell.got:.4f}{spread}"


def section(found: LawMap) -> dict[str, object]:
    """What the section is made of."""
    return {"law_conclusion": conclusion(found), "law_panels": panels(found), "law_cell": cell_text, "law_shade": shade}
