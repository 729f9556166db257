"""Figure 7 of the paper again: the time of each frame while a hand roams, slides over a table and pushes a ball."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import altair as alt
import numpy as np
from numpy.typing import NDArray

from reports.drawing.charts import Panel
from reports.drawing.marks import FONT, HEIGHT, WIDTH
from reports.drawing.palette import GRID, MUTED, strokes
from reports.drawing.picture import picture
from reports.reading.load import Array, Results
from reports.words.wording import quantity
from runfiles.csv_rows import lines
from runfiles.timing_protocol import least_of, repeats_of

Flags = NDArray[np.bool_]

FIGURE_7 = "hand_over_table"
"""The scene of Figure 7: a hand roams idle, slides over a table, pushes a ball."""
METHODS = ("avatarsim/default", "avatarsim/paper")
FILES = FILE, STAGES_FILE = "figure_7.csv", "figure_7_shares.csv"
"""What `scenarios.table_2` leaves in the run's folder."""
MOST_POINTS = 240
SEEN = 1e-6
"""Overlap [m] of the raw tracker from which it is in contact."""


@dataclass(frozen=True, eq=False)
class Trace:
    """One method's frames in the scene of Figure 7: time [us] (F,), whether the raw hand is inside something (F,), and the share
    [%] of all its frames that each stage takes, empty where it was not measured; `first` frames before them were not timed; each
    is the least of `repeats`, 0 where that is not known."""

    run: str
    us: Array
    contact: Flags
    stages: Mapping[str, float] = field(default_factory=dict)
    first: int = 0
    repeats: int = 0


def load(run_dir: Path) -> tuple[Trace, ...]:
    """The file of the long trace; none where the run has none. Raises InvalidFile for a damaged one."""
    points = lines(run_dir / FILE, lambda row: (row["run"], float(row["us"]), int(row["contact"])))
    own = {run: [point for point in points if point[0] == run] for run in dict.fromkeys(point[0] for point in points)}
    spent = lines(run_dir / STAGES_FILE, lambda row: (row["run"], row["stage"], float(row["share"])))
    stages = {run: {stage: share for name, stage, share in spent if name == run} for run in own}
    return tuple(
        Trace(run, np.array([p[1] for p in found]), np.array([bool(p[2]) for p in found]), stages[run])
        for run, found in own.items()
    )


def from_series(results: Results) -> tuple[Trace, ...]:
    """The same from the run's own timing pass, which is shorter."""
    runs = results.series.get(FIGURE_7, {})
    raw = next((series.overlap for run, series in runs.items() if run.startswith("tracker/")), np.zeros(0))
    repeats = max((repeats_of(row.note) for row in results.of(FIGURE_7) if row.metric == "frame_time_p50"), default=0)
    found = []
    for run in METHODS:
        if run in runs and runs[run].frame_time.size:
            first = int(np.argmax(np.isfinite(runs[run].frame_time)))
            times = runs[run].frame_time[first:]
            touches = np.zeros(times.size, dtype=bool)
            # state k + 1 is what frame k has led to
            known = raw[first + 1 : first + times.size + 1]
            touches[: known.size] = ~(known <= SEEN)
            found.append(Trace(run, times, touches, first=first, repeats=repeats))
    return tuple(found)


def figure_7(traces: Sequence[Trace]) -> list[Panel]:
    """Frame time over frames, a panel per method, contact as a grey band."""
    made: list[Panel] = []
    for trace in traces:
        said = _phases(trace)
        drawn = picture(_spec(trace), f"Frame time over frames. {said}", f"f7{len(made)}")
        made.append(Panel(trace.run, drawn, said))
    return made


def _phases(trace: Trace) -> str:
    """Median time while the tracker overlaps nothing, and while it does."""
    run, times, touches = trace.run, trace.us, trace.contact
    idle, busy = times[~touches], times[touches]
    phases = (("while idle", idle), ("in contact", busy))
    parts = [f"{quantity(float(np.median(own)), 'us')} {name}" for name, own in phases if own.size]
    frame = trace.first + int(np.nanargmax(times)) + 1
    slowest = f"slowest {quantity(float(np.nanmax(times)), 'us')} in frame {frame} of {trace.first + times.size}"
    how = f" ({least_of(trace.repeats)})" if trace.repeats else ""
    said = f"{run}: {', '.join(parts)}, {slowest}{how}."
    return said if busy.size else f"{said} No contact in these frames: `make bench` times all of the scene."


def _spec(trace: Trace) -> dict[str, object]:
    run, times, touches = trace.run, trace.us, trace.contact
    stroke, top = strokes([METHODS[0], run])[run], float(np.nanmax(times))
    step = max(1, -(-times.size // MOST_POINTS))
    dots = [
        {"frame": trace.first + k + 1, "us": float(f"{times[k : k + step].max():.4g}"),
         "contact": top if touches[k : k + step].any() else 0.0}
        for k in range(0, times.size, step)
    ]
    base, x = alt.Chart({"values": dots}), alt.X("frame:Q", title="frame", axis=alt.Axis(grid=False, tickCount=5),
                                                 scale=alt.Scale(nice=False))
    y = alt.Y("us:Q", title="µs per frame", axis=alt.Axis(tickCount=4))
    band = base.mark_area(color=GRID[0], interpolate="step-after").encode(x=x, y=alt.Y("contact:Q", title="µs per frame"))
    line = base.mark_line(color=stroke.light, strokeWidth=1.4, interpolate="step-after").encode(x=x, y=y)
    return styled(alt.layer(band, line))


def styled(chart: alt.LayerChart | alt.FacetChart) -> dict[str, object]:
    """The specification of a chart in the page's style."""
    return dict(chart.properties(width=WIDTH - 20, height=HEIGHT, background="transparent").configure(
        font=FONT, padding={"left": 4, "top": 4, "right": 4, "bottom": 2}, view=alt.ViewConfig(stroke=None),
    ).configure_axis(
        labelColor=MUTED[0], titleColor=MUTED[0], gridColor=GRID[0], domain=False, tickColor=GRID[0], labelFontSize=10,
        titleFontSize=10, titleFontWeight="normal", tickSize=3,
    ).to_dict())
