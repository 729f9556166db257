"""The verdict table as data: one block per scene, one line per engine and preset, one cell per column."""

import math
from collections import defaultdict
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from reports.deciding.alike import asleep, sleepers
from reports.deciding.columns import COLUMNS, Column, is_truth_error, ratio_to_best, truth_metric, worst
from reports.reading.load import Results, Row
from runfiles.like_for_like import with_avatar
from runfiles.sayable import Unsaid
from runfiles.timing_protocol import may_rank

# The engine whose rows are the raw tracker motion: no contact handling at all. It shows how large the problem is and can win
# nothing, because its distance from itself is zero and it costs no time.
RAW_TRACKER = "tracker"
# The engine and preset that the gate covers unless the rows themselves say another.
OURS = "avatarsim/default"
# Statuses that speak about a whole run, worst first.
RUN_WORDS = ("crashed", "not-measured", "refused", "cannot-say")


@dataclass(frozen=True)
class Cell:
    """One number of the table. `word` replaces the number where there is none; `ratio` is to the best, None if not ranked;
    `unsaid`: why the number does not judge its engine, "" where it does."""

    row: Row | None
    word: str
    ratio: float | None
    best: bool
    unsaid: str = ""

    @property
    def value(self) -> float | None:
        """The number itself; None where there is none."""
        return self.row.value if self.row else None


@dataclass(frozen=True)
class Line:
    """One engine and preset in one scene. `trouble` says what makes the whole run suspect, `nothing` why it has no number
    at all; both are "" otherwise."""

    run: str
    cells: tuple[Cell, ...]
    trouble: str
    tracker: bool
    ours: bool
    nothing: str = ""


@dataclass(frozen=True)
class Block:
    """One scene of the table; `truth` names the metric in the ground-truth column, `ceiling` is up to where
    the bound of overlap is waived."""

    scene: str
    title: str
    lines: tuple[Line, ...]
    truth: str | None
    ceiling: float | None
    asleep: tuple[str, ...] = ()
    """Engines and presets that sleep in the median frame: of medians no factor is made then."""
    asleep_through: tuple[str, ...] = ()
    """Those of them that sleep in the frame of the 95th percentile too."""
    avatar: bool = False
    """Whether the scene has an avatar: its times stand side by side."""


def gated_run(rows: Iterable[Row]) -> str:
    """The engine and preset under the gate: whichever carries pass or fail, by default avatarsim/default."""
    return next((row.run for row in rows if row.status in ("pass", "waived", "fail")), OURS)


def blocks(results: Results, first: Sequence[str] = ()) -> tuple[Block, ...]:
    """One block per scene, those named in `first` before the others."""
    order = [*(s for s in dict.fromkeys(first) if s in results.scenes()), *results.scenes()]
    grouped: dict[str, list[Row]] = defaultdict(list)
    for row in results.rows:
        grouped[row.scenario].append(row)
    ours = gated_run(results.rows)
    sleeping = sleepers(results)
    return tuple(_block(s, grouped[s], results.titles.get(s, ""), ours, results.unsaid, sleeping.get(s, {}))
                 for s in dict.fromkeys(order))


def together(results: Results, scenes: Container[str], title: str) -> Block:
    """Several scenes as one block called `title`: of each run the worst figure over all of them."""
    rows = [row for row in results.rows if row.scenario in scenes]
    return _block(title, rows, title, gated_run(results.rows), results.unsaid)


def _block(
    scene: str, rows: list[Row], title: str, ours: str, unsaid: Unsaid, sleeping: Mapping[str, float] = MappingProxyType({}),
) -> Block:
    truth = truth_metric(rows)
    runs: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        runs[row.run].append(row)
    found = {run: [_worst_in(own, column, truth) for column in COLUMNS] for run, own in runs.items()}
    rivals = {run: rows for run, rows in found.items() if run == ours or engine_of(run) not in (RAW_TRACKER, engine_of(ours))}
    # of a time in which one sleeps, or of an avatar that is kinematic in one and dynamic in others, no factor is made
    avatar = bool(with_avatar(rows))
    best = [None if asleep(sleeping, column.key) or (avatar and column.unit == "us") else _best(column, rivals, index, unsaid)
            for index, column in enumerate(COLUMNS)]
    lines = [
        _line(run, runs[run], found[run], best, ours, unsaid) for run in sorted(runs, key=lambda run: _order(run, ours))
    ]
    overlap = [row.ceiling for row in rows if row.metric == "residual_overlap_max" and row.ceiling is not None]
    return Block(scene, title, tuple(lines), truth, max(overlap, default=None), asleep(sleeping, "p50"),
                 asleep(sleeping, "p95"), avatar)


