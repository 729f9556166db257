"""The paper's Figure 7, its shares of a frame, and contacting pairs against the share of collision queries, beside ours."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import altair as alt
import numpy as np
from numpy.typing import NDArray

from reports.charts import Panel
from reports.files import lines
from reports.load import Array, Results
from reports.marks import FONT, HEIGHT, WIDTH
from reports.palette import GRID, MUTED, TEXT, strokes
from reports.picture import picture
from reports.table_2 import PRINTED, Line, Table2
from reports.wording import quantity

Flags = NDArray[np.bool_]

FIGURE_7 = "hand_over_table"
"""The scene of Figure 7: a hand roams idle, slides over a table, pushes a ball."""
METHODS = ("avatarsim/default", "avatarsim/paper")
PRINTED_SHARES = {"overlap removal": 50.0, "collisions with impulses": 25.0}
"""Percent of a frame in the paper; the rest is drawing, data structures and reading the tracker."""
STAGES = {"posture": "overlap removal", "motion": "collisions with impulses", "coupling": "collisions with impulses"}
"""Which of the paper's two shares a stage of ours belongs to."""
HARDWARE = (
    "The paper's figures are of 2004: a 1.7 GHz Xeon, with drawing and tracker reading in the frame. Ours are of the machine "
    "that provenance names, of the engine alone, on one thread: times are decades of hardware apart, shapes can be compared."
)
FILE = "figure_7.csv"
"""What `scenarios.table_2` leaves in the run's folder."""
MOST_POINTS = 240
SEEN = 1e-6
"""Overlap [m] of the raw tracker from which it is in contact."""


@dataclass(frozen=True)
class Share:
    """Percent of a frame that a part of the work takes, in print and in each method of ours; None where nothing was measured."""

    part: str
    printed: float
    ours: tuple[float | None, ...]


def shares(results: Results) -> tuple[Share, ...]:
    """The paper's shares beside those of our stages in the scene of Figure 7; empty without them."""
    found: dict[str, dict[str, float]] = {}
    for row in results.rows:
        part = STAGES.get(row.metric.removeprefix("stage_share_")) if row.metric.startswith("stage_share_") else None
        if part and row.scenario == FIGURE_7 and row.run in METHODS and row.value is not None:
            own = found.setdefault(row.run, {})
            own[part] = own.get(part, 0.0) + row.value
    if not found:
        return ()
    return tuple(Share(part, printed, tuple(found.get(run, {}).get(part) for run in METHODS))
                 for part, printed in PRINTED_SHARES.items())


def shares_sentence(found: Sequence[Share]) -> str:
    """What to conclude from the shares."""
    if not found:
        return f"No share of {FIGURE_7} was measured."
    said = [f"{share.part} {share.ours[0]:.0f} % (printed {share.printed:.0f} %)" for share in found if share.ours[0] is not None]
    return f"In {FIGURE_7}, of our own frame in {METHODS[0]}: {', '.join(said)}; nothing else is in it."


@dataclass(frozen=True, eq=False)
class Trace:
    """One method's frames in the scene of Figure 7: time [us] (F,), whether the raw hand is inside something (F,)."""

    run: str
    us: Array
    contact: Flags


def load(run_dir: Path) -> tuple[Trace, ...]:
    """The file of the long trace; none where the run has none. Raises InvalidFile for a damaged one."""
    points = lines(run_dir / FILE, lambda row: (row["run"], float(row["us"]), int(row["contact"])))
    own = {run: [point for point in points if point[0] == run] for run in dict.fromkeys(point[0] for point in points)}
    return tuple(Trace(run, np.array([p[1] for p in found]), np.array([bool(p[2]) for p in found])) for run, found in own.items())


def from_series(results: Results) -> tuple[Trace, ...]:
    """The same from the run's own timing pass, which is shorter."""
    runs = results.series.get(FIGURE_7, {})
    raw = next((series.overlap for run, series in runs.items() if run.startswith("tracker/")), np.zeros(0))
    found = []
    for run in METHODS:
        if run in runs and runs[run].frame_time.size:
            times = runs[run].frame_time
            touches = np.zeros(times.size, dtype=bool)
            # state k + 1 is what the k-th timed frame has led to
            known = raw[1 : times.size + 1]
            touches[: known.size] = ~(known <= SEEN)
            found.append(Trace(run, times, touches))
    return tuple(found)


def figure_7(traces: Sequence[Trace]) -> list[Panel]:
    """Frame time over frames, a panel per method, contact as a grey band."""
    made: list[Panel] = []
    for trace in traces:
        said = _phases(trace.run, trace.us, trace.contact)
        drawn = picture(_spec(trace.run, trace.us, trace.contact), f"Frame time over frames. {said}", f"f7{len(made)}")
        made.append(Panel(trace.run, drawn, said))
    return made


