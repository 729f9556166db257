"""What the terminal shows: first the cells that are lost, then every cell, then how exact each contender is, and calls' costs."""

import textwrap
from collections.abc import Mapping
from collections.abc import Sequence as Many

import numpy as np

from reference.narrow_phase.rows import COARSE, RIGHT, Row
from reference.narrow_phase.verdict import ALLOWED, Judged, call_costs

SCREEN = 120
"""Columns of a screen."""

CELL = 29
"""Width of the column that names the cell."""

FIGURE = 7
"""Width of a figure."""

DEFAULT = " default"
"""How the names of contenders at a library's defaults end."""


def report(rows: Many[Row], verdicts: Many[Judged], loop: tuple[float, float]) -> str:
    """All of it."""
    parts = [lost_lines(verdicts), *(cell_table(rows, verdicts, mode) for mode in ALLOWED), exactness(rows), costs(rows, loop)]
    missing = {f"{row.engine}: {row.note}" for row in rows if row.note}
    return "\n\n".join([*parts, *sorted(missing)])


def lost_lines(verdicts: Many[Judged]) -> str:
    """By mode, how many cells hold; then the lost ones by name, worst first."""
    lines = []
    for mode, allowed in ALLOWED.items():
        of_mode = [one for one in verdicts if one.mode == mode]
        if of_mode:
            held, called = sum(one.held for one in of_mode), [one for one in of_mode if one.rival_called]
            won = sum(one.ratio_called <= allowed for one in called)
            placed = sum(one.ratio_placed <= allowed for one in of_mode if one.rival)
            lines += textwrap.wrap(
                f"{mode}: {len(of_mode) - held} of {len(of_mode)} cells LOST, {held} hold. Allowed: {allowed:g} of the fastest "
                f"that is right to {RIGHT:g} m, its call from Python taken off. With our world vertices computed in the time "
                f"{placed} hold; with a call per query on both sides {won} of {len(called)}.", SCREEN,
            )
            lost = "; ".join(f"{one.cell.name} {reason(one)}" for one in of_mode if not one.held)
            lines += textwrap.wrap(lost, SCREEN, initial_indent="  LOST ", subsequent_indent="       ")
    return "\n".join(lines)


def reason(one: Judged) -> str:
    """Why a cell is lost, in figures."""
    if not one.ours_right:
        return f"ours is not right to {RIGHT:g} m"
    return f"{one.decisive:.2f} of {one.rival or one.rival_called + ' as called'}"


def cell_table(rows: Many[Row], verdicts: Many[Judged], mode: str) -> str:
    """Microseconds per query in every cell of a mode, the lost cells first. Defaults that are slower or not as exact as the same
    library tuned are left to the file, for width."""
    names = [name for name in dict.fromkeys(row.engine for row in rows) if not name.endswith(DEFAULT)]
    found = {(row.cell, row.engine): row for row in rows if row.mode == mode}
    words = [name.split(" ") for name in names]
    depth = max((len(split) for split in words), default=0)
    lines = [f"{mode}: us per query, median; ! not right to {RIGHT:g} m; last: ours / fastest right one, its call taken off"]
    for k in range(depth):
        heads = [(split[k] if k < len(split) else "")[:FIGURE] for split in words]
        lines.append(" " * CELL + " ".join(f"{head:>{FIGURE}}" for head in heads))
    for one in verdicts:
        if one.mode == mode:
            figures = " ".join(_figure(found.get((one.cell, name))) for name in names)
            mark = " " if one.held else "*"
            against = f"{one.decisive:5.2f} {one.rival or one.rival_called + '/call'}" if one.rival or one.rival_called else ""
            lines.append(f"{mark}{one.cell.name}"[: CELL - 1].ljust(CELL) + f"{figures} {against}")
    return "\n".join(lines)


def _figure(row: Row | None) -> str:
    if row is None or not row.us_p50 == row.us_p50:
        return f"{'-':>{FIGURE}}"
    return f"{row.us_p50:.2f}{' ' if row.right else '!'}".rjust(FIGURE)


def exactness(rows: Many[Row]) -> str:
    """How far every contender is from the exact answer, over all cells, and its typical time."""
    over = [f"> {limit:g}" for limit in (RIGHT, COARSE)]
    lines = [
        "distance from the exact answer: shares of judged queries that are further off [m], and the largest error",
        f"{'':22}{'cells right':>12}{over[0]:>10}{over[1]:>10}{'no answer':>11}{'us cold':>9}{'coherent':>10}  largest",
    ]
    for name, own in _by_engine(rows).items():
        judged = [row for row in own if row.judged]
        if judged:
            weights = [row.judged for row in judged]
            shares = [float(np.average(values, weights=weights)) for values in (
                [row.share_over_right for row in judged], [row.share_over_coarse for row in judged],
                [row.unanswered for row in judged],
            )]
            finite = [row for row in judged if np.isfinite(row.max_error_m)]
            worst = max(finite, key=lambda row: row.max_error_m, default=None)
            largest = f"{worst.max_error_m:.1e} {worst.cell.name}" if worst else "none answered everything"
            right = f"{sum(row.right for row in judged)} of {len(judged)}"
            lines.append(
                f"{name:22}{right:>12}{shares[0]:10.1%}{shares[1]:10.1%}{shares[2]:11.1%}"
                + f"{_typical(judged, 'cold'):9.2f}{_typical(judged, 'coherent'):10.2f}  {largest}"
            )
    return "\n".join([*lines, "times here: geometric means over all cells, right or not, calls included"])


def _typical(rows: Many[Row], mode: str) -> float:
    """Geometric mean [us] over the cells of a mode; nan without any."""
    times = [row.us_p50 for row in rows if row.mode == mode and row.us_p50 > 0.0]
    return float(np.exp(np.mean(np.log(times)))) if times else float("nan")


def costs(rows: Many[Row], loop: tuple[float, float]) -> str:
    """What a call from Python costs, contender by contender, and the harness."""
    found = call_costs(rows)
    names = list(dict.fromkeys(name for name, _ in found))
    said = ", ".join(f"{name} {' / '.join(f'{found[name, m]:.2f}' for m in ALLOWED if (name, m) in found)}" for name in names)
    lines = textwrap.wrap(f"a call from Python (two spheres, cold / coherent) [us]: {said}", SCREEN)
    lines += textwrap.wrap(
        f"the harness, in every figure of a call per query and subtracted from none: clock {loop[0]:.3f} us per query, clock and "
        f"loop of empty calls {loop[1]:.3f} us", SCREEN,
    )
    return "\n".join(lines)


def _by_engine(rows: Many[Row]) -> Mapping[str, list[Row]]:
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row.engine, []).append(row)
    return found
