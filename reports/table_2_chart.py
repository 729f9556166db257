"""Figure 8 again: frame time and iterations over frames while two arms are pushed into a wall, a panel per method."""

import altair as alt

from reports.charts import Panel
from reports.marks import FONT, HEIGHT, WIDTH
from reports.palette import GRID, MUTED, strokes
from reports.picture import picture
from reports.table_2 import Array, Table2, budget, cell, ratios, spike_sentence


def panels(table: Table2) -> list[Panel]:
    """A panel per method of ours."""
    made: list[Panel] = []
    for run, (us, iterations) in table.trace.items():
        said = spike_sentence(run, us, iterations)
        made.append(Panel(run, picture(_spec(run, us, iterations), f"Frame time over frames. {said}", f"e{len(made)}"), said))
    return made


def _spec(run: str, us: Array, iterations: Array) -> dict[str, object]:
    """Time as a line, iterations as grey bars behind it, each on its own axis."""
    stroke = strokes(["avatarsim/default", run])[run]
    dots = [
        {"frame": k + 1, "us": float(f"{time:.4g}"), "iterations": int(many)}
        for k, (time, many) in enumerate(zip(us, iterations, strict=True))
    ]
    x = alt.X("frame:Q", title="frame", axis=alt.Axis(grid=False, tickCount=5), scale=alt.Scale(nice=False))
    base = alt.Chart({"values": dots})
    bars = base.mark_bar(color=GRID[0], width=1.2).encode(
        x=x, y=alt.Y("iterations:Q", title="iterations", axis=alt.Axis(orient="right", grid=False, tickCount=4)),
    )
    line = base.mark_line(color=stroke.light, strokeWidth=1.4, interpolate="step-after").encode(
        x=x, y=alt.Y("us:Q", title="µs per frame", axis=alt.Axis(tickCount=4)),
    )
    chart = alt.layer(bars, line).resolve_scale(y="independent").properties(
        width=WIDTH - 20, height=HEIGHT, background="transparent",
    ).configure(
        font=FONT, padding={"left": 4, "top": 4, "right": 4, "bottom": 2}, view=alt.ViewConfig(stroke=None),
    ).configure_axis(
        labelColor=MUTED[0], titleColor=MUTED[0], gridColor=GRID[0], domain=False, tickColor=GRID[0], labelFontSize=10,
        titleFontSize=10, titleFontWeight="normal", tickSize=3,
    )
    return dict(chart.to_dict())


def section(table: Table2) -> dict[str, object]:
    """What a page needs for its section."""
    return {
        "two_table": table, "two_panels": panels(table), "two_cell": cell, "two_budget": budget(table),
        "two_ratios": ratios(table),
    }
