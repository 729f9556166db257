"""The gate: status of each check, and the exit code that follows. Missing data is never a pass."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

from avatarsim.console import FAULT
from avatarsim.errors import InvalidFile
from avatarsim.files import read_toml
from runfiles.metrics import unit
from runfiles.table import Row, Status
from scenarios.job import Outcome
from scenarios.measure.value import Missing, Value
from scenarios.scenario import Bound, Scenario

CEILINGS = Path(__file__).parents[1] / "ceilings.toml"
"""Limits, per scene and metric, up to which a broken bound is waived. They may only shrink."""
MOST_BYTES = 2**20
"""Bytes of that file."""

EVERYWHERE = (
    Bound("residual_overlap_max", 1e-6, "nothing shown may overlap"),
    Bound("not_finite_frames", 0.0, "a pose that is not a number cannot be shown"),
)
"""Bounds of every scene."""

PASSED, FAILED, USAGE, INCOMPLETE, NOTHING, STOPPED = 0, 1, 2, 3, 5, 130
MEANINGS = {
    PASSED: "every check passes or is waived",
    FAILED: "a gated bound failed",
    USAGE: "wrong usage",
    INCOMPLETE: "an engine is missing or crashed, or something was not measured",
    NOTHING: "a name or pattern of the filter matched no scene",
    FAULT: "a fault of the program",
    STOPPED: "stopped before the end",
}
"""Exit codes. A failed bound wins over an incomplete comparison."""

Ceilings = Mapping[str, Mapping[str, float]]


def ceilings(path: Path = CEILINGS) -> Ceilings:
    """Return scene -> metric -> limit of the waiver; none without the file. Raises InvalidFile."""
    if not path.exists():
        return {}
    limits: dict[str, dict[str, float]] = {}
    for scene, entries in read_toml(path, str(path), "TOML: a table per scene, metric = number", MOST_BYTES).items():
        for metric, limit in entries.items() if isinstance(entries, dict) else [(scene, entries)]:
            if not isinstance(entries, dict) or not isinstance(limit, int | float) or not math.isfinite(limit):
                raise InvalidFile(f"[{scene}] {metric} in {path}", limit, "a table of metric = finite number")
            unit(metric)
            limits.setdefault(scene, {})[metric] = limit
    return limits


def bounds_of(scenario: Scenario) -> dict[str, Bound]:
    """Return all bounds of a scenario by metric. Raises UnknownName for a metric that is not measured."""
    bounds = {bound.metric: bound for bound in (*EVERYWHERE, *scenario.bounds)}
    for metric in (*bounds, *scenario.metrics):
        unit(metric)
    return bounds


def judged(value: Value | None, limit: float, ceiling: float | None) -> tuple[Status, str]:
    """Return status and note of a bounded metric of the gated engine; None is a metric that no measure gave."""
    if value is None:
        return "not-measured", "no measure gave a value"
    if isinstance(value, Missing):
        return ("fail" if value.fault == "engine" else "not-measured"), value.reason
    waiver = limit if ceiling is None else ceiling
    # written so that nan fails
    if not value <= waiver:
        return "fail", f"above {waiver:g}" if math.isfinite(value) else "not a number"
    if value <= limit:
        return "pass", ""
    return "waived", f"above the bound {limit:g}, waived up to {waiver:g}"


def rows_of(outcome: Outcome, scenario: Scenario, limits: Mapping[str, float], gated: bool) -> list[Row]:
    """Return all rows of an outcome.

    Args:
        limits: waivers of the scene, by metric.
        gated: its bounds pass or fail; of others every row is information.
    """
    job, bounds = outcome.job, bounds_of(scenario)

    def row(metric: str, value: float | None, status: Status, note: str = "") -> Row:
        bound = bounds.get(metric)
        return Row(
            scenario=job.scenario, engine=job.engine, preset=job.preset, seed=job.seed, frames=outcome.frames, metric=metric,
            value=value, unit=unit(metric), bound=bound.limit if bound else None,
            ceiling=limits.get(metric) if bound else None, status=status, note=note,
        )

    if outcome.state != "measured":
        return [row("run", None, outcome.state, outcome.note)]
    rows, wanted = [], (*bounds, *scenario.metrics)
    for metric in dict.fromkeys([*wanted, *outcome.values]):
        value, note = outcome.values.get(metric), outcome.notes.get(metric, "")
        number = value if isinstance(value, float) else None
        status: Status
        if gated and metric in bounds:
            status, why = judged(value, bounds[metric].limit, limits.get(metric))
        elif number is not None:
            status, why = "info", "" if math.isfinite(number) else "not a number"
        elif value is None and metric not in scenario.metrics:
            # information without a value or a reason
            continue
        else:
            missing = value if isinstance(value, Missing) else Missing("no measure gave a value", "scene")
            # a failure of the engine is information about it; anything else that was wanted leaves the comparison incomplete
            needed = missing.fault == "package" or (gated and metric in wanted and missing.fault != "engine")
            status, why = ("not-measured" if needed else "info"), missing.reason
        rows.append(row(metric, number, status, "; ".join(part for part in (why, note) if part)))
    return rows


def exit_code(rows: Iterable[Row]) -> int:
    """Return 1 when a gated bound failed, else 3 when something crashed or was not measured, else 0."""
    statuses = {row.status for row in rows}
    if "fail" in statuses:
        return FAILED
    return INCOMPLETE if statuses & {"crashed", "not-measured"} else PASSED


def meaning(code: int, rows: Iterable[Row], gated: frozenset[tuple[str, str]]) -> str:
    """Return an exit code in words, with the numbers of checks where it is about these: "796 of 798 checks pass, 2 waived"."""
    tested = [row for row in rows if (row.engine, row.preset) in gated and (row.bound is not None or row.status == "refused")]
    if code == PASSED and not tested:
        return "nothing was gated"
    counts = Counter(row.status for row in tested)
    total = counts["pass"] + counts["waived"] + counts["fail"]
    if code not in (PASSED, FAILED) or not total:
        return MEANINGS[code]
    others = "".join(f", {counts[status]:,} {status}" for status in ("waived", "fail") if counts[status])
    counted = f"{counts['pass']:,} of {total:,} {'check passes' if total == 1 else 'checks pass'}{others}"
    return counted if code == PASSED else f"{MEANINGS[code]}: {counted}"