def engine_of(run: str) -> str:
    """The engine of "engine/preset"."""
    return run.partition("/")[0]


def _order(run: str, ours: str) -> tuple[int, str]:
    """The gated run first, its other presets next, the other engines by name, the raw tracker last."""
    engine = run.split("/")[0]
    if run == ours:
        return (0, run)
    if engine == RAW_TRACKER:
        return (3, run)
    return (1, run) if engine == ours.split("/")[0] else (2, run)


def _worst_in(rows: list[Row], column: Column, truth: str | None) -> Row | None:
    fitting = [r for r in rows if column.takes(r.metric) and (column.key != "truth" or r.metric == truth)]
    return worst(fitting)


def _why(row: Row, unsaid: Unsaid) -> str:
    return unsaid.why(row.scenario, row.run, row.metric)


def _best(column: Column, found: dict[str, list[Row | None]], index: int, unsaid: Unsaid) -> float | None:
    """The smallest finite value of the column among `found`, our gated run and its rivals; no run that left the room counts,
    nor one that has no words for what is measured."""
    candidates = []
    judged = [rows for rows in found.values()
              if (row := rows[index]) is not None and not _why(row, unsaid) and may_rank(row.metric, row.note)]
    for rows in judged if column.ranked else ():
        row = rows[index]
        if row is None or row.value is None or not math.isfinite(row.value):
            continue
        if column.stays_inside and left_room(rows):
            continue
        candidates.append(row.value)
    # alone, none is best
    return min(candidates, default=None) if len(judged) > 1 else None


def left_room(rows: Sequence[Row | None]) -> bool:
    """Whether a run whose rows these are, one per column, has a frame on the wrong side."""
    side = rows[next(i for i, column in enumerate(COLUMNS) if column.key == "wrong_side")]
    return side is not None and side.value is not None and not side.value <= 0.0


def _line(
    run: str, rows: list[Row], found: list[Row | None], best: list[float | None], ours: str, unsaid: Unsaid,
) -> Line:
    tracker = engine_of(run) == RAW_TRACKER
    sibling = run != ours and engine_of(run) == engine_of(ours)
    word = next((word for word in RUN_WORDS if any(row.status == word for row in rows)), "")
    cells = []
    for column, row, least in zip(COLUMNS, found, best, strict=True):
        value = row.value if row else None
        why = _why(row, unsaid) if row and not tracker else ""
        aside = tracker or why or (row is not None and not may_rank(row.metric, row.note))
        ratio = None if aside else ratio_to_best(value, least, column.same, column.share)
        no_number = row.status if row and row.status in RUN_WORDS else word if row is None else ""
        unranked = sibling or (column.stays_inside and left_room(found))
        best_here = ratio is not None and ratio <= 1.0 and not unranked
        cells.append(Cell(row, no_number if value is None else "", ratio, best_here, why))
    note = next((row.note for row in rows if row.status == word and row.note), "")
    nothing = f"{word}: {note}".removesuffix(": ") if word and all(cell.value is None for cell in cells) else ""
    return Line(run, tuple(cells), _trouble(rows, word), tracker, run == ours, nothing)


def _trouble(rows: list[Row], word: str) -> str:
    broken = [row for row in rows if row.metric == "not_finite_frames" and row.value is not None and not row.value <= 0.0]
    if broken:
        return "shows NaN"
    return word if word in ("crashed", "not-measured") else ""


def ranked_metrics(block: Block) -> tuple[str, ...]:
    """The metric behind each column of this block, for readers that look it up in results.csv."""
    names = []
    for index, column in enumerate(COLUMNS):
        row = next((line.cells[index].row for line in block.lines if line.cells[index].row), None)
        names.append(row.metric if row else (block.truth or "") if column.key == "truth" else "")
    return tuple(names)


def more_truths(results: Results, block: Block) -> tuple[str, ...]:
    """Names of the scene's other ground-truth errors, which only results.csv lists."""
    names = {row.metric for row in results.of(block.scene) if is_truth_error(row.metric)}
    return tuple(sorted(names - {block.truth or ""}))
