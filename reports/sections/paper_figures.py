"""The paper's shares of a frame, and contacting pairs against the share of collision queries, beside ours."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import altair as alt
import numpy as np

from reports.drawing.charts import Panel
from reports.drawing.palette import TEXT, strokes
from reports.drawing.picture import picture
from reports.reading.load import Results
from reports.sections.figure_7 import FIGURE_7, METHODS, Trace, figure_7, from_series, styled
from reports.sections.table_2 import PRINTED, Line, Table2

PRINTED_SHARES = {"overlap removal": 50.0, "collisions with impulses": 25.0}
"""Percent of a frame in the paper; the rest is drawing, data structures and reading the tracker."""
STAGES = {"posture": "overlap removal", "motion": "collisions with impulses", "coupling": "collisions with impulses"}
"""Which of the paper's two shares a stage of ours belongs to."""
HARDWARE = (
    "The paper's figures are of 2004: a 1.7 GHz Xeon, with drawing and tracker reading in the frame. Ours are of the machine "
    "that provenance names, of the engine alone, on one thread: times are decades of hardware apart, shapes can be compared."
)


@dataclass(frozen=True)
class Share:
    """Percent of a frame that a part of the work takes, in print and in each method of ours; None where nothing was measured."""

    part: str
    printed: float
    ours: tuple[float | None, ...]


def shares(results: Results, traces: Sequence[Trace] = ()) -> tuple[Share, ...]:
    """The paper's shares beside those of our stages in the scene of Figure 7, over all its frames where the `traces` have them,
    else over the frames that the run has timed; empty without either."""
    found: dict[str, dict[str, float]] = {}
    for trace in traces:
        for stage, share in trace.stages.items():
            if stage in STAGES:
                own = found.setdefault(trace.run, {})
                own[STAGES[stage]] = own.get(STAGES[stage], 0.0) + share
    if found:
        return _beside(found)
    for row in results.rows:
        part = STAGES.get(row.metric.removeprefix("stage_share_")) if row.metric.startswith("stage_share_") else None
        if part and row.scenario == FIGURE_7 and row.run in METHODS and row.value is not None:
            own = found.setdefault(row.run, {})
            own[part] = own.get(part, 0.0) + row.value
    return _beside(found) if found else ()


def _beside(found: Mapping[str, Mapping[str, float]]) -> tuple[Share, ...]:
    return tuple(Share(part, printed, tuple(found.get(run, {}).get(part) for run in METHODS))
                 for part, printed in PRINTED_SHARES.items())


def shares_sentence(found: Sequence[Share]) -> str:
    """What to conclude from the shares."""
    if not found:
        return f"No share of {FIGURE_7} was measured."
    said = [f"{share.part} {share.ours[0]:.0f} % (printed {share.printed:.0f} %)" for share in found if share.ours[0] is not None]
    return f"In {FIGURE_7}, of our own frame in {METHODS[0]}: {', '.join(said)}; nothing else is in it."


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
    spec = styled(alt.layer(alt.Chart({"values": dots}).mark_point(filled=True, size=60, opacity=1).encode(x, y, colour, shape)))
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


def section(results: Results, table: Table2 | None, traces: Sequence[Trace] = ()) -> dict[str, object]:
    """What a page needs for its section; `traces` from the file of the run, if it has one."""
    found = shares(results, traces)
    return {
        "paper_shares": found, "paper_shares_said": shares_sentence(found), "paper_methods": METHODS, "paper_hardware": HARDWARE,
        "paper_figure_7": figure_7(traces or from_series(results)), "paper_pairs": collision_share(table) if table else [],
    }
