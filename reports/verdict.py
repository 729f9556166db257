"""The verdict: what held, what failed, what crashed, what was not measured, and what we lose, worst first."""

import math
from dataclasses import dataclass

from reports.columns import COLUMNS
from reports.load import Results, Row
from reports.tables import RAW_TRACKER, Block, Line, blocks, gated_run
from reports.wording import count, limit, quantity

# Frame times of two runs closer than this are a draw: repeats on a busy host differ by that much.
TIME_DRAW = 1.10
# Other measures closer than this are a draw.
MEASURE_DRAW = 1.01


@dataclass(frozen=True)
class Loss:
    """One thing we lose. `severity` orders: a gated bound that does not hold outweighs any comparison."""

    scene: str
    what: str
    ours: str
    theirs: str
    severity: tuple[int, float]


@dataclass(frozen=True)
class Verdict:
    """Rows of the gate by outcome; crashed and unmeasured also hold one row per run of the other engines."""

    gated: str
    held: tuple[Row, ...]
    failed: tuple[Row, ...]
    crashed: tuple[Row, ...]
    unmeasured: tuple[Row, ...]
    neutral: tuple[Row, ...]
    losses: tuple[Loss, ...]
    exit_code: int

    @property
    def word(self) -> str:
        """One word for the whole run; it is "held" only when nothing at all is wrong or missing."""
        if self.failed:
            return "failed"
        if self.crashed:
            return "crashed"
        if self.unmeasured:
            return "incomplete"
        return "held" if self.held else "empty"

    @property
    def sentence(self) -> str:
        """The verdict line."""
        total = len(self.held) + len(self.failed)
        if self.word == "empty":
            return f"No verdict: this run has no gated measurement of {self.gated}."
        parts = [f"{len(self.failed)} of {count(total, 'gated bound')} of {self.gated} failed"] if self.failed else []
        parts += [f"{count(len(self.crashed), 'run')} crashed"] if self.crashed else []
        parts += [f"{len(self.unmeasured):,} not measured"] if self.unmeasured else []
        if not parts:
            return "The bound held." if total == 1 else f"All {total:,} gated bounds of {self.gated} held."
        if not self.failed and total:
            parts.append(f"{'the one gated bound' if total == 1 else f'all {total:,} gated bounds'} that were measured held")
        return "; ".join(parts)[:1].upper() + "; ".join(parts)[1:] + "."


def believed(row: Row) -> str:
    """The status of a row, unless its own numbers contradict it: a pass needs a finite value that is within the limit."""
    if row.status != "pass":
        return row.status
    if row.value is None:
        return "not-measured"
    return "pass" if math.isfinite(row.value) and (row.limit is None or row.value <= row.limit) else "fail"


def verdict(results: Results) -> Verdict:
    """Judge a run from its rows alone."""
    ours = gated_run(results.rows)
    by_word: dict[str, list[Row]] = {word: [] for word in ("pass", "fail", "crashed", "not-measured", "neutral")}
    runs_seen: set[tuple[str, str, int, str]] = set()
    for row in results.rows:
        word = believed(row)
        if word in ("pass", "fail"):
            by_word[word].append(row)
        elif word in ("crashed", "not-measured"):
            key = (row.scenario, row.run, row.seed, row.metric if row.run == ours and word == "not-measured" else word)
            if key not in runs_seen:
                runs_seen.add(key)
                by_word[word].append(row)
        elif row.run == ours and word in ("cannot-say", "refused"):
            by_word["neutral"].append(row)
    by_word["not-measured"] += _gaps(results, ours)
    failed = tuple(sorted(by_word["fail"], key=lambda row: -excess(row)))
    code = 1 if failed else 3 if by_word["crashed"] or by_word["not-measured"] else 0 if results.rows else 5
    return Verdict(
        ours, tuple(by_word["pass"]), failed, tuple(by_word["crashed"]), tuple(by_word["not-measured"]),
        tuple(by_word["neutral"]), _losses(results, failed, ours), code,
    )


def excess(row: Row) -> float:
    """How many times its limit a failed row has; infinite when it is not finite or the limit is zero."""
    if row.value is None or not math.isfinite(row.value):
        return math.inf
    limit = row.limit or 0.0
    return row.value / limit if limit > 0.0 else math.inf


def _gaps(results: Results, ours: str) -> list[Row]:
    """One row for each scene in which the gated run has no row at all, though it took part elsewhere."""
    if not any(row.run == ours for row in results.rows):
        return []
    present = {row.scenario for row in results.rows if row.run == ours}
    engine, preset = ours.split("/", 1)
    return [
        Row(scene, engine, preset, 0, 0, "", None, "", None, None, "not-measured", "no row of this run in results.json")
        for scene in results.scenes() if scene not in present
    ]


def _losses(results: Results, failed: tuple[Row, ...], ours: str) -> tuple[Loss, ...]:
    found = [
        Loss(
            row.scenario, row.metric, quantity(row.value, row.unit),
            f"limit {limit(row.limit, row.unit)}" + (f", {row.note}" if row.note else ""), (2, excess(row)),
        )
        for row in failed
    ]
    for block in blocks(results):
        line = next((line for line in block.lines if line.run == ours), None)
        if line is not None:
            found += _lost_cells(block, line)
    return tuple(sorted(found, key=lambda loss: loss.severity, reverse=True))


def _lost_cells(block: Block, line: Line) -> list[Loss]:
    """Every column in which another engine (the raw tracker aside) did better than our line, beyond a draw."""
    lost = []
    for index, (column, cell) in enumerate(zip(COLUMNS, line.cells, strict=True)):
        draw = TIME_DRAW if column.unit == "us" else MEASURE_DRAW
        if cell.row is None or cell.ratio is None or not cell.ratio > draw:
            continue
        rivals = [o for o in block.lines if o is not line and not o.run.startswith(RAW_TRACKER + "/") and o.cells[index].best]
        theirs = ", ".join(f"{o.run} {quantity(o.cells[index].value, cell.row.unit)}" for o in rivals)
        lost.append(Loss(block.scene, cell.row.metric, quantity(cell.value, cell.row.unit), theirs, (1, cell.ratio)))
    return lost


def losing_scenes(verdict_: Verdict) -> tuple[str, ...]:
    """Scenes in the order in which a reader should see them: failed and lost first."""
    troubled = [row.scenario for row in verdict_.crashed + verdict_.unmeasured if row.run == verdict_.gated]
    failed = [row.scenario for row in verdict_.failed]
    return tuple(dict.fromkeys([*failed, *troubled, *(loss.scene for loss in verdict_.losses)]))
