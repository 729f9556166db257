"""Ratios scene by scene: offset, angle and time of each run to those of another preset of our engine, worst first."""

from collections.abc import Iterator, Sequence

import numpy as np

from scenarios.beside.pair import SAME
from scenarios.posture_table.runs import Seen

HEAD = ("engine", "scene", "offset", "angle", "time p50", "time p99")


def ratio(value: float, base: float) -> float:
    """`value` in multiples of `base`; what is below SAME counts as SAME, so that rounding is no multiple of rounding."""
    return float(np.maximum(value, SAME) / np.maximum(base, SAME))


def ratios(run: Seen, base: Seen) -> tuple[float, ...]:
    """Of root mean squares over all frames and links, and of percentiles of time; nan where one of the two has none."""
    found = [ratio(run.figures.get(name, np.nan), base.figures.get(name, np.nan))
             for name in ("tracker_offset_rms", "tracker_angle_rms")]
    for share in (50, 99):
        both = run.times.size and base.times.size
        found.append(ratio(*(float(np.percentile(one.times, share)) for one in (run, base))) if both else np.nan)
    return tuple(found)


def lines(found: Sequence[Seen], base: str) -> Iterator[tuple[str, ...]]:
    """HEAD and a line of cells for each run beside that of `base` (engine/preset) with the same motion, largest ratio first."""
    yield HEAD
    bases = {(run.job.scenario, run.job.seed): run for run in found if run.job.run == base and run.state == "measured"}
    beside = []
    for run in found:
        other = bases.get((run.job.scenario, run.job.seed))
        if run.job.run != base and run.state == "measured" and other is not None:
            beside.append((ratios(run, other), run))
    beside.sort(key=lambda one: -max((value for value in one[0] if np.isfinite(value)), default=0.0))
    for values, run in beside:
        yield run.job.run, run.where, *("-" if np.isnan(value) else f"{value:.3g}" for value in values)
