"""The chart of the narrow phase: a row per cell, a dot per library, time per query on a logarithmic axis."""

import math

import altair as alt

from reports.charts import Panel
from reports.marks import FONT
from reports.narrow_phase import MODES, OURS, CellLine, NarrowPhase
from reports.palette import GRID, MUTED, TEXT, Stroke, strokes
from reports.picture import picture
from reports.wording import count, limit, quantity

# Height of a row and width of the plotting area [px].
ROW, WIDTH = 13, 300
# The contender that stands for us.
OUR_FIGURE = "ours"


def inks(narrow: NarrowPhase) -> dict[str, Stroke]:
    """A stroke per library, ours first."""
    found = strokes(dict.fromkeys(f"{library}/default" for library in (OURS, *narrow.libraries.values())))
    return {run.split("/")[0]: stroke for run, stroke in found.items()}


def fastest_right(line: CellLine, narrow: NarrowPhase) -> dict[str, float]:
    """Library -> time [us] of its fastest contender that was right in the cell, as measured; ours is the one within a call."""
    found: dict[str, float] = {}
    for engine, figure in line.figures.items():
        library = narrow.libraries[engine]
        ranked = figure.right and figure.us > 0.0 and (library != OURS or engine == OUR_FIGURE)
        if ranked and figure.us < found.get(library, math.inf):
            found[library] = figure.us
    return found


def panels(narrow: NarrowPhase) -> list[Panel]:
    """One panel per mode that has cells."""
    made: list[Panel] = []
    for mode in MODES:
        lines = narrow.lines[mode]
        dots = [
            {"cell": line.name, "library": library, "us": float(f"{us:.4g}")}
            for line in lines for library, us in fastest_right(line, narrow).items()
        ]
        if dots:
            lost = sum(not line.held for line in lines)
            slower = "more than the time" if lines[0].allowed == 1.0 else f"more than {lines[0].allowed:g} of the time"
            said = f"In {lost} of {count(len(lines), 'cell')} ours takes {slower} of the fastest that is right, calls taken off."
            first = lines[0]
            text = f"{mode}. Microseconds per query in {len(lines)} cells. {said} First: {first.name}, ours " \
                   f"{quantity(first.ours_us, 'us')}, {first.rival} {quantity(first.rival_us, 'us')}."
            made.append(Panel(mode, picture(_spec(narrow, lines, dots), text, f"n{len(made)}"), said))
    return made


def _spec(narrow: NarrowPhase, lines: tuple[CellLine, ...], dots: list[dict[str, object]]) -> dict[str, object]:
    ink = inks(narrow)
    times = [float(str(dot["us"])) for dot in dots]
    low, high = 10.0 ** math.floor(math.log10(min(times))), 10.0 ** math.ceil(math.log10(max(times)))
    ticks = [10.0**k for k in range(round(math.log10(low)), round(math.log10(high)) + 1)]
    names = ",".join(f"'{round(math.log10(t))}':'{limit(t, 'us')}'" for t in ticks)
    axis = alt.Axis(values=ticks, labelExpr=f"{{{names}}}[round(log(datum.value)/log(10))]", orient="top")
    colour = alt.Color(
        "library:N", legend=None, scale=alt.Scale(domain=list(ink), range=[stroke.light for stroke in ink.values()])
    )
    row = alt.Y(
        "cell:N", title=None, sort=[line.name for line in lines],
        axis=alt.Axis(grid=True, labelColor=TEXT[0], ticks=False, labelLimit=200),
    )
    x = alt.X("us:Q", title=None, scale=alt.Scale(type="log", domain=[low, high]), axis=axis)
    chart = alt.Chart({"values": dots}).mark_circle(size=42, opacity=1).encode(x=x, y=row, color=colour).properties(
        width=WIDTH, height=ROW * len(lines), background="transparent"
    ).configure(font=FONT, padding={"left": 4, "top": 2, "right": 10, "bottom": 2}, view=alt.ViewConfig(stroke=None))
    chart = chart.configure_axis(
        labelColor=MUTED[0], gridColor=GRID[0], domain=False, tickColor=GRID[0], labelFontSize=10, tickSize=3
    )
    return dict(chart.to_dict())
