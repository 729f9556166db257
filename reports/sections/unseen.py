"""Motions that nothing was tuned for: each room in each engine, what ours loses there first, and where the motions come from."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from reports.deciding.columns import worst
from reports.deciding.tables import RAW_TRACKER, engine_of
from reports.reading.load import Results, Row
from reports.words.metric_words import words
from reports.words.wording import MISSING, count, factor, listed, quantity
from runfiles.explained import briefly
from runfiles.naming import CROWD_PREFIX, UNSEEN_PREFIX

ORIGIN = "unseen"
"""Key in the provenance: what the seed was drawn from."""


@dataclass(frozen=True)
class Measure:
    """One column: metric, heading, unit; the difference up to which two figures are level, infinite where nothing is compared
    because not every engine can state it; whether an engine that left the allowed side of a room is out of the comparison."""

    metric: str
    title: str
    unit: str
    same: float
    stays_inside: bool = True


OVERLAP, CHATTER, REVERSAL, SLOWEST = "residual_overlap_max", "chatter_frames", "reversal_p95", "frame_time_max"
JITTER = "jitter_rms"
ROUGH, LIMITS, FARTHEST = "jerk_ratio", "joint_limit_excess_max", "tracker_offset_max"
LINK_JUMP, ROOT_JUMP, TO_AND_FRO = "link_jump_max", "root_jump_max", "reversal_max"
MEASURES = (
    Measure(OVERLAP, "deepest overlap shown", "m", 1e-6),
    Measure(CHATTER, "frames in contact that shake", "%", 0.05),
    Measure(JITTER, "jitter in contact", "m", 1e-5),
    Measure(REVERSAL, "displacement taken back, p95", "m", 1e-4),
    Measure(TO_AND_FRO, "largest to and fro", "m", 1e-3),
    Measure(LINK_JUMP, "jump of a link", "m", 1e-3),
    Measure(ROOT_JUMP, "jump of the root", "m", 1e-3),
    Measure(ROUGH, "roughness, over the user's", "", 0.05),
    Measure("tracker_offset_rms", "offset from the user, rms", "m", 1e-3),
    Measure(FARTHEST, "farthest from the user", "m", 1e-3),
    Measure("silent_offset_frames", "far from a free user, no status", "frames", 0.5),
    Measure(LIMITS, words(LIMITS), "deg", math.inf),
    Measure("frame_time_p50", "frame time p50", "us", 0.0, stays_inside=False),
    Measure(SLOWEST, "slowest frame", "us", 0.0, stays_inside=False),
)
ROUGHNESS = next(one for one in MEASURES if one.metric == ROUGH)
SHAKES, SHIVERS = MEASURES[1:3]
"""Of the second sentences count rooms and name no figure: where few frames are in contact one event decides it."""
WORST = {LINK_JUMP: "a link jumps in one frame by up to {} more than its user's", ROOT_JUMP: "the root jumps by up to {}",
         TO_AND_FRO: "the largest displacement to and fro is {}", FARTHEST: "the farthest from the user {}",
         CHATTER: "up to {} of the frames in contact shake"}
"""Metrics whose largest figure stands at the top of the page unless it is 0, and how it is said there."""
BEST = ("/tuned", "/hinges")
"""How runs of other engines with tuned settings, and with hinges for ball joints, end: they stand beside ours, all else in a
fold."""
SAID = {"waiting": "waiting", "planning": "seeking a path", "following": "along a path",
        "status_frames": "reported as not ended well"}
"""Counts by which ours says that it is not where its target is, and what they are called."""
PROMISED = ("residual_overlap_max", "wrong_side_frames", "not_finite_frames", "joint_limit_excess_max", "reach_cone_excess_max")
"""Metrics that have a bound in these rooms."""


@dataclass(frozen=True)
class Line:
    """One engine in one room: its figures in the order of MEASURES, None where there is none, how many frames were timed, from
    which on, whether it left the allowed side, and why there is no figure at all ("" where there is one)."""

    room: str
    run: str
    figures: tuple[float | None, ...]
    timed: int
    first: int
    outside: bool
    nothing: str

    def of(self, metric: str) -> float | None:
        """The figure of a metric."""
        return next(figure for measure, figure in zip(MEASURES, self.figures, strict=True) if measure.metric == metric)

    @property
    def texts(self) -> tuple[str, ...]:
        """The figures with their units."""
        return tuple(quantity(figure, measure.unit) for measure, figure in zip(MEASURES, self.figures, strict=True))


@dataclass(frozen=True)
class Unseen:
    """All lines, ours first in each room; the promises that ours broke; the seeds; what they were drawn from, "" if not said; by
    room what ours said of itself, in counts above 0; the rooms that are variants of another, such as at another frame rate."""

    ours: str
    lines: tuple[Line, ...]
    broken: tuple[str, ...]
    seeds: tuple[int, ...]
    origin: str
    told: tuple[tuple[str, tuple[tuple[str, float], ...]], ...] = ()
    variants: frozenset[str] = frozenset()

    @property
    def rooms(self) -> tuple[str, ...]:
        """Names of the rooms without their prefix."""
        return tuple(dict.fromkeys(line.room for line in self.lines))

    @property
    def asked(self) -> tuple[str, ...]:
        """The rooms that are no variant of another: those that sentences count."""
        return tuple(room for room in self.rooms if room not in self.variants)

    def line(self, room: str, run: str) -> Line | None:
        """The line of one engine in one room."""
        return next((line for line in self.lines if (line.room, line.run) == (room, run)), None)

    def best(self, room: str, measure: Measure) -> tuple[float, str] | None:
        """The least finite figure of another engine in a room, and which it is."""
        found = [(figure, line.run) for line in self.lines if line.room == room and engine_of(line.run) != engine_of(self.ours)
                 and not (measure.stays_inside and line.outside)
                 and (figure := line.of(measure.metric)) is not None and math.isfinite(figure)]
        return min(found, default=None)


def changes_with_commits(scene: str) -> bool:
    """Whether a scene or its motion is another at every commit, so that figures of two commits do not compare."""
    return scene.startswith((UNSEEN_PREFIX, CROWD_PREFIX))


def is_room(scene: str) -> bool:
    """Whether a scene is a room with motions that nothing was tuned for."""
    return scene.startswith(UNSEEN_PREFIX)


def unseen(results: Results, ours: str) -> Unseen | None:
    """The lines of a run; None where it has none of these rooms."""
    rows = [row for row in results.rows if is_room(row.scenario) and row.engine != RAW_TRACKER]
    if not rows:
        return None
    grouped: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        grouped.setdefault((row.scenario, row.run), []).append(row)
    order = list(dict.fromkeys(scene for scene, _ in grouped))
    # stable: behind ours the engines stay in the order of the run
    keys = sorted(grouped, key=lambda key: (order.index(key[0]), key[1] != ours))
    return Unseen(
        ours, tuple(_line(results, scene, run, grouped[scene, run]) for scene, run in keys),
        tuple(_broken(row) for row in rows if row.run == ours and row.metric in PROMISED and _breaks(row)),
        tuple(dict.fromkeys(row.seed for row in rows)), str(results.provenance.get(ORIGIN, "")),
        tuple((scene.removeprefix(UNSEEN_PREFIX), _told(grouped[scene, ours])) for scene in order if (scene, ours) in grouped),
        frozenset(scene.removeprefix(UNSEEN_PREFIX) for scene in order if results.family(scene) != scene),
    )


def _told(rows: Sequence[Row]) -> tuple[tuple[str, float], ...]:
    found = {row.metric: row.value for row in rows if row.metric in SAID and row.value}
    return tuple((SAID[metric], value) for metric, value in found.items() if value is not None)


def _line(results: Results, scene: str, run: str, rows: Sequence[Row]) -> Line:
    figures = []
    for measure in MEASURES:
        row = worst([row for row in rows if row.metric == measure.metric])
        figures.append(row.value if row else None)
    series = results.series.get(scene, {}).get(run)
    whole = next((row for row in rows if row.metric == "run"), None)
    nothing = f"{whole.status}: {whole.note}".removesuffix(": ") if whole else ""
    outside = any(row.metric == "wrong_side_frames" and row.value is not None and not row.value <= 0.0 for row in rows)
    timed = np.flatnonzero(np.isfinite(series.frame_time)) if series else np.zeros(0, dtype=np.int64)
    first = int(timed[0]) if timed.size else 0
    return Line(scene.removeprefix(UNSEEN_PREFIX), run, tuple(figures), timed.size, first, outside, nothing)


def _breaks(row: Row) -> bool:
    return row.bound is not None and not (row.value is not None and row.value <= row.bound)


def _broken(row: Row) -> str:
    return f"{row.metric} {quantity(row.value, row.unit)} in {row.scenario} (seed {row.seed})"


@dataclass(frozen=True)
class Lost:
    """One measure of one room in which another engine is better: our figure, the least of the others, which engine that is, and
    how far behind ours is: our figure over the least of the others, or over what counts as equal where that is larger."""

    room: str
    figure: float | None
    best: float
    run: str
    factor: float

    def said(self, unit: str) -> str:
        """"77.0 mm against 4.16 mm, mujoco/tuned"."""
        return f"{quantity(self.figure, unit)} against {quantity(self.best, unit)}, {self.run}"


def lost(found: Unseen, measure: Measure) -> tuple[tuple[Lost, ...], int]:
    """Rooms in which ours is behind in a measure, furthest first, and in how many rooms it was compared."""
    behind, compared = list[Lost](), 0
    for room in found.asked:
        own, best = found.line(room, found.ours), found.best(room, measure)
        if own is None or best is None:
            continue
        compared += 1
        figure = own.of(measure.metric)
        mine = figure if figure is not None and math.isfinite(figure) else math.inf
        if best[0] < mine - measure.same:
            least = max(best[0], measure.same)
            behind.append(Lost(room, figure, *best, mine / least if least > 0.0 else math.inf))
    return tuple(sorted(behind, key=lambda one: -one.factor)), compared


def losses(found: Unseen) -> tuple[str, ...]:
    """Per measure: in how many rooms another engine is better than ours, and the room in which ours is furthest behind."""
    said = []
    for measure in MEASURES:
        behind, compared = lost(found, measure)
        if behind:
            far = f", furthest behind in {behind[0].room} ({behind[0].said(measure.unit)})"
            said.append(f"{measure.title}: {len(behind)} of {count(compared, 'room')}{'' if measure is SHIVERS else far}")
    return tuple(said)


def conclusion(found: Unseen) -> str:
    """What to conclude, losses first."""
    parts = [f"Broken by {found.ours}: {listed(found.broken)}."] if found.broken else []
    behind = losses(found)
    parts += [f"{found.ours} is behind another engine (furthest: by our figure over theirs) in {'; '.join(behind)}."] \
        if behind else []
    own = [line for line in found.lines if line.run == found.ours and not line.nothing]
    if own and not found.broken:
        parts.append(f"It keeps what it promises (no overlap, limits, the right side) in {_rooms(found)}.")
    others = [(figure, line.run, line.room) for line in found.lines if engine_of(line.run) != engine_of(found.ours)
              and (figure := line.of(OVERLAP)) is not None and math.isfinite(figure)]
    if others:
        figure, run, room = max(others)
        parts.append(f"The deepest overlap of another engine is {quantity(figure, 'm')} ({run}, {room}).")
    if not own:
        parts.append(f"{found.ours} has no figure here.")
    return " ".join(parts)


def statuses(found: Unseen) -> str:
    """What ours said of itself while it was not where its target was, room by room."""
    parts = [f"{room}: {', '.join(f'{number:.0f} {name}' for name, number in counts)}" for room, counts in found.told if counts]
    return f"Frames and events that {found.ours} itself reports: {'; '.join(parts)}." if parts else (
        f"{found.ours} reports no frame in a trap, behind a wall or not ended well.")


def limits_sentence(found: Unseen) -> str:
    """How far other engines bend joints beyond their limits, room by room; "" where none does by as much as a degree."""
    runs = dict.fromkeys(line.run for line in found.lines if engine_of(line.run) != engine_of(found.ours))
    lines = {run: [line for line in found.lines if line.run == run and line.room in found.asked] for run in runs}
    said = "; ".join(f"{run} {_excesses(own)}" for run, own in lines.items() if _beyond(own) >= 1.0)
    return (f"Joints beyond their limits by at most, room by room: {said}. Engines that cannot say the limits of ball joints are "
            "not ranked by this.") if said else ""


def _excesses(lines: Sequence[Line]) -> str:
    """"95.0° (wall), 0.875° (floor)", the largest first; rooms without such a figure are left out."""
    known = [(angle, line.room) for line in lines if (angle := line.of(LIMITS)) is not None]
    return ", ".join(f"{quantity(angle, 'deg')} ({room})" for angle, room in sorted(known, reverse=True))


def source(found: Unseen) -> str:
    """Where the motions come from."""
    drawn = found.origin or f"seed {listed(tuple(map(str, found.seeds)))}"
    return f"Drawn by {drawn}. Another commit draws others; python -m scenarios run NAME --seed N repeats one."


def verdict_sentence(found: Unseen) -> str:
    """At the top of the page: what ours keeps on these motions, and its worst figures beside the best other engine there."""
    told = f"In {_rooms(found)} with motions that nothing was tuned for"
    if not any(line.of(CHATTER) is not None for line in found.lines if line.run == found.ours):
        return f"{told}, {found.ours} has no figure."
    kept = f"{found.ours} breaks {count(len(found.broken), 'promise')}" if found.broken else (
        f"in {found.ours} nothing overlaps, no joint is beyond its limits, all stays on its side")
    said = [sentence for metric, form in WORST.items() if (sentence := _worst(found, metric, form))]
    behind, of = lost(found, SHIVERS)
    said += [f"links in contact jitter more than in another engine in {len(behind)} of {count(of, 'room')}"] if behind else []
    but = f"; but {', '.join(said)}" if said else ""
    return " ".join(filter(None, [f"{told}, {kept}{but}.", smoother_in_short(found)]))


def _rooms(found: Unseen) -> str:
    """"5 rooms", and which of them are shown at another frame rate besides, which are not counted again."""
    again = f" (and again: {listed(tuple(room for room in found.rooms if room in found.variants))})" if found.variants else ""
    return f"{count(len(found.asked), 'room')}{again}"


def _worst(found: Unseen, metric: str, form: str) -> str:
    """Our largest figure of a metric with its room and the best other engine's figure there, of the rooms that are counted, as in
    the table; "" where there is none, or it is 0. Where ours is furthest behind in another room, that room too."""
    measure = next(one for one in MEASURES if one.metric == metric)
    shown = [(figure, line.room) for line in found.lines
             if line.run == found.ours and line.room in found.asked and (figure := line.of(metric)) is not None]
    # a figure that is no number is the worst
    figure, room = max(shown, key=lambda pair: pair[0] if math.isfinite(pair[0]) else math.inf, default=(0.0, ""))
    if figure == 0.0:
        return ""
    best = found.best(room, measure)
    beside = f"; {best[1]} {quantity(best[0], measure.unit)}" if best else ""
    behind, _ = lost(found, measure)
    if behind and behind[0].room != room:
        far = f" {factor(behind[0].figure / behind[0].best)}" if behind[0].figure and behind[0].best > 0.0 else ""
        beside += f"; furthest behind{far} in {behind[0].room}: {behind[0].said(measure.unit)}"
    return f"{form.format(quantity(figure, measure.unit))} ({room}{beside})"


def smoother(found: Unseen) -> str:
    """Every preset of the other engines that is smoother than ours, by the roughness of the table, in how many rooms, and beside
    it how far its own joints go beyond their limits there and why; the rule stands in the sentence."""
    runs = _smoother_runs(found)
    rule = f"Smoother than ours (roughness less by more than {ROUGHNESS.same:g}, in a room whose allowed side it does not leave)"
    return f"{rule}: {'; '.join(_smoother(found, run, lines) for run, lines in runs.items())}." if runs else ""


def smoother_in_short(found: Unseen) -> str:
    """The same in one sentence: how many presets of the other engines are smoother."""
    runs = _smoother_runs(found)
    return f"Smoother than ours in a room at least: {count(len(runs), 'preset')} of the other engines." if runs else ""


def _smoother_runs(found: Unseen) -> dict[str, list[Line]]:
    """Preset -> its lines in which it is smoother than ours, in the most rooms first."""
    runs: dict[str, list[Line]] = {}
    for line in found.lines:
        own, figure = found.line(line.room, found.ours), line.of(ROUGH)
        mine = own.of(ROUGH) if own else None
        aside = line.room not in found.asked or line.outside or engine_of(line.run) == engine_of(found.ours)
        if not aside and figure is not None and mine is not None and figure < mine - ROUGHNESS.same:
            runs.setdefault(line.run, []).append(line)
    return dict(sorted(runs.items(), key=lambda entry: -len(entry[1])))


def _beyond(lines: Sequence[Line]) -> float:
    """The largest angle [deg] beyond a joint's limits in these rooms; 0 where none is stated."""
    return max((angle for line in lines if (angle := line.of(LIMITS)) is not None and math.isfinite(angle)), default=0.0)


