"""Time series of a scene: overlap, distance from the user, energy, contacts, iterations and frame time of every engine."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from avatarsim.spatial import rotation
from reports.deciding.conclusions import peak
from reports.deciding.tables import RAW_TRACKER, engine_of
from reports.drawing.charts import of_groups, peaks
from reports.reading.kept import Array, Drawn, Shown
from reports.reading.load import Results, Series
from reports.replay import packed
from reports.words.wording import count, quantity
from runfiles.timing_protocol import RANKED_REPEATS, TAIL_FRAMES, least_of

OVERLAP_FLOOR = 1e-9
"""Overlap [m] that is drawn on the floor of its chart, zero included."""
LOGARITHMIC = ("overlap", "time")
CourseCharts = Mapping[str, Sequence[Mapping[str, object]]]
"""By scene the charts that `charts` makes."""


@dataclass(frozen=True)
class Measure:
    """One chart: what it shows in a sentence, and its unit."""

    key: str
    title: str
    unit: str
    shows: str


MEASURES = (
    Measure("overlap", "Overlap", "m", "Deepest penetration of the state shown, by the judge; below 1 nm it lies on the floor."),
    Measure("offset", "Distance from the user", "m", "Farthest link origin from where the raw tracker has it."),
    Measure("energy", "Energy", "J", "Kinetic and potential energy of all simulated bodies, counted from where they began."),
    Measure("contacts", "Contacts", "", "Contacts as each engine counts them itself; where it has no count of them, near pairs."),
    Measure("iterations", "Iterations", "", "Passes of each engine's own solver; what a pass is differs from engine to engine."),
    Measure("time", "Frame time", "us", "Time of a rendered frame in the timing pass, engine only, over the repeats that every "
            "engine of the scene had; the slowest frame of a table is over all repeats of its own engine."),
)


@dataclass(frozen=True, eq=False)
class Course:
    """One engine's line in one chart: values at frames 0, 1, 2, ... from `first` on."""

    run: str
    first: int
    values: Array


def energy(one: Shown, scene: Drawn) -> Array:
    """(F+1,) kinetic and potential energy [J] of the simulated bodies, less the potential energy of the first state."""
    total = np.zeros(len(one.times))
    for k, body in enumerate(scene.bodies):
        if not body["mass"]:
            continue
        mass, centre = float(body["mass"]["mass"]), np.array(body["mass"]["centre"], dtype=np.float64)
        inertia = np.array(body["mass"]["inertia"], dtype=np.float64)
        turns = one.orientations[:, k]
        spin = rotation.rotate(rotation.conjugate(turns), one.angular_velocities[:, k])
        middle = one.positions[:, k] + rotation.rotate(turns, centre)
        with np.errstate(all="ignore"):
            moving = 0.5 * mass * np.sum(one.velocities[:, k] ** 2, axis=1) + 0.5 * np.einsum("ti,ij,tj->t", spin, inertia, spin)
            total = total + moving - mass * (middle - middle[0]) @ scene.gravity
    return total


def courses(series: Mapping[str, Series], shown: Sequence[Shown], scene: Drawn | None) -> dict[str, list[Course]]:
    """By measure the lines of all engines that have one; measures without a line are left out."""
    found: dict[str, list[Course]] = {measure.key: [] for measure in MEASURES}
    for run, own in series.items():
        if own.overlap.size:
            found["overlap"].append(Course(run, 0, own.overlap))
        timed = np.flatnonzero(np.isfinite(own.frame_time))
        if timed.size:
            # frames before the first that was timed are no gap in what was measured
            found["time"].append(Course(run, 1 + int(timed[0]), own.frame_time[timed[0] :]))
    engines = [one for one in shown if not one.run.startswith("tracker/")]
    for one in engines:
        if one.raw_positions.shape[1]:
            apart = np.linalg.norm(one.positions[:, -one.raw_positions.shape[1] :] - one.raw_positions, axis=2)
            found["offset"].append(Course(one.run, 0, apart.max(axis=1)))
        if scene is not None and any(body["mass"] for body in scene.bodies):
            found["energy"].append(Course(one.run, 0, energy(one, scene)))
        for key, names in (("contacts", ("contacts", "pairs")), ("iterations", ("iterations",))):
            counted = next((one.counts[name] for name in names if name in one.counts), None)
            if counted is not None:
                found[key].append(Course(one.run, 0, np.asarray(counted, dtype=np.float64)))
    return {key: lines for key, lines in found.items() if lines}


