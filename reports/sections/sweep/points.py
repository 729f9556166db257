"""Accuracy against time, from what `scenarios sweep` left in the run: points, fronts, and whether the promised ratios hold."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from reports.deciding.alike import Basis, basis_of, factor, is_more, time_by
from reports.words.metric_words import words
from reports.words.wording import count, figures, limit, listed, quantity
from runfiles.csv_rows import WHOLE, lines, number
from runfiles.native_files import FOLDER
from runfiles.timing_protocol import REPEATS, TAIL_FRAMES

FILES = ROWS, ABOUT = "sweep.csv", "sweep.json"
OURS = ("avatarsim", "default")
OVERLAP = "residual_overlap_max"
SEEN_GAP = 1e-6
"""Gap [m] in contact below which an avatar is said to touch: what counts as no overlap."""
SLEEPS = 0.5
"""Share of frames at rest from which on a median is the time of a frame at rest."""
ALONE = "Taken for one kind of error alone, where the cases above and the table below count all errors of a scene at once, "
"""How what is said of single errors begins."""
WHICH: Mapping[Basis, str] = {
    Basis.MEDIAN: "the median of all frames", Basis.MOVING: "the median of frames in motion",
    Basis.TAIL: "the 95th percentile, of fewer than 200 frames the slowest", Basis.SLOWEST: "the slowest frame",
}
"""The time of a frame that a scene compares by, in a caption."""
ROW, STEP = "{preset = ", ", dt = "
"""Signs of a row for `--settings` in the options to copy, and of a row that changes the step."""
SEED_AND_FORM = re.compile(r"\d+\.\w+\.gz")
"""How the name of what an engine loaded goes on after scene, engine and setting."""
FOLLOW = {"mujoco": "contact parameters follow the step"}
"""Engine -> what else a change of its step changes."""
SLEEPS_THROUGH = 0.95
"""The same share for a 95th percentile."""
RATIOS = ((1e-5, 10.0), (1e-3, 3.0))
"""At least so many times faster (second) than any setting of another engine that leaves at most so much overlap (first) [m]."""


@dataclass(frozen=True)
class Point:
    """One setting in one scene: `error` in `unit`, frame time [us] median and 99th percentile; nan with the reason in `note`.
    `reached`: the error that counts as none. `front`: see `marked`. `base` is the preset beneath the setting, `options` its
    text to copy, `settable` the engine's own words for it where nothing else follows from it, `repeats` and `frames` what its
    times stand on, 0 where the file does not say. `p95` [us]; `rests`: share of frames in which nothing moves, `moving` and
    `at_rest` the median of either kind [us]; `sleeps`: whether what rests falls asleep; `step`: the engine's own time step [s];
    `avatar`: whether the scene has one, which is kinematic in ours and dynamic in the others; `slowest` frame [us]; `gap`: median
    [m] from an avatar to what it touches."""

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
    sleeps: bool = False
    step: float = math.nan
    avatar: bool = False
    slowest: float = math.nan
    gap: float = math.nan

    @property
    def family(self) -> str:
        """Engine and preset beneath."""
        return f"{self.engine}/{self.base or self.setting.partition(' ')[0]}"

    @property
    def is_preset(self) -> bool:
        """Whether the setting is one of the engine's own presets."""
        return self.setting == (self.base or self.setting.partition(" ")[0])

    @property
    def aside(self) -> bool:
        """Whether it is of another preset of ours than the one that is compared: drawn as a curve of its own, on no front, in no
        statement and in no table of the cheapest."""
        return self.engine == OURS[0] and self.family != "/".join(OURS)

    @property
    def by_row(self) -> str:
        """Why a setting is run with its row instead of being set in the model of the preset; "" where it can be."""
        if self.is_preset or self.settable or self.engine == OURS[0] or ROW not in self.options:
            return ""
        why = FOLLOW.get(self.engine, "how many steps a frame has, and what an avatar is told in them, follow the step")
        return f"{why if STEP in self.options else 'more follows from it than one line says'}: run it with this row"

    @property
    def hovers(self) -> str:
        """"hovers 4.00 mm", the gap of an avatar in contact that no error counts; "" where there is none that is seen."""
        return f"hovers {quantity(self.gap, 'm')}" if self.gap > SEEN_GAP else ""

    @property
    def tail(self) -> float:
        """What the dear frames take [us]: the 95th percentile, of few frames the slowest."""
        return self.slowest if self._few and self.slowest == self.slowest else self.p95

    @property
    def tail_said(self) -> str:
        """What `tail` is, in words."""
        if self._few and self.slowest == self.slowest:
            return f"slowest of {self.frames} frames"
        return f"95th percentile of {self.frames} frames" if self._few else "95th percentile"

    @property
    def has_tail(self) -> bool:
        """Whether `tail` is that of the engine: what ran once holds what the machine did beside it."""
        return self.tail == self.tail and (not self.repeats or self.repeats >= REPEATS)

    @property
    def _few(self) -> bool:
        """Whether too few frames were timed for a percentile of the dear ones."""
        return 0 < self.frames < TAIL_FRAMES

    @property
    def is_asleep(self) -> bool:
        """Whether its median is the time of a frame in which what rests sleeps."""
        return self.sleeps and self.rests >= SLEEPS

    @property
    def sleeps_through(self) -> bool:
        """Whether what rests sleeps in all but so few frames that a 95th percentile is the time of a frame at rest too."""
        return self.sleeps and self.rests >= SLEEPS_THROUGH

    @property
    def run(self) -> str:
        """Engine and setting as tables name them."""
        return f"{self.engine}/{self.setting}"

    @property
    def floored(self) -> float:
        """The error, or what counts as none where it is less; nan where the point is none."""
        return max(self.error, self.reached) if self.state == "measured" and not math.isnan(self.error) else math.nan


