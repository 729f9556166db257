"""The gate: what holds, what does not, and the exit code that follows. Missing data is never a pass."""

import math
import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

from avatarsim.console import FAULT
from avatarsim.errors import InvalidFile, UnknownName
from runfiles.metrics import unit
from runfiles.table import Row, Status
from scenarios.job import Outcome
from scenarios.measure.value import Missing, Value
from scenarios.scenario import Bound, Scenario

CEILINGS = Path(__file__).parents[1] / "ceilings.toml"
"""Per scene and metric, up to where a bound that does not hold yet is waived. A ceiling may only shrink."""

EVERYWHERE = (
    Bound("residual_overlap_max", 1e-6, "nothing shown may overlap"),
    Bound("not_finite_frames", 0.0, "a pose that is not a number cannot be shown"),
)
"""Bounds of every scene, whether or not it states them."""

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
OTHERWISE: Mapping[Status, str] = {"waived": "waived", "fail": "failed"}
"""Statuses of checks that do not pass, in words."""
UNGATED = "nothing was gated"
"""What code 0 means when no bound was put to the test."""

Ceilings = Mapping[str, Mapping[str, float]]


def ceilings(path: Path = CEILINGS) -> Ceilings:
    """scene -> metric -> ceiling. Without the file the gate stands at the bounds. Raises InvalidFile."""
    if not path.exists():
        return {}
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise InvalidFile(str(path), str(error), "TOML: a table per scene, metric = number") from error
    for scene, entries in found.items():
        if not isinstance(entries, dict) or not all(isinstance(limit, int | float) for limit in entries.values()):
            raise InvalidFile(f"[{scene}] in {path}", entries, "metric = number")
        for metric, limit in entries.items():
            unit(metric)
            if not math.isfinite(limit):
                raise InvalidFile(f"[{scene}] {metric} in {path}", limit, "a finite number")
    return found


def bounds_of(scenario: Scenario) -> dict[str, Bound]:
    """The scenario's bounds by metric, with those that hold everywhere; UnknownName for a metric that is not measured."""
    bounds = {bound.metric: bound for bound in (*EVERYWHERE, *scenario.bounds)}
    for metric in (*bounds, *scenario.metrics):
        unit(metric)
    return bounds


def judged(value: Value | None, limit: float, ceiling: float | None) -> tuple[Status, str]:
    """Status and remark of one bounded metric of the gated engine; None is a metric that no measure gave."""
    if value is None:
        return "not-measured", "no measure gave a value"
    if isinstance(value, Missing):
        return ("fail" if value.fault == "engine" else "not-measured"), value.reason
    stands = limit if ceiling is None else ceiling
    # written so that nan fails
    if not value <= stands:
        return "fail", f"above {stands:g}" if math.isfinite(value) else "not a number"
    if value <= limit:
        return "pass", ""
    return "waived", f"above the bound {limit:g}, waived up to {stands:g}"


def rows_of(outcome: Outcome, scenario: Scenario, limits: Mapping[str, float], gated: bool) -> list[Row]:
    """All rows of one outcome; `limits` are the scene's ceilings. Only a `gated` one passes or fails."""
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
    rows = []
    wanted = [*bounds, *(name for name in scenario.metrics if name not in bounds)]
    for metric in dict.fromkeys([*wanted, *outcome.values]):
        value, note = outcome.values.get(metric), outcome.notes.get(metric, "")
        number = value if isinstance(value, float) else None
        status: Status
        if gated and metric in bounds:
            status, why = judged(value, bounds[metric].limit, limits.get(metric))
        elif number is not None:
            status, why = "info", "" if math.isfinite(number) else "not a number"
        elif value is None and metric not in scenario.metrics:
            # an information row with neither a value nor a reason says nothing
            continue
        else:
            missing = value if isinstance(value, Missing) else Missing("no measure gave a value", "scene")
            # what an engine fails to do is information about it; what could not be measured leaves the comparison incomplete,
            # unless neither a bound nor the scenario asked for it
            asked = missing.fault == "package" or (gated and metric in wanted)
            status, why = ("not-measured" if asked and missing.fault != "engine" else "info"), missing.reason
        rows.append(row(metric, number, status, "; ".join(part for part in (why, note) if part)))
    return rows


def exit_code(rows: Iterable[Row]) -> int:
    """1 when a gated bound failed, else 3 when something crashed or was not measured, else 0."""
    statuses = {row.status for row in rows}
    if "fail" in statuses:
        return FAILED
    return INCOMPLETE if statuses & {"crashed", "not-measured"} else PASSED


def checks(rows: Iterable[Row]) -> str:
    """Count the checks among `rows`: "796 of 798 checks pass, 2 waived"; "" where there is none."""
    found = Counter(row.status for row in rows)
    total = found["pass"] + found["waived"] + found["fail"]
    others = "".join(f", {found[status]:,} {word}" for status, word in OTHERWISE.items() if found[status])
    return f"{found['pass']:,} of {total:,} {'check passes' if total == 1 else 'checks pass'}{others}" if total else ""


def meaning(code: int, rows: Iterable[Row], gated: frozenset[tuple[str, str]]) -> str:
    """`code` in words, with the number of checks that pass, are waived or fail where it is about these. Where no bound met a
    gated engine and preset, nothing was gated."""
    tested = [row for row in rows if (row.engine, row.preset) in gated and (row.bound is not None or row.status == "refused")]
    if code not in (PASSED, FAILED):
        return MEANINGS[code]
    if not tested:
        return UNGATED if code == PASSED else MEANINGS[code]
    counted = checks(tested)
    return f"{MEANINGS[code]}: {counted}" if code == FAILED else counted or MEANINGS[code]


def presets_of(name: str, presets: tuple[str, ...], asked: Iterable[str]) -> list[str]:
    """Presets of one engine to run: those `asked` for that it has, all when none is; UnknownName when it has none of them."""
    wanted = list(asked)
    if not wanted:
        return list(presets)
    chosen = [preset for preset in wanted if preset in presets]
    if not chosen:
        raise UnknownName(f"preset of engine {name}", ", ".join(wanted), presets)
    return chosen
