"""Table 2 of the paper beside ours, and the falling spikes of its Figure 8, from what `scenarios.table_2` left in the run.

Figure 8 again: frame time and iterations over frames while two arms are pushed into a wall, a panel per method.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import altair as alt
import numpy as np
from numpy.typing import NDArray

from reports.drawing.charts import Panel
from reports.drawing.marks import FONT, HEIGHT, WIDTH
from reports.drawing.palette import GRID, MUTED, strokes
from reports.drawing.picture import picture
from reports.words.markdown import escaped
from reports.words.wording import MISSING, count, figures, limit, listed, quantity
from runfiles.csv_rows import lines, number

Array = NDArray[np.float64]

FILES = TABLE, TRACE = "table_2.csv", "figure_8.csv"
OURS, METHODS = "avatarsim/default", ("avatarsim/default", "avatarsim/paper")
PRINTED = "printed in the paper"
P50, P99 = 30.0, 100.0
"""Budget of a frame [us] on these scenes: median and 99th percentile."""
NEXT_TO_NOTHING, LITTLE = (1e-5, 10.0), (1e-3, 3.0)
"""Overlap [m] that a setting of another engine leaves at most, and how many times as fast as such a setting ours is to be."""
CALM, SOON, LATER = 5, 3, 15
"""Frames without work before a spike, frames in which it has its peak, frames after which it has fallen."""


@dataclass(frozen=True)
class Line:
    """One scene in one method; see `scenarios.table_2.rows.Row`. nan where there is no figure."""

    scene: str
    run: str
    frames: int
    timed: int
    ms: float
    p50: float
    p99: float
    joints: float
    iterations: float
    pairs: float
    ik_share: float
    collision_share: float
    posing_share: float
    us_per_joint: float
    us_per_iteration: float
    us_per_pair: float
    us_per_query: float
    overlap: float


@dataclass(frozen=True, eq=False)
class Table2:
    """All lines, and by method the trace of Figure 8: time [us] and iterations (F,) of each timed frame."""

    lines: tuple[Line, ...]
    trace: Mapping[str, tuple[Array, Array]]

    def of(self, scene: str) -> tuple[Line, ...]:
        """The lines of one scene."""
        return tuple(line for line in self.lines if line.scene == scene)

    @property
    def scenes(self) -> tuple[str, ...]:
        """Scenes in the paper's order."""
        return tuple(dict.fromkeys(line.scene for line in self.lines))


def load(run_dir: Path) -> Table2 | None:
    """The files of a run; None when it has none. Raises InvalidFile for a file that is damaged."""
    found = lines(run_dir / TABLE, _line)
    points = lines(run_dir / TRACE, lambda row: (row["run"], int(row["frame"]), float(row["us"]), float(row["iterations"])))
    trace = {
        run: (np.array([p[2] for p in points if p[0] == run]), np.array([p[3] for p in points if p[0] == run]))
        for run in dict.fromkeys(p[0] for p in points)
    }
    return Table2(found, trace) if found else None


def _line(row: Mapping[str, str]) -> Line:
    told = {name: number(row[name]) for name in Line.__dataclass_fields__ if name not in ("scene", "run", "frames", "timed")}
    return Line(row["scene"], row["run"], int(row["frames"]), int(row["timed"]), **told)


def cell(value: float, digits: int = 1) -> str:
    """A figure of the table, or a dash."""
    return MISSING if math.isnan(value) else f"{value:.{digits}f}"


def budget(table: Table2) -> str:
    """Whether frames keep to the budget, scene by scene where they do not."""
    ours = [line for line in table.lines if line.run == OURS]
    over = [f"{line.scene} (p50 {quantity(line.p50, 'us')}, p99 {quantity(line.p99, 'us')})" for line in ours
            if not line.p50 <= P50 or line.p99 > P99]
    untold = tuple(line.scene for line in ours if math.isnan(line.p99))
    said = f"Budget of a frame: median {limit(P50, 'us')}, p99 {limit(P99, 'us')}."
    said += f" Too few frames were timed for a p99 in {listed(untold)}." if untold else ""
    if not ours:
        return f"{said} Nothing was measured."
    return f"{said} Over it: {listed(tuple(over))}." if over else f"{said} Held in all {count(len(ours), 'scene')}."


def ratios(table: Table2) -> str:
    """How many times as fast ours is as settings that leave next to no overlap, and whether that is what was promised."""
    said = []
    for most, promised in (NEXT_TO_NOTHING, LITTLE):
        found = [
            (rival.p50 / ours.p50, f"{rival.run} in {rival.scene}")
            for ours in table.lines if ours.run == OURS and ours.p50 > 0.0
            for rival in table.of(ours.scene) if not rival.run.startswith("avatarsim/") and rival.overlap <= most
        ]
        if not found:
            said.append(f"No setting of another engine leaves at most {limit(most, 'm')} in any of these scenes.")
            continue
        least, run = min(found)
        kept = "kept" if least >= promised else "missed"
        said.append(
            f"Least lead over a setting that leaves at most {limit(most, 'm')}: {figures(least)} times ({run}; promised "
            f"{promised:g}, {kept})."
        )
    return " ".join(said)


def spikes(us: Array, iterations: Array) -> tuple[int, float, float, float]:
    """(how many onsets of contact, mean time [us] before, at the peak just after an onset, and LATER frames after it).

    An onset is a frame with more iterations than the least of all after CALM frames without."""
    work = iterations > iterations.min(initial=np.inf)
    begins = [k for k in range(CALM, len(us) - LATER) if work[k] and not work[k - CALM : k].any()]
    if not begins:
        return 0, math.nan, math.nan, math.nan
    before = np.mean([np.median(us[k - CALM : k]) for k in begins])
    peak = np.mean([us[k : k + SOON].max() for k in begins])
    later = np.mean([np.median(us[k + SOON : k + LATER]) for k in begins])
    return len(begins), float(before), float(peak), float(later)


def spike_sentence(run: str, us: Array, iterations: Array) -> str:
    """What to conclude from one trace."""
    many, before, peak, later = spikes(us, iterations)
    if many == 0:
        return f"{run}: no contact begins in these frames."
    falls = "falls" if later < peak else "does not fall"
    rise = f"from {quantity(before, 'us')} to {quantity(peak, 'us')}"
    return (
        f"{run}: contact begins {count(many, 'time')}; the frame time rises {rise} and {falls}, to {quantity(later, 'us')} "
        f"within {LATER} frames."
    )


def markdown(table: Table2) -> str:
    """The table for summary.md."""
    head = ("| scene | method | frames | frame ms | joints | iterations | IK % | pairs | collision % | µs/joint | µs/iteration "
            "| µs/pair |")
    rows: Sequence[str] = [
        f"| {escaped(r.scene)} | {escaped(r.run)} | {r.frames} | {cell(r.ms, 4 if r.ms < 1.0 else 2)} | {cell(r.joints)} | "
        f"{cell(r.iterations)} | {cell(r.ik_share)} | {cell(r.pairs)} | {cell(r.collision_share)} | {cell(r.us_per_joint, 2)} | "
        f"{cell(r.us_per_iteration, 2)} | {cell(r.us_per_pair, 2)} |" for r in table.lines
    ]
    traces = [escaped(spike_sentence(run, *numbers)) for run, numbers in table.trace.items()]
    said = [escaped(budget(table)), escaped(ratios(table)), *traces]
    return "\n".join([head, "|---|---|" + "---:|" * 10, *rows, "", *said])


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