@dataclass(frozen=True)
class Rivalry:
    """What the others reach in one scene and error. `better`: settings as fast and as accurate as ours. `ratios`: for each of
    RATIOS the fastest setting that is accurate enough, and how many times our time it takes; None where there is none."""

    scenario: str
    metric: str
    unit: str
    points: tuple[Point, ...]

    @cached_property
    def basis(self) -> Basis:
        """The time of a frame by which the scene compares: diagrams, fronts and sentences alike."""
        return basis_of(self.points)

    @property
    def which(self) -> str:
        """That time in words."""
        return WHICH[self.basis]

    def time(self, point: Point) -> float:
        """That time [us] of one of the points; nan where it has none."""
        return time_by(point, self.basis)

    @cached_property
    def ours(self) -> Point | None:
        """Our own default, if it was measured and timed."""
        return next((p for p in self.points if (p.engine, p.setting) == OURS and p.p50 > 0.0 and p.floored == p.floored), None)

    @cached_property
    def better(self) -> tuple[Point, ...]:
        """Settings of others that are as accurate and at least as fast, fastest first."""
        ours, basis = self.ours, self.basis
        if ours is None:
            return ()
        found = [p for p in self.points if p.engine != OURS[0] and time_by(p, basis) > 0.0 and p.floored <= ours.floored
                 and not is_more(time_by(p, basis), time_by(ours, basis))]
        return tuple(sorted(found, key=lambda p: time_by(p, basis)))

    @cached_property
    def avatar(self) -> bool:
        """Whether the scene has an avatar: times then stand side by side, and no ratio is promised."""
        return any(p.avatar for p in self.points)

    @cached_property
    def ratios(self) -> tuple[tuple[Point, float] | None, ...]:
        """One entry per row of RATIOS; of overlap only, and in no scene with an avatar."""
        ours, found = self.ours, list[tuple[Point, float] | None]()
        if ours is None or self.metric != OVERLAP or self.avatar:
            return ()
        basis = self.basis
        for most, _ in RATIOS:
            near = [p for p in self.points if p.engine != OURS[0] and p.floored <= most and time_by(p, basis) > 0.0]
            best = min(near, key=lambda p: time_by(p, basis), default=None)
            found.append(None if best is None else (best, factor(best, ours, basis)))
        return tuple(found)

    @property
    def no_factor(self) -> str:
        """Why an entry of `ratios` is not a number."""
        asleep = self.basis in (Basis.TAIL, Basis.SLOWEST)
        return "no factor, since what rests sleeps in the median frame" if asleep else "no factor, since a time is missing"

    @property
    def lost(self) -> bool:
        """Whether anything that is promised fails here; a promise without our own figure has failed."""
        short = any(entry and entry[1] < least for entry, (_, least) in zip(self.ratios, RATIOS, strict=False))
        return self.ours is None or bool(self.better) or short

    @property
    def said(self) -> str:
        """The outcome in words, what fails first."""
        if self.ours is None:
            return "ours was not measured"
        parts = [f"as fast and as accurate: {listed(tuple(p.run for p in self.better), 3)}"] if self.better else []
        for entry, (most, least) in zip(self.ratios, RATIOS, strict=False):
            if entry is not None and entry[1] < least:
                time = f"takes ×{figures(entry[1])}, not ×{least:g}"
                parts.append(f"{entry[0].run} leaves at most {limit(most, 'm')} and {time}")
        return "; ".join(parts) or ("an avatar: times side by side" if self.avatar else "holds")

    @cached_property
    def front(self) -> tuple[Point, ...]:
        """The Pareto front of all engines, fastest first."""
        return tuple(sorted((p for p in self.points if p.front == "all"), key=self.time))

    @cached_property
    def spoilt(self) -> tuple[Point, ...]:
        """Points that have no accuracy: crashed, diverged, through a wall."""
        return tuple(p for p in self.points if p.state not in ("measured", "cannot-say"))

    @cached_property
    def silent(self) -> Mapping[str, str]:
        """Why an engine has no words for this error, by engine; presets that lack them while another has them are not named."""
        said = {p.engine: p.note for p in self.points if p.state == "cannot-say"}
        able = {p.engine for p in self.points if p.state != "cannot-say"}
        return {engine: note for engine, note in said.items() if engine not in able}


