"""One row per scene, setting and error, as sweep.csv holds them, the Pareto front of each scene and error, and its table."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import isfinite

from avatarsim.scene.scene import Scene
from runfiles.comparable import unsupported
from runfiles.engines import about
from runfiles.metrics import unit
from scenarios import catalog
from scenarios.results.store import Entry
from scenarios.studies.sweep.cell import Cell
from scenarios.studies.sweep.copyable import copyable
from scenarios.studies.sweep.grid import Setting, sleeps

Point = tuple[float, float]
"""Time and error; a point that is not finite is on no front and beats no point."""


def beats(a: Point, b: Point) -> bool:
    """Whether `a` is at least as good as `b` in both and better in one."""
    return a[0] <= b[0] and a[1] <= b[1] and a != b


def front(points: Sequence[Point]) -> list[bool]:
    """For each point whether no other beats it, in one pass over the points sorted by time."""
    found = [False] * len(points)
    usable = [k for k, (time, error) in enumerate(points) if isfinite(time) and isfinite(error)]
    least, best = float("inf"), (float("nan"), float("nan"))
    for k in sorted(usable, key=lambda k: points[k]):
        # equals of a point on the front are on it too
        if points[k][1] < least or points[k] == best:
            found[k], least, best = True, points[k][1], points[k]
    return found


WRONG_SIDE, NOT_FINITE, GAP = "wrong_side_frames", "not_finite_frames", "contact_gap_p50"

REACHED: Mapping[str, float] = {"m": 1e-6, "deg": 1e-6, "": 1e-6, "m/s": 1e-6, "rad/s": 1e-5, "%": 1e-2, "s": 1e-6, "frames": 0.0}
"""By unit, the error that counts as none: the bounds of the catalogue. Smaller figures differ by rounding or by the judge's own
error, and 1e-9 m is not more accurate than 1e-8 m."""


@dataclass(frozen=True)
class Row:
    """`error` of one setting in one scene and the median and 99th percentile of its frame [us]; nan where there is none.

    `state`: measured; wrong-side (the error is small because something went through a wall), not-finite, crashed, cannot-say,
    not-measured, refused. `front`: "all" on the front of all engines, "own" on that of its own engine only, else empty.
    `reached`: the error that counts as none. `base` is the preset beneath the setting, `options` the setting as text to copy,
    `settable` the same in the engine's own words where nothing else follows from it, `repeats` and `frames` what its times stand
    on. `p95` [us]; `rests` is the share of frames in which nothing moves, `moving` and `at_rest` the median [us] of either kind
    where both are many; `sleeps` 1 where what rests falls asleep; `step` is the engine's own time step [s]; `avatar` 1 where the
    scene has an avatar, which is kinematic in ours and dynamic in the others; `slowest` is its slowest frame [us], `gap` the
    median [m] from an avatar to what it touches, nan without one.
    """

    scenario: str
    engine: str
    setting: str
    metric: str
    unit: str
    error: float
    p50: float
    p99: float
    state: str
    front: str
    reached: float
    note: str
    base: str = ""
    options: str = ""
    repeats: int = 0
    frames: int = 0
    settable: str = ""
    p95: float = math.nan
    rests: float = math.nan
    moving: float = math.nan
    at_rest: float = math.nan
    sleeps: int = 0
    step: float = math.nan
    avatar: int = 0
    slowest: float = math.nan
    gap: float = math.nan


def rows_of(cell: Cell, errors: Sequence[str], found: Entry | None, clocked: Entry | None) -> list[Row]:
    """The rows of one cell: a row per error that applies, or one with the reason where nothing was measured."""
    setting, values = cell.setting, {} if found is None else found["values"]
    missing = {} if found is None else found["missing"]
    state, note = ("not-measured", "not run yet") if found is None else (found["state"], found["note"])
    base = _beside(cell, found, clocked)
    rows = []
    for metric in errors:
        if state == "measured" and metric not in values and metric not in missing:
            continue
        error, of = float(values.get(metric, math.nan)), unit(metric)
        why = _state(state, metric, values)
        said = note or missing.get(metric, "") or ("" if clocked is None or clocked["p50"] else clocked["note"])
        features = {} if found is None else found.get("cannot_say", {})
        silent = unsupported(f"{setting.engine}/{setting.base}", features).get(metric, "")
        if silent:
            error, why, said = math.nan, "cannot-say", silent
        rows.append(replace(base, metric=metric, unit=of, error=error, state=why, reached=REACHED.get(of, 0.0), note=said))
    return rows


def settable(setting: Setting) -> str:
    """Return a setting in the engine's own words, "" unless that is all that it changes in what its preset loads."""
    one = about(setting.engine)
    return "; ".join(one.in_own_words(setting.options)) if set(setting.options) <= set(one.alone) else ""


