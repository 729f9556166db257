"""Times of the cells of one scene: serially, engines taking turns, a dozen processes at a time, kept group by group."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from scenarios.found.store import Entry
from scenarios.measure.protocol import Protocol
from scenarios.seats import Seats
from scenarios.sweep.cell import Cell
from scenarios.timing import Clocked, timed_pass

AT_ONE_TABLE = 9
"""Processes that wait for their turn together. More: more memory, and more is lost when a run is killed; fewer: engines that are
compared were timed further apart."""
REPEATS = 2
"""How often the frames of a cell are run. One could not tell a disturbance from a frame's own cost; a third would be a quarter of
the time a sweep takes and tells less: two threes of six repeats differ as much as the three pairs do."""


def tables(cells: Sequence[Cell]) -> list[list[Cell]]:
    """Groups in which every engine is represented as evenly as possible."""
    order = {engine: 0 for engine in dict.fromkeys(cell.setting.engine for cell in cells)}
    count = {engine: sum(cell.setting.engine == engine for cell in cells) for engine in order}
    placed = []
    for cell in cells:
        engine = cell.setting.engine
        placed.append((order[engine] / count[engine], cell))
        order[engine] += 1
    dealt = [cell for _, cell in sorted(placed, key=lambda entry: entry[0])]
    return [dealt[k : k + AT_ONE_TABLE] for k in range(0, len(dealt), AT_ONE_TABLE)]


def times(cells: Sequence[Cell], seats: Seats, done: Callable[[Cell, Entry], None], repeats: int = REPEATS) -> None:
    """Time all `cells` of one scene, `repeats` times each; `done` gets the entry of each as soon as its group has ended."""
    for group in tables(cells):
        # the first of an engine at a table has one process at all tables, the second another: starting takes longer than timing
        engines = [cell.setting.engine for cell in group]
        chairs = [f"{engine} {engines[:k].count(engine)}" for k, engine in enumerate(engines)]
        clocked = timed_pass(
            [cell.job for cell in group], True, frames=[cell.timed_frames for cell in group],
            seats=[seats.at(chair) for chair in chairs], repeats=repeats,
        )
        for cell, found in zip(group, clocked, strict=True):
            done(cell, time_entry(found, cell.setting.cut))


def time_entry(found: Clocked, cut: int) -> Entry:
    """Median and 99th percentile of a rendered frame [us], engine only, each frame the least of its `repeats`; None and why. A
    percentile that too few `frames` or repeats stand behind is None as well."""
    if found.timed is None:
        return {"run": found.job.run, "p50": None, "p99": None, "repeats": 0, "frames": 0, "note": found.note}
    whole, repeats = rendered(found.timed.best_us, cut), len(found.timed.around_ns)
    p50, p99 = np.percentile(whole, (50, 99))
    enough = Protocol(repeats, len(whole), found.timed.warm_frames).has_tail
    return {
        "run": found.job.run, "p50": float(p50), "p99": float(p99) if enough else None, "repeats": repeats, "frames": len(whole),
        "note": found.note,
    }


def rendered(parts_us: Iterable[float], cut: int) -> list[float]:
    """Times of rendered frames from those of their `cut` parts."""
    parts = np.asarray(list(parts_us), dtype=np.float64)
    whole = len(parts) // cut * cut
    return [float(time) for time in parts[:whole].reshape(-1, cut).sum(axis=1)]
