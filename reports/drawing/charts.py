"""The two kinds of static chart, each drawn as one small panel per scene. A panel is a static picture and a sentence.

Altair builds each kind once, as a frame without data; a panel is that frame with its own numbers (building and checking
a specification costs more than drawing it).
"""

import copy
import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reports.deciding.alike import asleep, sleepers
from reports.deciding.columns import worst
from reports.deciding.conclusions import (
    FRAME_60_HZ,
    FRAME_90_HZ,
    OVERLAP_BOUND,
    overlap_sentence,
    overlap_text,
    time_sentence,
)
from reports.drawing.marks import OVERLAP_FLOOR, OVERLAP_TOP, over_time, overlap_axis, spans, time_axis
from reports.drawing.palette import Stroke
from reports.drawing.picture import pictures
from reports.reading.load import Array, Results, Series
from reports.words.wording import MISSING, listed, quantity
from runfiles.like_for_like import with_avatar
from runfiles.timing_protocol import TAIL_FRAMES, may_rank

# Points per line at most: more do not fit the width of a panel. Each point is the largest of its group of frames,
# so that no spike is lost.
MOST_POINTS = 160
Percentiles = tuple[float, float, float]


@dataclass(frozen=True)
class Panel:
    """One scene of one chart: an SVG (text alternative inside) and the sentence that says what to conclude."""

    scene: str
    drawn: str | Future[str]
    conclusion: str

    @property
    def svg(self) -> str:
        """The picture, once it is drawn."""
        return self.drawn if isinstance(self.drawn, str) else self.drawn.result()


def peaks(values: Array, most: int = MOST_POINTS) -> tuple[Array, Array, Array]:
    """(frame, largest finite value, whether a value in the group is missing) for at most `most` groups, each (groups,)."""
    if not values.size:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    # the first groups are one longer where it does not come out even
    groups = min(most, values.size)
    length, longer = divmod(values.size, groups)
    sizes = np.full(groups, length)
    sizes[:longer] += 1
    return of_groups(values, np.cumsum(sizes) - sizes)


def of_groups(values: Array, starts: NDArray[np.int64]) -> tuple[Array, Array, Array]:
    """The same of the groups that begin at these places."""
    sound = np.isfinite(values)
    largest = np.maximum.reduceat(np.where(sound, values, -math.inf), starts)
    return starts.astype(np.float64), largest, np.add.reduceat(~sound, starts, dtype=np.float64).clip(max=1.0)


def _points(runs: Mapping[str, Array], floor: float, top: float) -> tuple[list[dict[str, object]], list[dict[str, object]]]:
    lines, gaps = [], []
    for run, values in runs.items():
        for frame, value, broken in zip(*peaks(values), strict=True):
            if math.isfinite(value):
                lines.append({"run": run, "frame": int(frame), "value": float(f"{min(max(value, floor), top):.4g}")})
            if broken:
                gaps.append({"run": run, "frame": int(frame), "value": top})
    return lines, gaps


def overlap_panels(results: Results, strokes: Mapping[str, Stroke], order: Sequence[str]) -> list[Panel]:
    """Residual overlap over time, one panel per scene that has a series."""
    scale, axis = overlap_axis()
    frame = over_time(strokes, scale, axis, {"": OVERLAP_BOUND})
    ceilings = {row.scenario: row.ceiling for row in results.rows if row.metric == "residual_overlap_max" and row.ceiling}
    orders: list[tuple[Mapping[str, object], str, str]] = []
    said: list[tuple[str, str]] = []
    for scene in order:
        runs = _back_to_front({k: s for k, s in results.series.get(scene, {}).items() if s.overlap.size})
        if runs:
            lines, gaps = _points({run: s.overlap for run, s in runs.items()}, OVERLAP_FLOOR, OVERLAP_TOP)
            gate = [{"value": ceilings[scene]}] if ceilings.get(scene, 0.0) > OVERLAP_BOUND else []
            spec = frame | {"datasets": _datasets(frame) | {"lines": lines, "gaps": gaps, "ceiling": gate}}
            text = f"{scene}. {overlap_text(results.series[scene])}"
            orders.append((spec, text, f"o{len(orders)}"))
            said.append((scene, overlap_sentence(results.series[scene])))
    return _drawn(orders, said)


def _drawn(orders: Sequence[tuple[Mapping[str, object], str, str]], said: Sequence[tuple[str, str]]) -> list[Panel]:
    """All panels of one kind, drawn side by side; `said` is (scene, conclusion) of each."""
    return [Panel(scene, drawn, text) for (scene, text), drawn in zip(said, pictures(orders), strict=True)]