@dataclass(frozen=True)
class Sweep:
    """All points of a run, and how the sweep that found them says that it went."""

    points: tuple[Point, ...]
    about: Mapping[str, object] = field(default_factory=dict)
    models: tuple[str, ...] = ()
    """Names of the files in which engines left what they loaded, in their own words."""

    def model(self, point: Point) -> tuple[str, str]:
        """Path, beside the page, of what the engine loaded in the scene with a setting, and what that is: its own, or that of the
        preset beneath if the setting can be set in it; ("", "") without."""
        own = self._loaded(point.scenario, point.run)
        if own:
            return own, "model as compiled"
        beneath = self._loaded(point.scenario, point.family) if point.settable else ""
        return beneath, f"model as compiled of {point.base}, to set that in" if beneath else ""

    def _loaded(self, scene: str, run: str) -> str:
        stem = f"{scene}.{run.replace('/', '.', 1).replace('/', '_').replace(' ', '.')}."
        name = next((name for name in self.models if name.startswith(stem) and SEED_AND_FORM.fullmatch(name[len(stem) :])), "")
        return f"{FOLDER}/{name}" if name else ""

    @cached_property
    def rivalries(self) -> tuple[Rivalry, ...]:
        """Scene by scene and error by error, those that lose first."""
        groups: dict[tuple[str, str], list[Point]] = {}
        for point in self.points:
            groups.setdefault((point.scenario, point.metric), []).append(point)
        found = [Rivalry(scene, metric, points[0].unit, tuple(points)) for (scene, metric), points in groups.items()]
        return tuple(sorted(found, key=lambda r: not r.lost))

    @property
    def engines(self) -> tuple[str, ...]:
        """In the order of the file."""
        return tuple(dict.fromkeys(p.engine for p in self.points))


def load(run_dir: Path) -> Sweep | None:
    """The file of a run; None when there is none. Raises InvalidFile for a file that is damaged."""
    found = lines(run_dir / ROWS, _point)
    models = sorted(path.name for path in (run_dir / FOLDER).glob("*.gz"))
    return Sweep(marked(found), _about(run_dir / ABOUT), tuple(models)) if found else None


def marked(points: Sequence[Point]) -> tuple[Point, ...]:
    """The same points, each marked by its place among those of its scene and error: "all" on the front of all engines, "own" on
    that of its own engine only, else "", and so is what stands aside. Times are those by which the scene compares; the file's own
    marks are of medians."""
    groups: dict[tuple[str, str], list[Point]] = {}
    for point in points:
        groups.setdefault((point.scenario, point.metric), []).append(point)
    bases = {place: basis_of(group) for place, group in groups.items()}
    groups = {place: [point for point in group if not point.aside] for place, group in groups.items()}

    def mark(point: Point) -> str:
        if point.aside:
            return ""
        place = point.scenario, point.metric
        here, basis = groups[place], bases[place]
        if not _on_front(point, [p for p in here if p.engine == point.engine], basis):
            return ""
        return "all" if _on_front(point, here, basis) else "own"

    return tuple(replace(point, front=mark(point)) for point in points)


def _on_front(point: Point, others: Iterable[Point], basis: Basis) -> bool:
    """Whether a point has both time and error, and no other is as good in both and better in one."""
    time, error = time_by(point, basis), point.floored
    beats = any(time_by(p, basis) <= time and p.floored <= error and (time_by(p, basis) < time or p.floored < error)
                for p in others)
    return time > 0.0 and error == error and not beats


def _about(path: Path) -> Mapping[str, object]:
    if not path.exists():
        return {}
    found = read_json(path, str(path), WHOLE)
    if not isinstance(found, dict):
        raise InvalidFile(str(path), type(found).__name__, "an object")
    return found