def _smoother(found: Unseen, run: str, lines: Sequence[Line]) -> str:
    """"mujoco/tuned in 2 of 5 rooms (joints beyond their limits by 150° (wall), 22° (door); adapter: twist unlimited)"."""
    said = f"{run} in {len(lines)} of {count(len(found.asked), 'room')}"
    if not _beyond(lines) > 0.0:
        return said
    most = max(lines, key=lambda line: line.of(LIMITS) or 0.0)
    why = briefly(f"{UNSEEN_PREFIX}{most.room}", run)
    return f"{said} (joints beyond their limits by {_excesses(lines)}{f'; {why}' if why else ''})"


def worst_first(found: Unseen) -> list[Line]:
    """The lines by room, the room in which ours shakes most first."""
    def badness(room: str) -> float:
        own = found.line(room, found.ours)
        figure = own.of(SHAKES.metric) if own else None
        return math.inf if figure is None or math.isnan(figure) else figure

    rooms = sorted(found.rooms, key=lambda room: -badness(room))
    return sorted(found.lines, key=lambda line: rooms.index(line.room))


def cell_rows(lines: Sequence[Line], ours: str) -> list[dict[str, object]]:
    """The lines for the template: a room's name on its first line only."""
    rows, before = list[dict[str, object]](), ""
    for line in lines:
        rows.append({
            "room": line.room if line.room != before else "", "scene": f"{UNSEEN_PREFIX}{line.room}", "run": line.run,
            "texts": line.texts, "timed": f"{line.timed} from {line.first}" if line.timed else MISSING,
            "nothing": line.nothing, "ours": line.run == ours, "outside": line.outside,
        })
        before = line.room
    return rows


def section(results: Results, ours: str) -> Mapping[str, object]:
    """What a page needs; `unseen` is None where the run has none of these rooms."""
    found = unseen(results, ours)
    if found is None:
        return {"unseen": None, "unseen_verdict": ""}
    ordered = worst_first(found)
    return {
        "unseen": found, "unseen_verdict": verdict_sentence(found), "unseen_conclusion": conclusion(found),
        "unseen_smoother": smoother(found), "unseen_limits": limits_sentence(found),
        "unseen_source": f"{statuses(found)} {source(found)}",
        "unseen_heads": [measure.title for measure in MEASURES],
        "unseen_tables": (
            ("", cell_rows([line for line in ordered if line.room in found.asked
                            and (line.run == ours or line.run.endswith(BEST))], ours)),
            ("Every engine, preset and frame rate", cell_rows(ordered, ours)),
        ),
    }