def _datasets(frame: Mapping[str, object]) -> dict[str, object]:
    held = frame.get("datasets")
    return dict(held) if isinstance(held, dict) else {}


def _back_to_front(runs: Mapping[str, Series]) -> dict[str, Series]:
    """The raw tracker first, so that the engines are drawn over it."""
    return dict(sorted(runs.items(), key=lambda item: not item[0].startswith("tracker/")))


def time_percentiles(results: Results) -> dict[str, dict[str, Percentiles]]:
    """p50, p95, p99 [us] per scene and run: from the rows, and where a row is missing from the series; NaN if neither has it, or
    the row says why it has none."""
    found: dict[str, dict[str, Percentiles]] = {}
    for scene in results.scenes():
        rows = results.of(scene)
        for run in dict.fromkeys(row.run for row in rows):
            series = results.series.get(scene, {}).get(run)
            timed = series.frame_time[np.isfinite(series.frame_time)] if series else np.empty(0)
            own = [row for row in rows if row.run == run]
            three = []
            for percent in (50, 95, 99):
                row = worst([r for r in own if r.metric == f"frame_time_p{percent}"])
                if row is not None:
                    three.append(math.nan if row.value is None else row.value)
                else:
                    three.append(float(np.percentile(timed, percent)) if timed.size else math.nan)
            if any(math.isfinite(value) and value > 0.0 for value in three):
                found.setdefault(scene, {})[run] = (three[0], three[1], three[2])
    return found


def time_panels(results: Results, strokes: Mapping[str, Stroke], order: Sequence[str]) -> list[Panel]:
    """Percentiles of frame times per engine, one panel per scene in which frames were timed."""
    found, avatars, sleeping = time_percentiles(results), with_avatar(results.rows), sleepers(results)
    times = [value for runs in found.values() for three in runs.values() for value in three]
    times += [float(v) for runs in results.series.values() for s in runs.values() for v in s.frame_time]
    scale, axis, low, _ = time_axis(times)
    budgets = {"60 Hz": FRAME_60_HZ, "90 Hz": FRAME_90_HZ}
    spread = spans(strokes, scale, axis, budgets)
    orders: list[tuple[Mapping[str, object], str, str]] = []
    concluded: list[tuple[str, str]] = []
    for scene in order:
        runs = found.get(scene, {})
        if runs:
            rows = [_span(run, three, low) for run, three in runs.items()]
            spec = copy.deepcopy(spread) | {"datasets": _datasets(spread) | {"spans": rows}, "height": 20 * len(rows)}
            said = "; ".join(f"{run}: {', '.join(map(_text, three))}" for run, three in runs.items())
            text = f"{scene}. Frame time p50, p95, p99. {said}."
            short = any(not may_rank(row.metric, row.note) for row in results.of(scene) if row.metric == "frame_time_p95")
            said = time_sentence(runs, _aside(scene in avatars, sleeping.get(scene, {}), short)) + _raw(results, scene, runs)
            orders.append((spec, text, f"s{len(orders)}"))
            concluded.append((scene, said))
    return _drawn(orders, concluded)


def _aside(avatar: bool, sleeping: Mapping[str, float], short: bool) -> str:
    """Why the 95th percentiles of a scene stand side by side; "" where they are compared."""
    if avatar:
        return "ours is kinematic, theirs has dynamics"
    if asleep(sleeping, "p95"):
        return "in some what rests sleeps in that frame"
    return f"of one repeat or of fewer than {TAIL_FRAMES} frames: none is best" if short else ""


def _raw(results: Results, scene: str, runs: Mapping[str, Percentiles]) -> str:
    """A sentence with p99 over all frames of all repeats, where it was measured; "" otherwise."""
    rows = {run: worst([r for r in results.of(scene) if r.metric == "frame_time_raw_p99" and r.run == run])
            for run in runs}
    said = tuple(f"{run} {quantity(row.value, 'us')}" for run, row in rows.items() if row and row.value is not None)
    return f" With every disturbance of the host left in, p99 is: {listed(said)}." if said else ""


def _text(time: float) -> str:
    return MISSING if math.isnan(time) else quantity(time, "us")


def _span(run: str, three: Percentiles, low: float) -> dict[str, object]:
    names = ("p50", "p95", "p99")
    drawn = {n: max(v, low) if math.isfinite(v) else None for n, v in zip(names, three, strict=True)}
    return {"run": run, **drawn, "last": max((v for v in drawn.values() if v is not None), default=None)}
