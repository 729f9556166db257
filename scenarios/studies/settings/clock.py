"""Times of the cells of one scene: serially, engines taking turns, a dozen processes at a time, kept group by group."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from runfiles.timing_protocol import PHASE_FRAMES, Protocol
from scenarios.measure.timing import Round
from scenarios.run.timed_worker import TimedWorkers
from scenarios.run.timing import Clocked, timed_pass
from scenarios.studies.checkpoint import Entry
from scenarios.studies.settings.cell import Cell

AT_ONE_TABLE = 9
"""Processes that wait for their turn together. More: more memory, and more is lost when a run is killed; fewer: engines that are
compared were timed further apart."""
REPEATS = 2
"""Runs of the frames of a cell. One could not separate a disturbance from a frame's own cost; a third would be a quarter of
the time a sweep takes and gains less: two threes of six repeats differ as much as the three pairs do."""

NOTHING: Mapping[Cell, Entry] = MappingProxyType({})


def tables(cells: Sequence[Cell]) -> list[list[Cell]]:
    """Return groups in which every engine is represented as evenly as possible."""
    order = {engine: 0 for engine in dict.fromkeys(cell.setting.engine for cell in cells)}
    count = {engine: sum(cell.setting.engine == engine for cell in cells) for engine in order}
    placed = []
    for cell in cells:
        engine = cell.setting.engine
        placed.append((order[engine] / count[engine], cell))
        order[engine] += 1
    dealt = [cell for _, cell in sorted(placed, key=lambda entry: entry[0])]
    return [dealt[k : k + AT_ONE_TABLE] for k in range(0, len(dealt), AT_ONE_TABLE)]


def times(
    cells: Sequence[Cell], workers: TimedWorkers, done: Callable[[Cell, Entry], None], repeats: Sequence[int],
    errors: Mapping[Cell, Entry] = NOTHING,
) -> None:
    """Time all `cells` of one scene, each so many times; `done` gets the entry of each as soon as its group has ended. `errors`
    of a cell have the frames in which it rests."""
    often = dict(zip(cells, repeats, strict=True))
    for group in tables(cells):
        # the first of an engine at a table has one process at all tables, the second another: starting takes longer than timing
        engines = [cell.setting.engine for cell in group]
        chairs = [f"{engine} {engines[:k].count(engine)}" for k, engine in enumerate(engines)]
        plan = [Round(often[cell], 0, cell.timed_frames) for cell in group]
        clocked = timed_pass([cell.job for cell in group], True, plan, [workers.at(chair) for chair in chairs])
        for cell, one in zip(group, clocked, strict=True):
            done(cell, time_entry(one, cell.setting.cut, errors.get(cell, {}).get("resting", ())))


def time_entry(result: Clocked, cut: int, resting: Sequence[int] = ()) -> Entry:
    """Return median, 95th and 99th percentile and slowest of the rendered frames [us], engine only; None and why without times.

    Each frame is the least of its `repeats`, the slowest that of all. A 99th percentile of too few `frames` or repeats is None.
    `rests` is the share [%] of frames in which nothing moves, `moving` and `at_rest` the median of either kind where both are
    many, None where that is not known.
    """
    nothing = dict.fromkeys(("p50", "p95", "p99", "slowest", "rests", "moving", "at_rest"))
    if result.timed is None:
        return {"run": result.job.run, **nothing, "repeats": 0, "frames": 0, "note": result.note}
    whole, repeats = np.array(rendered(result.timed.compared_us, cut)), result.timed.compared.repeats
    p50, p95, p99 = (float(time) for time in np.percentile(whole, (50, 95, 99)))
    enough = Protocol(repeats, len(whole), result.timed.warm_frames).has_tail
    rests = np.asarray(resting[: cut * len(whole)], dtype=np.bool_)
    phases: dict[str, float] = {}
    if len(rests) == cut * len(whole):
        # a rendered frame rests if all of its parts do
        still = rests.reshape(-1, cut).all(axis=1)
        phases["rests"] = 100.0 * float(still.mean())
        if min(still.sum(), (~still).sum()) >= PHASE_FRAMES:
            phases |= {"moving": float(np.median(whole[~still])), "at_rest": float(np.median(whole[still]))}
    return {
        "run": result.job.run, **nothing, "p50": p50, "p95": p95, "p99": p99 if enough else None,
        "slowest": max(max(rendered(each, cut)) for each in result.timed.engine_ns / 1e3), **phases, "repeats": repeats,
        "frames": len(whole), "note": result.timed.compared.said if result.note == result.timed.protocol.said else result.note,
    }


def rendered(parts_us: Iterable[float], cut: int) -> list[float]:
    """Return times of rendered frames from those of their `cut` parts."""
    parts = np.asarray(list(parts_us), dtype=np.float64)
    whole = len(parts) // cut * cut
    return [float(time) for time in parts[:whole].reshape(-1, cut).sum(axis=1)]