def _beside(cell: Cell, found: Entry | None, clocked: Entry | None) -> Row:
    """A row with all that is the same for every error of a cell."""
    setting = cell.setting
    times = {name: _number(clocked, name) for name in ("p50", "p95", "p99", "slowest", "rests", "moving", "at_rest")}
    repeats, frames = (0 if clocked is None else int(clocked.get(name, 0)) for name in ("repeats", "frames"))
    return Row(
        cell.scenario, setting.engine, setting.name, "", "", math.nan, times["p50"], times["p99"], "", "", 0.0, "", setting.base,
        copyable(setting), repeats, frames, settable(setting), times["p95"], times["rests"], times["moving"], times["at_rest"],
        int(sleeps(setting, scene_of(cell))), _number(found, "step"),
        int(bool(scene_of(cell).avatars)), times["slowest"],
        math.nan if found is None else float(found["values"].get(GAP, math.nan)),
    )


def scene_of(cell: Cell) -> Scene:
    """The scene of a cell, at the length that is run."""
    return _scene(cell.scenario, cell.full)


@cache
def _scene(scenario: str, full: bool) -> Scene:
    return catalog.get(scenario).as_run(full).build()


def _state(state: str, metric: str, values: Mapping[str, float]) -> str:
    if state != "measured":
        return state
    if not float(values.get(NOT_FINITE, 0.0)) == 0.0:
        return "not-finite"
    if metric != WRONG_SIDE and not float(values.get(WRONG_SIDE, 0.0)) == 0.0:
        return "wrong-side"
    return "measured" if metric in values else "not-measured"


def _number(entry: Entry | None, name: str) -> float:
    value = None if entry is None else entry.get(name)
    return math.nan if value is None else float(value)


def floored(row: Row) -> float:
    """The error, or what counts as none where it is less; nan where the row was not measured."""
    if row.state != "measured" or math.isnan(row.error):
        return math.nan
    return max(row.error, row.reached)


def with_fronts(rows: Sequence[Row]) -> list[Row]:
    """The same rows, each marked if it is on the front of all engines or of its own."""
    marks = [""] * len(rows)
    groups: dict[tuple[str, ...], list[int]] = {}
    for k, row in enumerate(rows):
        groups.setdefault((row.scenario, row.metric), []).append(k)
        groups.setdefault((row.scenario, row.metric, row.engine), []).append(k)
    # own fronts first: the front of all overwrites them
    for group, places in sorted(groups.items(), key=lambda entry: -len(entry[0])):
        on = front([(rows[k].p50, floored(rows[k])) for k in places])
        for k in (k for k, yes in zip(places, on, strict=True) if yes):
            marks[k] = "own" if len(group) == 3 else "all"
    return [replace(row, front=mark) for row, mark in zip(rows, marks, strict=True)]


def table(rows: Sequence[Row]) -> str:
    """A block per scene and error: its front, then what crashed, diverged or went through a wall."""
    lines = []
    for scenario, metric in dict.fromkeys((row.scenario, row.metric) for row in rows):
        here = [row for row in rows if (row.scenario, row.metric) == (scenario, metric)]
        lines.append(f"{scenario}, {metric}{f' [{here[0].unit}]' if here[0].unit else ''}")
        for row in sorted((row for row in here if row.front == "all"), key=lambda row: row.p50):
            lines.append(f"  {row.engine:10} {row.setting:32} {row.error:10.3g} {1e-3 * row.p50:9.4f} ms")
        spoilt = [f"{row.engine}/{row.setting}: {row.state}" for row in here if row.state != "measured"]
        untimed = [f"{row.engine}/{row.setting}" for row in here if row.state == "measured" and math.isnan(row.p50)]
        lines += [f"  no point: {', '.join(spoilt)}"] if spoilt else []
        lines += [f"  not timed: {', '.join(untimed)}"] if untimed else []
    return "\n".join(lines)
