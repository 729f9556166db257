"""The verdict table on the terminal: a row per scene and engine, and what failed."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from runfiles.naming import BASELINE
from runfiles.table import Row

WIDTH = 140
"""Columns of the terminal that every line fits."""


@dataclass(frozen=True)
class Column:
    """Metric, two lines of heading, factor from the metric's unit to the one shown."""

    metric: str
    heading: tuple[str, str]
    factor: float = 1.0


COLUMNS = (
    Column("residual_overlap_max", ("overlap", "max mm"), 1e3),
    Column("overlap_frames", ("frames", "over %")),
    Column("tracker_offset_rms_free", ("offset", "free mm"), 1e3),
    Column("still_frames", ("still", "%")),
    Column("chatter_frames", ("shakes", "%")),
    Column("joint_limit_excess_max", ("limits", "deg")),
    Column("restitution_error_max", ("restit.", "error")),
    Column("frame_time_p50", ("p50", "us")),
    Column("frame_time_p95", ("p95", "us")),
)
RAW_AFTER = 2
"""The raw tracker's overlap stands behind this many columns, beside the engine's own."""


@dataclass(frozen=True, eq=False)
class Line:
    """All rows of one run, by metric."""

    scenario: str
    run: str
    seed: int
    rows: Mapping[str, Row]

    def value(self, metric: str) -> float | None:
        """The figure of `metric`, None where there is none."""
        return self.rows[metric].value if metric in self.rows else None


def lines(rows: Iterable[Row]) -> list[Line]:
    """Rows gathered by run, in their first order."""
    gathered: dict[tuple[str, str, int], dict[str, Row]] = {}
    for row in rows:
        gathered.setdefault((row.scenario, row.run, row.seed), {})[row.metric] = row
    return [Line(scenario, run, seed, found) for (scenario, run, seed), found in gathered.items()]


def figure(value: float | None, factor: float = 1.0) -> str:
    """Three significant digits; a dash for nothing."""
    if value is None:
        return "-"
    if not math.isfinite(value):
        return "NaN" if math.isnan(value) else "inf"
    shown = value * factor
    return f"{shown:.0f}" if abs(shown) >= 1000.0 else f"{shown:.3g}"


def verdict(line: Line, gated: frozenset[tuple[str, str]]) -> str:
    """One word in capitals for the gated engine, in brackets for all others, whose figures are information only."""
    rows = list(line.rows.values())
    run = line.rows.get("run")
    if run is not None:
        return run.status.replace("-", " ")
    if tuple(line.run.split("/", 1)) in gated:
        failed = sum(row.status == "fail" for row in rows)
        if failed:
            return f"FAIL ({failed})"
        if any(row.status in ("not-measured", "crashed") for row in rows):
            return "NOT MEASURED"
        waived = sum(row.status == "waived" for row in rows)
        return f"PASS ({waived} waived)" if waived else "PASS"
    broken = [row for row in rows if row.bound is not None and not (row.value is not None and row.value <= row.bound)]
    return f"(breaks {len(broken)})" if broken else "(holds)"


def table(rows: Sequence[Row], gated: frozenset[tuple[str, str]]) -> str:
    """The whole verdict, every line at most WIDTH wide."""
    found = lines(rows)
    raw = {(line.scenario, line.seed): line.value("residual_overlap_max") for line in found if _engine(line) == BASELINE}
    seeds: dict[str, set[int]] = {}
    for line in found:
        seeds.setdefault(line.scenario, set()).add(line.seed)
    first, second = ([column.heading[k] for column in COLUMNS] for k in (0, 1))
    cells = [["scene", "engine/preset", *first, "verdict"], ["", "", *second, ""]]
    for head, text in zip(cells, ("raw", "max mm"), strict=True):
        head.insert(2 + RAW_AFTER, text)
    previous = ""
    for line in found:
        name = f"{line.scenario}#{line.seed}" if len(seeds[line.scenario]) > 1 else line.scenario
        row = [name if name != previous else "", line.run]
        row += [figure(line.value(column.metric), column.factor) for column in COLUMNS]
        row.insert(2 + RAW_AFTER, figure(raw.get((line.scenario, line.seed)), 1e3))
        cells.append([*row, verdict(line, gated)])
        previous = name
    widths = [max(len(row[k]) for row in cells) for k in range(len(cells[0]))]
    last = len(widths) - 1

    def joined(row: list[str]) -> str:
        sized = enumerate(zip(row, widths, strict=True))
        aligned = (text.ljust(width) if k in (0, 1, last) else text.rjust(width) for k, (text, width) in sized)
        return "  ".join(aligned).rstrip()[:WIDTH]

    rule = "-" * min(WIDTH, sum(widths) + 2 * last)
    texts = [joined(row) for row in cells]
    body = []
    # rules keep the engines of a scene together; where there is one only, a scene is a line
    ruled = len(found) > len({(line.scenario, line.seed) for line in found})
    for k, (row, text) in enumerate(zip(cells[2:], texts[2:], strict=True)):
        body += [rule, text] if k == 0 or (ruled and row[0]) else [text]
    legend = (
        "overlap: deepest penetration of a state shown; frames over: share above 0.001 mm; raw: the tracker's own posture;",
        "offset free: from the tracker where the way is free; still: the user moves, the avatar does not; shakes: frames in",
        "contact in which a link goes to and fro while its target does not;",
        "in brackets: information about engines that are not gated.",
    )
    return "\n".join([*texts[:2], *body, rule, *legend, *remarks(found, gated)])


def _engine(line: Line) -> str:
    return line.run.split("/", 1)[0]


def remarks(found: list[Line], gated: frozenset[tuple[str, str]]) -> list[str]:
    """What failed, is waived or is missing, each a line that names the row."""
    said = []
    for line in found:
        for row in line.rows.values():
            if row.status in ("fail", "waived", "crashed", "not-measured"):
                limit = row.bound if row.ceiling is None else row.ceiling
                shown = "" if row.value is None else f" {row.value:.4g}"
                wanted = "" if limit is None else f" (limit {limit:g})"
                said.append(f"{row.status}: {line.scenario} {line.run} {row.metric}{shown}{wanted} {row.note}".rstrip()[:WIDTH])
    return said
