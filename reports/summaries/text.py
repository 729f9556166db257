"""The short forms of a run: text for a terminal, summary.md, and the table of the README."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from reports.tables.changes import Changes
from reports.tables.checks import Checks, least_room
from reports.tables.figures import quantity
from reports.tables.run import Run
from runfiles.engines import run_label
from runfiles.metrics import label

LISTED = 10
"""Changes, failures and missing runs that are listed; the page and results.csv have all."""

LOSSES = 5
"""Measures in which another engine is better that are listed."""


@dataclass(frozen=True)
class Column:
    """One column of the table of engines.

    metric  of it
    how     "median", or "over": in how many scenes it is above a micrometre
    loose   flag: only scenes without an avatar
    """

    metric: str
    how: str = "median"
    loose: bool = False


COLUMNS = {
    "overlap, median": Column("residual_overlap_max"),
    "scenes > 1 µm": Column("residual_overlap_max", "over"),
    "bounce error": Column("restitution_error_max"),
    "beyond limit": Column("joint_limit_excess_max"),
    "frame p95": Column("frame_time_p95", loose=True),
}
"""Heads of the table of engines; the first column is the engine."""

BRACKETS = "In brackets: not like for like. Frame times: scenes without an avatar."


def engines(run: Run) -> list[list[str]]:
    """Return a row per engine of short tables: its label and the six figures."""
    table = []
    for name in run.runs:
        own, cells = run.rows[(run.rows.run == name) & run.rows.measured], [run_label(name)]
        for column in COLUMNS.values():
            part = own[(own.metric == column.metric) & ~(column.loose & own.scenario.isin(run.avatars))]
            if part.empty:
                cells.append("–")
                continue
            even = float(part.even.mean()) >= 0.5
            part = part[part.even] if even else part
            unit = str(part.unit.iloc[0])
            text = (
                f"{int((~(part.value <= 1e-6)).sum())} of {len(part)}"
                if column.how == "over"
                else quantity(float(part.value.fillna(float("inf")).median()), unit, 2)
            )
            cells.append(text if even else f"({text})")
        table.append(cells)
    return table


def headline(checks: Checks) -> str:
    """Return PASS or FAIL and the counts."""
    word = "PASS" if checks.is_sound else "FAIL" if len(checks.failed) else "INCOMPLETE"
    counts = [f"{len(checks.passed)} pass"]
    counts += [f"{len(checks.waived)} known exceptions"] if len(checks.waived) else []
    counts += [f"{len(checks.failed)} fail"]
    missing = len(checks.crashed) + len(checks.unmeasured)
    counts += [f"{missing} not measured"] if missing else []
    counts += [] if checks.finished else ["the run did not end"]
    return f"{word}  {checks.total} checks: {', '.join(counts)}"


def blocks(run: Run, checks: Checks, changes: Sequence[Changes], losses: pd.DataFrame) -> list[tuple[str, list[str]]]:
    """Return titles and lines of all parts below the headline; parts without a line are left out but for changes."""
    failed = [_line(row, f"{_limit(row)}   scenes/{row.scenario}.html") for row in checks.failed.itertuples()]
    lacking = pd.concat([checks.crashed, checks.unmeasured]).itertuples()
    missing = [f"{row.scenario:<24}{run_label(row.run):<18}{_brief(_lacking(row))}" for row in lacking]
    waived = [_line(row, f"{_limit(row)}, waived to {quantity(row.waiver, row.unit)}") for row in checks.waived.itertuples()]
    titled = (("failed", failed), ("not measured", missing), ("known exceptions", waived))
    found = [(title, _cut(lines)) for title, lines in titled if lines]
    for change in changes:
        own = change.of(run.gated)
        lines = [f"{row.verdict:<8}{row.scenario:<24}{label(row.metric):<30}{_step(row)}" for row in own.table.itertuples()]
        found.append((f"since {own.since}: {own.count('worse')} worse, {own.count('better')} better", _cut(lines)))
    room = [_line(row, _limit(row)) for row in least_room(checks).itertuples()]
    found += [("least room", room)] if room else []
    lost = [
        f"{row.lost:>3} of {row.scenes:<4}{row.label:<32}{_value(row.own, row.unit):>10} against "
        f"{_value(row.best, row.unit)} ({row.run}, {row.scene})"
        for row in losses[losses.lost > 0].head(LOSSES).itertuples()
    ]
    return found + ([("another engine is better in", lost)] if lost else [])


def changed_lines(found: Changes) -> list[str]:
    """Return all changes, one a line, worse ones first."""
    lines = [f"worse {found.count('worse')}, better {found.count('better')}"]
    for row in found.table.itertuples():
        sure = f" (×{row.low:.2f} to ×{row.high:.2f})" if row.low == row.low else ""
        lines.append(f"{row.verdict:<8}{row.scenario}  {row.run}  {row.metric}: {_step(row).strip()}{sure}")
    lines += [f"gone    {name}" for name in found.gone] + [f"new     {name}" for name in found.added]
    return [*lines, f"times not compared: {found.no_times}"] if found.no_times else lines


def terminal(run: Run, checks: Checks, changes: Sequence[Changes], losses: pd.DataFrame) -> str:
    """Return the last words of a command."""
    lines = [headline(checks)]
    for title, content in blocks(run, checks, changes, losses):
        lines += ["", title, *(f"  {line}" for line in content)]
    rows = [["engine", *COLUMNS], *engines(run)]
    if len(rows) > 2:
        widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
        lines += [
            "",
            *(
                "  "
                + "  ".join(
                    cell.ljust(w) if k == 0 else cell.rjust(w) for k, (cell, w) in enumerate(zip(row, widths, strict=True))
                )
                for row in rows
            ),
            f"  {BRACKETS}",
        ]
    return "\n".join(lines)


def markdown(run: Run, checks: Checks, changes: Sequence[Changes], losses: pd.DataFrame, damage: Sequence[str]) -> str:
    """Return summary.md."""
    info = run.results.provenance
    lines = [f"## {headline(checks).replace('  ', ': ', 1)}", "", *table(run), "", BRACKETS]
    lines += [f"Left out: {said}" for said in damage]
    for title, content in blocks(run, checks, changes, losses):
        lines += ["", f"**{title}**", "```", *(content or ["none"]), "```"]
    refused = sorted(set(checks.refused.scenario))
    tail = [
        f"{str(info.get('commit', ''))[:8]}, {str(info.get('started', ''))[:10]}, {info.get('cpus', '')} × {info.get('cpu', '')}"
    ]
    tail += [f"Refused as expected: {', '.join(refused)}"] if refused else []
    return "\n".join([*lines, "", ". ".join([*tail, "[Report](index.html) · [figures](results.csv)"]), ""])


def table(run: Run) -> list[str]:
    """Return the table of engines as lines of Markdown."""
    heads = ["engine", *COLUMNS]
    lines = ["| " + " | ".join(heads) + " |", "|---|" + "---:|" * (len(heads) - 1)]
    return [*lines, *("| " + " | ".join(row) + " |" for row in engines(run))]


def _line(row: Any, after: str) -> str:
    return f"{row.scenario:<24}{label(row.metric):<30}{_value(row.value, row.unit):>10}   {after}"


def _lacking(row: Any) -> str:
    name, note = str(row.metric), " ".join(str(row.note).split())
    return note if name == "run" else f"{label(name)}: {note}"


def _limit(row: Any) -> str:
    return f"limit {quantity(row.bound, row.unit)}"


def _step(row: Any) -> str:
    return f"{_value(row.old, row.unit):>10} -> {_value(row.new, row.unit)}"


def _value(value: float, unit: str) -> str:
    return "NaN" if value != value or value in (float("inf"), float("-inf")) else quantity(value, unit)


def _cut(lines: list[str]) -> list[str]:
    return lines if len(lines) <= LISTED else [*lines[: LISTED - 1], f"... and {len(lines) - LISTED + 1} more: see the page"]


def _brief(note: object) -> str:
    text = " ".join(str(note).split())
    return text if len(text) <= 80 else text[:77] + "..."
