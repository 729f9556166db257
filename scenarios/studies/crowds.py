"""Many drawn crowds: a line for each run, and for each engine the worst figures and how many runs are outside the bounds."""

from collections.abc import Iterator, Sequence

import numpy as np

from scenarios import drawn_crowds
from scenarios.job import Job, Outcome
from scenarios.studies.broken import broken, figure
from scenarios.studies.unseen_motions import aligned

METRICS = {
    "residual_overlap_max": "overlap m", "substep_overlap_max": "inside m", "time_kept_error": "lost time",
    "stalled_bodies": "stalled %", "energy_gain_max": "gain", "not_finite_frames": "no number %",
    "wrong_side_frames": "wrong side %", "travel_missing": "unfallen m",
}
"""Figures that are shown, and their columns."""
UNBOUNDED = "stalled_bodies"
"""The one of them without a bound: it shows how time is lost."""
HEAD = (f"{'crowd':32}{'engine':20}", *METRICS.values(), "ms/frame", "outside")
WIDTH = 12
"""Characters of a column."""


def jobs(seeds: Sequence[int], runs: Sequence[tuple[str, str]], frames: int | None = None) -> list[Job]:
    """Return every run in the crowds of these seeds at full length."""
    return [
        Job(drawn_crowds.draw(seed).name, engine, preset, seed, full=True, frames=frames, catalogue=drawn_crowds.NAME)
        for seed in seeds for engine, preset in runs
    ]


def line(outcome: Outcome) -> str:
    """Return the figures of one run, and those of them that are outside their bounds."""
    figures = [_written(outcome, metric) for metric in METRICS]
    outside = ", ".join(METRICS.get(metric, metric) for metric in broken(outcome))
    first = f"{outcome.job.scenario:32}{outcome.job.run:20}"
    return in_columns((first, *figures, f"{1e3 * outcome.frame_seconds:.2f}", outside))


def in_columns(cells: Sequence[str]) -> str:
    """Return cells as one line: lines are printed before the widest of a column is known."""
    return cells[0] + "".join(cell.rjust(WIDTH) for cell in cells[1:-1]) + f"  {cells[-1]}"


def summary(outcomes: Sequence[Outcome]) -> str:
    """Return the worst of every figure of each engine, where it is, and in how many runs it is outside its bound."""
    return aligned([("engine", "figure", "worst", "in", "outside", "of"), *_rows(outcomes)])


def _rows(outcomes: Sequence[Outcome]) -> Iterator[tuple[str, ...]]:
    for run in dict.fromkeys(outcome.job.run for outcome in outcomes):
        own = [outcome for outcome in outcomes if outcome.job.run == run]
        outside = [broken(outcome) for outcome in own]
        for metric in METRICS:
            told = [outcome for outcome in own if isinstance(outcome.values.get(metric), float)]
            if told:
                # of figures that are no number argmax finds the first
                worst = told[int(np.argmax([figure(outcome, metric) for outcome in told]))]
                count = "no bound" if metric == UNBOUNDED else f"{sum(metric in found for found in outside)}"
                yield run, metric, _written(worst, metric), worst.job.scenario, count, f"{len(told)}"
        yield run, "any", "", "", f"{sum(map(bool, outside))}", f"{len(own)}"


def _written(outcome: Outcome, metric: str) -> str:
    """Return a figure as text, "-" where the scene has none."""
    value = outcome.values.get(metric)
    return f"{value:.3g}" if isinstance(value, float) else "-"
