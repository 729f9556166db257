"""One row per scene of growing size and engine, as growth.csv holds them, and how fast time grows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Row:
    """Frame time [us], median and 95th percentile of each frame's least over the repeats, of a scene with `size` links (avatars,
    objects), `links` in all; nan with the reason in `note` where nothing was timed."""

    grows: str
    mode: str
    size: int
    links: int
    run: str
    p50: float
    p95: float
    note: str



def exponent(rows: Sequence[Row]) -> float:
    """The power of the size with which p50 grows: slope of a line through the logarithms; nan with fewer than two."""
    known = [(math.log(row.size), math.log(row.p50)) for row in rows if row.p50 > 0.0]
    if len(known) < 2:
        return math.nan
    x, y = np.array(known).T
    return float(np.polyfit(x, y, 1)[0])


def table(rows: Sequence[Row]) -> str:
    """Microseconds per frame: a line per kind, mode and engine, a column per size, time per link at the ends, and the power."""
    lines = []
    for grows in dict.fromkeys(row.grows for row in rows):
        sizes = sorted({row.size for row in rows if row.grows == grows})
        lines.append(f"us per frame (p50) against {grows}")
        lines.append(f"{'':30s}{''.join(f'{size:>10d}' for size in sizes)}   grows with")
        here = [row for row in rows if row.grows == grows]
        for mode, run in dict.fromkeys((row.mode, row.run) for row in here):
            found = {row.size: row for row in here if (row.mode, row.run) == (mode, run)}
            cells = "".join(
                f"{found[size].p50:10.1f}" if size in found and found[size].p50 > 0.0 else f"{'-':>10s}" for size in sizes
            )
            lines.append(f"{mode:8s} {run:21s}{cells}   size^{exponent(list(found.values())):.2f}")
    for note in dict.fromkeys(f"{row.run}, {row.grows} {row.size}: {row.note}" for row in rows if math.isnan(row.p50)):
        lines.append(f"not timed: {note}")
    return "\n".join(lines)
