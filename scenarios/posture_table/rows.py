"""Pooled statistics of runs: a row per engine, preset and group of scenes, over all frames of the group."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runfiles.visible_motion import FAR
from scenarios.posture_table.runs import Seen
from scenarios.posture_table.series import Array, Series

TURNS = 15.0
"""Turn [deg] of a joint in a frame beyond the user's largest from which the posture has jumped."""
MOVES = 0.1
"""Way [m] of a root in a frame beyond the user's largest from which it has jumped."""
PROMISED = ("residual_overlap_max", "joint_limit_excess_max", "reach_cone_excess_max")
"""Figures of which the worst run counts; other figures are numbers of frames."""


@dataclass(frozen=True)
class Row:
    """One engine and preset in one group. Lengths [m], angles [deg], shares [%], times [us]; nan where there is nothing to take a
    figure of. `slowest` says in which scene and frame `time_max` is."""

    engine: str
    group: str
    runs: int
    frames: int
    overlap: float
    limits: float
    not_finite: int
    wrong_side: int
    contact: int
    chatter: float
    reversal_p95: float
    jerk_ratio: float
    turns: int
    turn_max: float
    root_moves: int
    root_max: float
    silent: int
    owed: int
    far: float
    offset_p50: float
    offset_p95: float
    angle_p50: float
    angle_p95: float
    time_p50: float
    time_p99: float
    time_max: float
    slowest: str


def pooled(runs: Sequence[Seen], of: Callable[[Series], Array]) -> Array:
    """A series of all runs, one after the other."""
    return np.concatenate([np.zeros(0), *(of(run.series) for run in runs if run.series is not None)])


def percentile(values: Array, share: float) -> float:
    """nan of nothing, and where one of the values is no number."""
    return float(np.percentile(values, share)) if values.size else np.nan


def share(flags: NDArray[np.bool_]) -> float:
    """[%]; nan of nothing."""
    return 100.0 * float(np.mean(flags)) if flags.size else np.nan


def jumped(series: Series, values: Array, limit: float) -> Array:
    """(F,) 1 where `values` are above `limit`, or no number."""
    return np.where(~(values <= limit), 1.0, 0.0)


def row_of(engine: str, group: str, runs: Sequence[Seen]) -> Row:
    """The row of the runs of one engine in one group that were measured, one at least."""
    def figures(name: str) -> Array:
        return np.array([run.figures[name] for run in runs if name in run.figures])

    def total(name: str) -> int:
        return int(figures(name).sum())

    held = pooled(runs, lambda s: s.contact) > 0.0
    owed = pooled(runs, lambda s: s.owed) > 0.0
    offset, angle = (pooled(runs, of)[held] for of in (lambda s: s.offset, lambda s: s.angle))
    turn = pooled(runs, lambda s: s.turn)
    way = pooled(runs, lambda s: s.way)
    overlap, *limits = (float(np.max(figures(name), initial=0.0)) for name in PROMISED)
    times = np.concatenate([run.times for run in runs])
    return Row(
        engine, group, len(runs), held.size, overlap, float(np.max(limits)),
        total("not_finite_frames"), total("wrong_side_frames"),
        int(held.sum()), share(pooled(runs, lambda s: s.shakes)[held] > 0.0),
        percentile(pooled(runs, lambda s: s.reversal)[held], 95.0), percentile(figures("jerk_ratio"), 50.0),
        int(pooled(runs, lambda s: jumped(s, s.turn, TURNS)).sum()), float(np.max(turn, initial=0.0)),
        int(pooled(runs, lambda s: jumped(s, s.way, MOVES)).sum()), float(np.max(way, initial=0.0)),
        int(pooled(runs, lambda s: s.silent).sum()), int(owed.sum()), share(~(pooled(runs, lambda s: s.farthest)[owed] <= FAR)),
        percentile(offset, 50.0), percentile(offset, 95.0), percentile(angle, 50.0), percentile(angle, 95.0),
        percentile(times, 50.0), percentile(times, 99.0), percentile(times, 100.0), _slowest(runs),
    )


def _slowest(runs: Sequence[Seen]) -> str:
    timed = [run for run in runs if run.times.size]
    if not timed:
        return ""
    worst = max(timed, key=lambda run: float(run.times.max()))
    return f"{worst.where} frame {int(worst.times.argmax()) + 1}"


def rows(found: Iterable[Seen], group_of: Callable[[str], str]) -> list[Row]:
    """A row per group and engine, those of a group beside each other, of the runs that were measured."""
    by_group: dict[tuple[str, str], list[Seen]] = {}
    for run in found:
        if run.state == "measured":
            by_group.setdefault((group_of(run.job.scenario), run.job.run), []).append(run)
    order = {group: k for k, group in enumerate(dict.fromkeys(group for group, _ in by_group))}
    return [row_of(engine, group, runs) for (group, engine), runs in sorted(by_group.items(), key=lambda item: order[item[0][0]])]
