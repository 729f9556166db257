"""The short forms of a run: text for a terminal, summary.md, and the table of the README."""

import math
from collections.abc import Sequence
from typing import Any

import pandas as pd

from reports.replay.moments import moment
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


COLUMNS = {
    "overlap, median": "residual_overlap_max", "scenes > 1 µm": "residual_overlap_max", "bounce error": "restitution_error_max",
    "beyond limit": "joint_limit_excess_max",
}
"""Heads of the table of engines and their metrics; the first column is the engine, the last its frame time."""
COUNTED = "scenes > 1 µm"
"""Column of numbers of scenes; all others are medians."""

BRACKETS = "In brackets: not like for like. Frame times: scenes without an avatar."


def foot(run: Run) -> str:
    """Return the line below the table of engines: its versions, and what brackets mean."""
    return f"{', '.join(map(' '.join, run.versions.items()))}. {BRACKETS}" if run.versions else BRACKETS


def engines(run: Run) -> list[list[str]]:
    """Return a row per engine of short tables: its label and the figures of `columns`."""
    return [[run_label(name), *(_cell(run, name, head, metric) for head, metric in columns(run).items())] for name in run.runs]


def columns(run: Run) -> dict[str, str]:
    """Return the heads of the table of engines of a run and their metrics."""
    return COLUMNS | {label(run.frame_time): run.frame_time}


def _cell(run: Run, name: str, head: str, metric: str) -> str:
    part = run.typical(metric)
    part = part[part.run == name]
    if part.empty:
        return "–"
    even = bool(part.counted.iloc[0])
    part = part[part.even] if even else part
    if head == COUNTED:
        text = f"{int((~(part.value <= 1e-6)).sum())} of {len(part)}"
    else:
        text = quantity(float(part.value.fillna(float("inf")).median()), str(part.unit.iloc[0]), 2)
    return text if even else f"({text})"


def headline(checks: Checks) -> str:
    """Return PASS or FAIL and the counts."""
    word = "PASS" if checks.is_sound else "FAIL" if len(checks.failed) else "INCOMPLETE"
    counts = {"pass": len(checks.passed), "known exceptions": len(checks.waived), "fail": len(checks.failed),
              "not measured": checks.missing}
    shown = [f"{number} {name}" for name, number in counts.items() if number or name in ("pass", "fail")]
    shown += [] if checks.finished else ["the run did not end"]
    return f"{word}  {checks.total} checks: {', '.join(shown)}"


def blocks(run: Run, checks: Checks, changes: Sequence[Changes], losses: pd.DataFrame) -> list[tuple[str, list[str]]]:
    """Return titles and lines of all parts below the headline; parts without a line are left out but for changes."""
    failed = [_line(row, f"{_limit(row)}   {_address(run, row)}") for row in checks.failed.itertuples()]
    lacking = pd.concat([checks.crashed, checks.unmeasured]).itertuples()
    missing = [f"{row.scenario:<24}{run_label(row.run):<18}{_lacking(row)}" for row in lacking]
    waived = [_line(row, f"{_limit(row)}, waived to {quantity(row.waiver, row.unit)}") for row in checks.waived.itertuples()]
    titled = (("failed", failed), ("not measured", missing), ("known exceptions", waived))
    filled = [(title, _cut(lines)) for title, lines in titled if lines]
    for change in changes:
        own = change.of(run.gated)
        lines = [f"{row.verdict:<8}{row.scenario:<24}{label(row.metric):<30}{_step(row)}" for row in own.table.itertuples()]
        filled.append((f"since {own.since}: {own.count('worse')} worse, {own.count('better')} better", _cut(lines)))
    room = [_line(row, _limit(row)) for row in least_room(checks).itertuples()]
    lost = [
        f"{row.lost:>3} of {row.scenes:<4}{row.label:<32}{_value(one.own, row.unit):>10} against "
        f"{_value(one.best, row.unit)} ({run_label(one.run)}, {one.scene})"
        for row in losses[losses.lost > 0].head(LOSSES).itertuples() for one in row.each[:1]
    ]
    return filled + [(title, lines) for title, lines in (("least room", room), ("another engine is better in", lost)) if lines]