def told(value: float, unit: str) -> str:
    """A figure of a chart; what is counted is a whole number."""
    return quantity(value, unit) if unit else f"{value:,.0f}"


def sentence(key: str, lines: Sequence[Course], repeats: int = 0, frames: int = 0) -> str:
    """Median and largest of each line, in words: the text in place of the picture. `repeats`: of the frames of times; `frames`:
    of the scene; 0 where that is not known."""
    unit = next(measure.unit for measure in MEASURES if measure.key == key)
    said = []
    for line in lines:
        finite = line.values[np.isfinite(line.values)]
        lost = line.values.size - finite.size
        broken = f", {count(lost, 'value')} missing or not finite" if lost else ""
        if not finite.size:
            said.append(f"{line.run}: no finite value")
        else:
            said.append(f"{line.run}: median {told(float(np.median(finite)), unit)}, "
                        f"largest {told(float(finite.max()), unit)}{broken}")
    return f"{_window(key, lines, frames)}{'; '.join(said)}{_taken(key, repeats)}."


def _window(key: str, lines: Sequence[Course], frames: int) -> str:
    """Which frames the times of a chart are of, in front of what is said of them, where they are not all `frames` of the scene;
    "" for all else, and where the number of frames is not known."""
    timed = [line for line in lines if line.values.size]
    if key != "time" or not frames or all(line.values.size >= frames for line in timed):
        return ""
    # a frame leads to the state of the next number, by which lines are drawn
    first, last = min(line.first for line in timed) - 1, max(line.first + line.values.size for line in timed) - 1
    return f"{last - first} of {count(frames, 'frame')} alone, from frame {first} on: "


def _taken(key: str, repeats: int) -> str:
    """How the times of a chart were taken, behind what is said of them; "" for all else."""
    how = least_of(repeats) if key == "time" else ""
    return f" ({how})" if how else ""


def conclusion(key: str, lines: Sequence[Course], repeats: int = 0, frames: int = 0) -> str:
    """What to conclude from one chart; `repeats` and `frames` as in `sentence`. Of a window of frames no peak is the lowest, as
    a slower frame may lie outside it, nor of so few repeats or frames that their slow end ranks nothing."""
    unit = next(measure.unit for measure in MEASURES if measure.key == key)
    top = {line.run: float(np.nanmax(line.values)) for line in lines if np.isfinite(line.values).any()}
    if not top:
        return "No engine has a finite number here."
    least, most = min(top, key=lambda run: top[run]), max(top, key=lambda run: top[run])
    if top[least] == top[most]:
        return f"All reach the same largest value, {told(top[most], unit)}." if len(top) > 1 else (
            f"Only {least} has this figure; its largest value is {told(top[most], unit)}.")
    if key == "energy":
        start = {line.run: float(line.values[0]) for line in lines if np.isfinite(line.values[0])}
        gains = [run for run in start if run in top and top[run] > start[run] + max(1e-6, 0.01 * abs(start[run]))]
        return (f"Above the energy they began with, by a hundredth or more: {', '.join(gains)}; a driven hand may add it."
                if gains else "No engine rises above the energy it began with by more than a hundredth.")
    taken, window = _taken(key, repeats), _window(key, lines, frames)
    if window:
        return (f"{window}slowest {most}, {told(top[most], unit)}{taken}. No lowest peak follows: slower frames may lie outside; "
                "the slowest of all that were timed stand in the table.")
    if key == "time" and (0 < repeats < RANKED_REPEATS or 0 < frames < TAIL_FRAMES):
        return f"Slowest: {most}, {told(top[most], unit)}{taken}; too few repeats or frames to say which peak is the lowest."
    return f"Lowest peak: {least}, {told(top[least], unit)}; highest: {most}, {told(top[most], unit)}{taken}."