def _point(row: Mapping[str, str]) -> Point:
    told = {name: number(row.get(name) or "") for name in ("p95", "rests", "moving", "at_rest", "step", "slowest", "gap")}
    return Point(
        row["scenario"], row["engine"], row["setting"], row["metric"], row["unit"], number(row["error"]), number(row["p50"]),
        number(row["p99"]), row["state"], row["front"], float(row["reached"]), row["note"],
        row.get("base") or "", row.get("options") or "", int(row.get("repeats") or 0), int(row.get("frames") or 0),
        row.get("settable") or "", sleeps=bool(int(row.get("sleeps") or 0)), avatar=bool(int(row.get("avatar") or 0)), **told,
    )


def alone_heading(sweep: Sweep) -> str:
    """In how many rows of one scene and one kind of error a setting of another engine is both as fast and as accurate as ours."""
    known = [r for r in sweep.rivalries if r.ours is not None and not r.avatar]
    beaten = sum(bool(r.better) for r in known)
    return f"One kind of error at a time: another engine is as fast and as accurate in {beaten} of {len(known)}"


def conclusion(sweep: Sweep) -> str:
    """Whether the ratios of speed hold, error by error, what fails first, and that this is not all errors of a scene at once as
    in the table. Of scenes with an avatar nothing is said but what they are."""
    known = [r for r in sweep.rivalries if r.ours is not None and not r.avatar]
    if not known:
        return "Ours was not measured in a scene without an avatar: nothing can be said of ratios."
    beaten = [r for r in known if r.better]
    parts = []
    others = f"{_settings(p for r in known for p in r.points if p.engine != OURS[0])} of other engines"
    if beaten:
        names = tuple(f"{r.scenario} ({words(r.metric)} alone: {r.better[0].run}{_by_tail(r)})" for r in beaten)
        parts.append(f"{ALONE}without an avatar another engine is both as fast and as accurate as ours in {listed(names)}.")
    else:
        parts.append(f"{ALONE}without an avatar none of {others} is both as fast and as accurate as ours, in {_scenes(known)}.")
    overlaps = [r for r in known if r.ratios]
    for k, (most, least) in enumerate(RATIOS):
        parts.append(_promise(overlaps, k, most, least))
    parts += [f"In these ratios ours is {'/'.join(OURS)}."] if overlaps else []
    missing = [r.scenario for r in sweep.rivalries if r.ours is None]
    parts += [f"Ours was not measured in {listed(tuple(dict.fromkeys(missing)))}."] if missing else []
    return " ".join(filter(None, parts))


def _by_tail(rivalry: Rivalry) -> str:
    """What is compared where it is not a median."""
    basis = rivalry.basis
    return ", in frames that move" if basis is Basis.TAIL else ", in the slowest frame" if basis is Basis.SLOWEST else ""


def _promise(overlaps: Sequence[Rivalry], k: int, most: float, least: float) -> str:
    """Whether the ratio with index `k` of RATIOS holds; "" without a scene of which it is promised."""
    reached = [(r, entry) for r in overlaps if (entry := r.ratios[k]) is not None]
    entries = [(r, entry) for r, entry in reached if entry[1] == entry[1]]
    short = [(r, entry) for r, entry in entries if entry[1] < least]
    promised = f"at least {least:g} times faster than any measured that leaves at most {limit(most, 'm')}"
    if short:
        names = tuple(f"{r.scenario} ({words(r.metric)} alone: ×{figures(ratio)}, {point.run})" for r, (point, ratio) in short)
        return f"Ours is not {promised} in {listed(names)}."
    if entries:
        low = min(entries, key=lambda e: e[1][1])
        return (f"Ours is {promised}: ×{figures(low[1][1])} where it is closest ({low[0].scenario}, "
                f"{words(low[0].metric)} alone, {low[1][0].run}).")
    if not overlaps:
        return ""
    if reached:
        return f"An overlap of at most {limit(most, 'm')} is reached only where something sleeps in the median frame: no factor."
    return (f"An overlap of at most {limit(most, 'm')} is reached by none of "
            f"{_settings(p for r in overlaps for p in r.points if p.engine != OURS[0])} of other engines.")


def _settings(points: Iterable[Point]) -> str:
    """How many settings in scenes were measured, and how many were planned where that is more."""
    states: dict[tuple[str, str], bool] = {}
    for point in points:
        if point.state != "cannot-say":
            place = point.scenario, point.run
            states[place] = states.get(place, False) or point.state != "not-measured"
    measured = sum(states.values())
    return measured_of(measured, len(states), "cell")


def measured_of(measured: int, planned: int, noun: str) -> str:
    """"7 settings measured here (of 15 planned)"."""
    return f"{count(measured, noun)} measured here" + (f" (of {planned} planned)" if planned > measured else "")


def _scenes(rivalries: list[Rivalry]) -> str:
    scenes = dict.fromkeys(r.scenario for r in rivalries)
    return f"{count(len(scenes), 'scene')} and {count(len(rivalries), 'kind')} of error"