def changed_lines(changes: Changes) -> list[str]:
    """Return all changes, one a line, worse ones first."""
    lines = [f"worse {changes.count('worse')}, better {changes.count('better')}"]
    for row in changes.table.itertuples():
        sure = f" (×{row.low:.2f} to ×{row.high:.2f} beside other engines)" if row.low == row.low else ""
        lines.append(f"{row.verdict:<8}{row.scenario}  {row.run}  {row.metric}: {_step(row).strip()}{sure}")
    lines += [f"gone    {name}" for name in changes.gone] + [f"new     {name}" for name in changes.added]
    return [*lines, f"times not compared: {changes.no_times}"] if changes.no_times else lines


def terminal(run: Run, checks: Checks, changes: Sequence[Changes], losses: pd.DataFrame) -> str:
    """Return the last words of a command."""
    lines = [headline(checks)]
    for title, content in blocks(run, checks, changes, losses):
        lines += ["", title, *(f"  {line}" for line in content)]
    rows = [["engine", *columns(run)], *engines(run)]
    if len(rows) > 2:
        first, *widths = (max(map(len, column)) for column in zip(*rows, strict=True))
        lines.append("")
        for engine, *cells in rows:
            lines.append(f"  {engine:<{first}}" + "".join(f"  {cell:>{w}}" for cell, w in zip(cells, widths, strict=True)))
        lines.append(f"  {foot(run)}")
    return "\n".join(lines)


def markdown(run: Run, checks: Checks, changes: Sequence[Changes], losses: pd.DataFrame, damage: Sequence[str]) -> str:
    """Return summary.md."""
    info = run.results.provenance
    lines = [f"## {headline(checks).replace('  ', ': ', 1)}", "", *table(run), "", foot(run)]
    lines += [f"Left out: {fault}" for fault in damage]
    for title, content in blocks(run, checks, changes, losses):
        lines += ["", f"**{title}**", *(["```", *content, "```"] if content else [])]
    refused = ", ".join(sorted(set(checks.refused.scenario)))
    commit, started = str(info.get("commit") or "")[:8], str(info.get("started", ""))[:10]
    tail = [f"{commit}, {started}, {info.get('cpus', '')} × {info.get('cpu', '')}"]
    tail += [f"Refused as expected: {refused}"] if refused else []
    return "\n".join([*lines, "", ". ".join([*tail, "[Report](index.html) · [figures](results.csv)"]), ""])


def table(run: Run) -> list[str]:
    """Return the table of engines as lines of Markdown."""
    rows = [["engine", *columns(run)], *engines(run)]
    head, *lines = ["| " + " | ".join(row) + " |" for row in rows]
    return [head, "|---|" + "---:|" * len(columns(run)), *lines]


def _line(row: Any, after: str) -> str:
    return f"{row.scenario:<24}{label(row.metric):<30}{_value(row.value, row.unit):>10}   {after}"


def _address(run: Run, row: Any) -> str:
    """Return the page of a figure's scene, at the time of the figure where the run has its series."""
    return f"scenes/{row.scenario}.html{moment(run.results, row.scenario, row.run, row.metric, {})}"


def _lacking(row: Any) -> str:
    """Return the reason of a missing figure in at most 80 characters."""
    note = " ".join(str(row.note).split())
    text = note if row.metric == "run" else f"{label(row.metric)}: {note}"
    return text if len(text) <= 80 else text[:77] + "..."


def _limit(row: Any) -> str:
    return f"limit {quantity(row.bound, row.unit)}"


def _step(row: Any) -> str:
    return f"{_value(row.old, row.unit):>10} -> {_value(row.new, row.unit)}"


def _value(value: float, unit: str) -> str:
    return quantity(value, unit) if math.isfinite(value) else "NaN"


def _cut(lines: list[str]) -> list[str]:
    return lines if len(lines) <= LISTED else [*lines[: LISTED - 1], f"... and {len(lines) - LISTED + 1} more: see the page"]