def over_all(results: Results, ours: str) -> str:
    """In how many scenes no other engine's overlap peaks lower than ours, and how large ours is in the others. The raw tracker
    and other presets of our engine are no other engine; a scene that ours refuses is not counted."""
    lower, scenes = dict[str, float](), 0
    for scene, runs in results.series.items():
        peaks_of = {run: peak(one.overlap) for run, one in runs.items() if one.overlap.size}
        rivals = [value for run, value in peaks_of.items() if engine_of(run) not in (RAW_TRACKER, engine_of(ours))]
        if ours in peaks_of and rivals:
            scenes += 1
            if math.isnan(peaks_of[ours]) or any(value < peaks_of[ours] for value in rivals):
                lower[scene] = peaks_of[ours]
    if not scenes:
        return f"No scene has the overlap of {ours} beside that of another engine."
    said = f"In {scenes - len(lower)} of {count(scenes, 'scene')} no other engine's overlap peaks lower than that of {ours}"
    if not lower:
        return f"{said}."
    most = max(lower, key=lambda scene: math.inf if math.isnan(lower[scene]) else lower[scene])
    return f"{said}; where one does ({len(lower)}), ours reaches at most {quantity(lower[most], 'm')} ({most})."


def charts(
    lines_of: Mapping[str, Sequence[Course]], dt: float, most: int, stride: int = 0, repeats: int = 0,
) -> list[dict[str, object]]:
    """The charts of a scene for the page's script: at most `most` points a line, each the largest of its group of frames. Beside
    a replay that draws one of every `stride` states no group reaches across two of these: so both always say the same.
    `repeats`: how often the frames of the times were run, 0 where that is not known."""
    made, whole = [], max((line.values.size - 1 for line in lines_of.get("overlap", ())), default=0)
    for measure in MEASURES:
        lines = lines_of.get(measure.key, ())
        if not lines:
            continue
        log = measure.key in LOGARITHMIC
        points = [(line, *_points(line, most, stride)) for line in lines]
        if measure.key == "overlap":
            points = [(line, frames, _three_digits(values)) for line, frames, values in points]
        finite = np.concatenate([values[np.isfinite(values)] for _, _, values in points])
        low, high = _range(finite, measure.key)
        made.append({
            "key": measure.key, "title": measure.title, "unit": measure.unit, "log": log, "low": low, "high": high,
            "shows": measure.shows, "concludes": conclusion(measure.key, lines, repeats, whole),
            "text": sentence(measure.key, lines, repeats, whole),
            "lines": [_line(line, dt * (line.first + frames), _scaled(values, log, low)) for line, frames, values in points],
        })
    return made


def _line(line: Course, times: Array, values: Array) -> dict[str, object]:
    """One line for the page's script: times [s] and values, or their decimal logarithms, on a scale of its own from `low` to
    `high`: on one for all, an engine that explodes would leave the others no digits."""
    finite = values[np.isfinite(values)]
    ends = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    return {"run": line.run, "times": packed.reals(times), "low": ends[0], "high": ends[1],
            "values": packed.text(packed.codes(values, ends))}


def _points(line: Course, most: int, stride: int) -> tuple[Array, Array]:
    """(frame, largest value) of each group of frames; nan, which is drawn as a gap, where one of the group is no number."""
    if stride and line.values.size:
        # the finest groups of which whole ones make up a drawn state
        size = next((size for size in range(1, stride) if stride % size == 0 and line.values.size <= most * size), stride)
        at = line.first + np.arange(line.values.size)
        frames, largest, broken = of_groups(line.values, np.flatnonzero((at % size == 0) | (at == line.first)))
    else:
        frames, largest, broken = peaks(line.values, most)
    return frames, np.where(broken > 0.0, np.nan, largest)


def _three_digits(values: Array) -> Array:
    """Rounded as words have them: what packing adds then does not change a digit."""
    return np.array([float(f"{value:.3g}") for value in values], dtype=np.float64)


def _scaled(values: Array, log: bool, low: float) -> Array:
    return np.log10(np.maximum(values, low)) if log else values


def _range(finite: Array, key: str) -> tuple[float, float]:
    """The ends of a chart's axis."""
    if key == "overlap":
        return OVERLAP_FLOOR, 1.0
    if not finite.size:
        return 0.0, 1.0
    if key == "time":
        low = 10.0 ** math.floor(math.log10(max(float(finite.min()), 1e-3)))
        return low, 10.0 ** math.ceil(math.log10(max(float(finite.max()), 10.0 * low)))
    # one engine that explodes must not flatten the lines of all others
    low, high = float(min(finite.min(), 0.0)), float(max(np.percentile(finite, 99.5), 1e-9))
    return max(low, -3.0 * high), 1.05 * high