def _phases(run: str, times: Array, touches: Flags) -> str:
    """Median time while the tracker overlaps nothing, and while it does."""
    idle, busy = times[~touches], times[touches]
    phases = (("while idle", idle), ("in contact", busy))
    parts = [f"{quantity(float(np.median(own)), 'us')} {name}" for name, own in phases if own.size]
    slowest = f"slowest {quantity(float(np.nanmax(times)), 'us')} in frame {int(np.nanargmax(times)) + 1} of {times.size}"
    said = f"{run}: {', '.join(parts)}, {slowest}."
    return said if busy.size else f"{said} No contact in these frames: `make bench` times all of the scene."


def _spec(run: str, times: Array, touches: Flags) -> dict[str, object]:
    stroke, top = strokes([METHODS[0], run])[run], float(np.nanmax(times))
    step = max(1, -(-times.size // MOST_POINTS))
    dots = [
        {"frame": k + 1, "us": float(f"{times[k : k + step].max():.4g}"), "contact": top if touches[k : k + step].any() else 0.0}
        for k in range(0, times.size, step)
    ]
    base, x = alt.Chart({"values": dots}), alt.X("frame:Q", title="frame", axis=alt.Axis(grid=False, tickCount=5),
                                                 scale=alt.Scale(nice=False))
    y = alt.Y("us:Q", title="µs per frame", axis=alt.Axis(tickCount=4))
    band = base.mark_area(color=GRID[0], interpolate="step-after").encode(x=x, y=alt.Y("contact:Q", title="µs per frame"))
    line = base.mark_line(color=stroke.light, strokeWidth=1.4, interpolate="step-after").encode(x=x, y=y)
    return _styled(alt.layer(band, line))


def collision_share(table: Table2) -> list[Panel]:
    """Share of collision queries against contacting pairs, as printed and in both methods, a point per scene."""
    sound = [line for line in table.lines if not np.isnan(line.pairs) and not np.isnan(line.collision_share)]
    runs = [run for run in (PRINTED, *METHODS) if any(line.run == run for line in sound)]
    if not runs:
        return []
    inks = {PRINTED: TEXT[0]} | {run: stroke.light for run, stroke in strokes(METHODS).items()}
    dots = [{"run": line.run, "pairs": line.pairs, "share": line.collision_share} for line in sound if line.run in runs]
    x = alt.X("pairs:Q", title="pairs per frame", axis=alt.Axis(grid=False, tickCount=5))
    y = alt.Y("share:Q", title="collision queries, % of frame", axis=alt.Axis(tickCount=4))
    colour = alt.Color("run:N", legend=None, scale=alt.Scale(domain=runs, range=[inks[run] for run in runs]))
    shape = alt.Shape("run:N", legend=None, scale=alt.Scale(domain=runs, range=["cross", "circle", "square"][: len(runs)]))
    spec = _styled(alt.layer(alt.Chart({"values": dots}).mark_point(filled=True, size=60, opacity=1).encode(x, y, colour, shape)))
    said = " ".join(_together(run, [line for line in sound if line.run == run]) for run in runs)
    marks = "Crosses: printed; circles: default; squares: paper. "
    return [Panel("contacting pairs", picture(spec, f"Share of collision queries against pairs. {said}", "cp"), marks + said)]


def _together(run: str, scenes: Sequence[Line]) -> str:
    """Whether the share rises with the pairs, by the rank correlation of the scenes."""
    pairs, share = np.array([line.pairs for line in scenes]), np.array([line.collision_share for line in scenes])
    if len(pairs) < 3 or np.ptp(pairs) == 0.0 or np.ptp(share) == 0.0:
        return f"{run}: too few scenes to say."
    order = float(np.corrcoef(np.argsort(np.argsort(pairs)), np.argsort(np.argsort(share)))[0, 1])
    way = "rises" if order > 0.3 else "falls" if order < -0.3 else "hardly changes"
    return f"{run}: the share {way} with the pairs (rank correlation {order:.2f})."


def _styled(chart: alt.LayerChart | alt.FacetChart) -> dict[str, object]:
    return dict(chart.properties(width=WIDTH - 20, height=HEIGHT, background="transparent").configure(
        font=FONT, padding={"left": 4, "top": 4, "right": 4, "bottom": 2}, view=alt.ViewConfig(stroke=None),
    ).configure_axis(
        labelColor=MUTED[0], titleColor=MUTED[0], gridColor=GRID[0], domain=False, tickColor=GRID[0], labelFontSize=10,
        titleFontSize=10, titleFontWeight="normal", tickSize=3,
    ).to_dict())


def section(results: Results, table: Table2 | None, traces: Sequence[Trace] = ()) -> dict[str, object]:
    """What a page needs for its section; `traces` from the file of the run, if it has one."""
    found = shares(results)
    return {
        "paper_shares": found, "paper_shares_said": shares_sentence(found), "paper_methods": METHODS, "paper_hardware": HARDWARE,
        "paper_figure_7": figure_7(traces or from_series(results)), "paper_pairs": collision_share(table) if table else [],
    }
