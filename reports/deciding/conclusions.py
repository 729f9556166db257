"""Sentences computed from the data: what each chart lets a reader conclude."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from reports.deciding.columns import COLUMNS
from reports.deciding.tables import Block, engine_of
from reports.reading.load import Array, Results, Series
from reports.words.metric_words import words
from reports.words.wording import MOST_FACTOR, count, limit, listed, quantity
from runfiles.behind import MetricLosses
from runfiles.like_for_like import with_avatar
from runfiles.timing_protocol import least_of

# The bound on residual overlap [m], in every scene. Larger would let a visible fault pass; smaller is below what meshes resolve.
OVERLAP_BOUND = 1e-6
# Time of one frame [us] at 60 Hz, and at the 90 Hz of a headset.
FRAME_60_HZ, FRAME_90_HZ = 1e6 / 60.0, 1e6 / 90.0
# Parts of the names of settings [m] that hold bodies apart, ours among them, and what to call them.
HOVERS = {"margin": "contact margin", "stand_off": "stand-off", "loose_margin": "contact margin of loose things"}
# Stands in the first paragraph of page and summary.
KINEMATIC = (
    "Our avatar is kinematic: the user's motion drives it. MuJoCo and PyBullet compute the dynamics of the whole articulated "
    "body and pay for it in frame time, so times of scenes with an avatar are not like for like. Contact force and joint torque "
    "are not measured."
)
# Stands beside every table that compares engines: without it frame times are read as like for like, which they are not.
CAVEAT = (
    "Not like for like: our avatar is kinematic, with a coupled mass where it meets simulated bodies; it is not full articulated "
    "dynamics, which MuJoCo and PyBullet compute and pay for in frame time. "
    "What rests sleeps in our engine; in the tuned others it is computed, and rows that sleep (mujoco/sleeping, "
    "pybullet/sleeping) stand beside them in scenes whose bodies are to rest. Of a time of a scene with an avatar, and of one in "
    "which what rests sleeps, no factor is made, and none is best."
)


def peak(overlap: Array) -> float:
    """Largest entry; NaN if any entry is not finite, so that a gap is never taken for a good result."""
    return float(np.max(overlap)) if overlap.size else math.nan


def overlap_sentence(runs: Mapping[str, Series]) -> str:
    """What one panel of residual overlap shows: which engines stay below the bound, which do not, by how much."""
    peaks = {run: peak(series.overlap) for run, series in runs.items() if series.overlap.size}
    if not peaks:
        return "No engine has a series here, so nothing follows."
    good = tuple(run for run, value in peaks.items() if value <= OVERLAP_BOUND)
    broken = tuple(run for run, value in peaks.items() if math.isnan(value))
    bad = sorted((run for run in peaks if run not in good + broken), key=lambda run: -peaks[run])
    parts = [f"{listed(good)} {'stays' if len(good) == 1 else 'stay'} within 1 µm"] if good else []
    parts += [listed(tuple(f"{run} reaches {quantity(peaks[run], 'm')}" for run in bad))] if bad else []
    parts += [f"{listed(broken)} has frames without a finite number"] if broken else []
    return "; ".join(parts) + "."


def overlap_text(runs: Mapping[str, Series]) -> str:
    """Text alternative of one overlap panel: peak and share of frames above the bound, per run."""
    parts = []
    for run, series in runs.items():
        if series.overlap.size:
            above = 100.0 * float(np.mean(~(series.overlap <= OVERLAP_BOUND)))
            parts.append(f"{run}: peak {quantity(peak(series.overlap), 'm')}, {above:.0f} % of frames above 1 µm")
    return "Residual overlap per frame. " + ("; ".join(parts) or "No series") + "."


def overlap_summary(results: Results, ours: str) -> str:
    """What all overlap panels together say about our run, the best other one and the raw motion, of `shown_scenes`."""
    scenes = shown_scenes(results, ours)
    if not scenes:
        return "This run recorded no series of overlap."
    tally: dict[str, dict[str, bool]] = {}
    for scene, runs in scenes.items():
        for run, series in runs.items():
            if series.overlap.size:
                held, family = tally.setdefault(run, {}), results.family(scene)
                held[family] = held.get(family, True) and peak(series.overlap) <= OVERLAP_BOUND
    order = sorted(tally, key=lambda run: (run != ours, -sum(tally[run].values()) / len(tally[run])))
    said = [f"{run} in {sum(tally[run].values())} of {len(tally[run])}" for run in order]
    without = tuple(name for name, runs in results.series.items()
                    if name not in scenes and any(s.overlap.size for s in runs.values()))
    left = f" Neither counted nor in the plot, since {ours} refuses or shows nothing: {listed(without)}." if without else ""
    return f"Families of scenes in which every frame stays within 1 µm: {', '.join(said)}.{left}"


def shown_scenes(results: Results, ours: str) -> dict[str, Mapping[str, Series]]:
    """Scenes with a series of overlap, by run: those in which ours has one, so that all engines have one denominator; all where
    ours has none anywhere."""
    scenes = {scene: runs for scene, runs in results.series.items() if any(s.overlap.size for s in runs.values())}
    own = {scene: runs for scene, runs in scenes.items() if ours in runs and runs[ours].overlap.size}
    return own or scenes


def time_sentence(percentiles: Mapping[str, tuple[float, float, float]], aside: str = "") -> str:
    """What one panel of frame times shows: which engine is fastest at p95, which miss 90 Hz, as far as p99 is known. `aside`: why
    the times of this scene stand side by side and none is the best, "" where they are compared."""
    finite = {run: p for run, p in percentiles.items() if math.isfinite(p[1])}
    if not finite:
        return "No frame time was measured here, so nothing follows."
    order = sorted(finite, key=lambda run: finite[run][1])
    first = order[0]
    often = tuple(run for run in order if finite[run][1] > FRAME_90_HZ)
    late = tuple(run for run in order if run not in often and finite[run][2] > FRAME_90_HZ)
    untold = tuple(run for run in order if math.isnan(finite[run][2]))
    text = f"The p95 of {first} is {quantity(finite[first][1], 'us')}"
    if len(order) > 1 and aside:
        each = ", ".join(f"{run} {quantity(finite[run][1], 'us')}" for run in order)
        text = f"p95, side by side ({aside}): {each}"
    elif len(order) > 1:
        text = f"{first} has the lowest p95, {quantity(finite[first][1], 'us')}"
        last = order[-1]
        text += f"; {last} takes {finite[last][1] / finite[first][1]:.3g} times as long"
    for runs, share in ((often, 5), (late, 1)):
        if runs:
            text += f"; {listed(runs)} {'misses' if len(runs) == 1 else 'miss'} 90 Hz in more than {share} % of the frames"
    if often or late:
        return f"{text}."
    return f"{text}; {'all keep' if len(order) > 1 else 'it keeps'} 90 Hz at {'p95' if untold else 'p99'}."


def time_summary(
    panels: Mapping[str, Mapping[str, tuple[float, float, float]]], ours: str, counted: str = "",
    slowest_frames: Mapping[str, float] = MappingProxyType({}), scenes: int = 0, repeats: int = 0,
) -> str:
    """What all panels of frame time together say about our run, its slowest frame [us] by scene first (of so many `scenes`),
    the least of so many `repeats`;
    `counted`: in how many families its p95 is best, as the losses count them."""
    own = {scene: runs for scene, runs in panels.items() if ours in runs and math.isfinite(runs[ours][1])}
    if not own:
        return f"No frame time of {ours} was measured."
    slowest = max(own, key=lambda scene: own[scene][ours][1])
    text = slowest_sentence(slowest_frames, ours, scenes, repeats)
    text += f"The highest p95 of {ours} is {quantity(own[slowest][ours][1], 'us')}, in {slowest}"
    return text + (f"; it is best or level in {counted}." if counted else ".")


def slowest_sentence(frames: Mapping[str, float], ours: str, scenes: int = 0, repeats: int = 0) -> str:
    """The slowest frame [us] of ours over all scenes that were timed long enough to have one, of so many, each frame the least of
    its `repeats` (0: not known), against what a headset allows."""
    if not frames:
        return ""
    worst = max(frames, key=lambda scene: frames[scene])
    over = sum(not time <= FRAME_90_HZ for time in frames.values())
    of = f" of {count(scenes, 'scene')}" if scenes else ""
    held = f"in each of the {len(frames)}{of} with such a figure every frame that was timed fits into"
    if over:
        held = f"in {over} of the {len(frames)}{of} with such a figure a frame takes longer than"
    how = f" ({least_of(repeats)})" if repeats else ""
    return f"The slowest frame of {ours}{how} takes {quantity(frames[worst], 'us')}, in {worst}; {held} the 11.1 ms of 90 Hz. "


def table_sentence(shown: tuple[Block, ...], ours: str, every: Sequence[MetricLosses] = ()) -> str:
    """What to conclude beside the verdict table: over all ranked metrics (`every`) and their families where another engine is
    better; then in how many cells of the table we are best, and which metrics it leaves out although we lose in them."""
    ranked = [
        cell for block in shown for line in block.lines if line.run == ours
        for cell in line.cells if cell.ratio is not None
    ]
    best = sum(cell.best for cell in ranked)
    rivals = any(not line.tracker and engine_of(line.run) != engine_of(ours) for block in shown for line in block.lines)
    if not ranked or not rivals:
        return f"{ours} has no other engine to be compared with in this run."
    left_out = [one for one in every if not any(column.ranked and column.takes(one.metric) for column in COLUMNS)]
    lost = tuple(f"{words(one.metric)} in {one.said}" for one in sorted(left_out, key=lambda one: -len(one.lost)) if one.lost)
    more = ""
    if left_out:
        also = f", in {len(lost)} of which another engine is better: {listed(lost, 4)}" if lost else ", and loses in none of them"
        more = f"; the table leaves out {len(left_out)} of {count(len(every), 'ranked metric')}{also}"
    lead, behind = "", sum(len(one.lost) for one in every)
    if every:
        lead = (f"Over {count(len(every), 'ranked metric')} and the families of scenes of each, another engine is better in "
                f"{behind:,} of {count(sum(one.families for one in every), 'case')}. ")
    return f"{lead}Of the cells of this table that can be ranked, {ours} is best or level in {best:,} of {len(ranked):,}{more}."


def asleep_sentence(block: Block) -> str:
    """Which engines of a scene sleep in the median frame, with their medians, and what frames that move take; "" where none
    does."""
    if not block.asleep:
        return ""
    places = {"median": "frame_time_p50", "tail": "frame_time_p95", "slowest": "frame_time_max"}
    times = {
        line.run: {name: next((quantity(cell.value, "us") for cell in line.cells
                               if cell.row and cell.row.metric == metric and cell.value is not None), "")
                   for name, metric in places.items()} for line in block.lines if not line.tracker
    }
    medians = tuple(f"{run} {times[run]['median']}" for run in block.asleep if times.get(run, {}).get("median"))
    tails = tuple(f"{run} {of['tail']}" for run, of in times.items() if of["tail"] and run not in block.asleep_through)
    tails += tuple(f"{run} {of['slowest']} (its slowest: it sleeps in the 95th percentile too)" if of["slowest"] else
                   f"{run} sleeps in that too" for run, of in times.items() if run in block.asleep_through)
    each = "both sleep" if len(medians) == 2 else "all sleep" if len(medians) > 2 else "one sleeps"
    if not medians:
        return ""
    return (f"In the median frame {each}: {listed(medians, len(medians))}; no factor is made of medians here. In frames that "
            f"move (95th percentile): {listed(tails, len(tails))}.")


def ratio_sentence() -> str:
    """How factors read: where they end, and what stands beside a best of 0."""
    return (f"A factor is a value over the best of its scene and ends at ×{MOST_FACTOR:,.0f}; where the best is 0 there is none, "
            "and the two figures stand for themselves.")


def hover_notes(results: Results) -> tuple[str, ...]:
    """One sentence per engine and preset whose settings keep links apart from all else: no overlap then says little. Links are
    counted in scenes with an avatar alone, loose things in all."""
    found: dict[tuple[str, str], list[float]] = {}
    avatars, asked = with_avatar(results.rows), dict[tuple[str, str], int]()
    for note in results.engines:
        for name, kind in HOVERS.items():
            if name in note.settings and (kind == HOVERS["loose_margin"] or note.scenario in avatars):
                asked[note.run, kind] = asked.get((note.run, kind), 0) + 1
                if (length := _length(note.settings[name][0])) > 0.0:
                    found.setdefault((note.run, kind), []).append(length)
    said = []
    for (run, kind), lengths in found.items():
        span = " to ".join(limit(length, "m") for length in dict.fromkeys((min(lengths), max(lengths))))
        loose = kind == HOVERS["loose_margin"]
        of = f"{count(asked[run, kind], 'scene')}{'' if loose else ' with an avatar'}"
        where = f"{len(lengths)} of {of}" if len(lengths) < asked[run, kind] else of
        said.append(f"{run} keeps a {kind} of {span} in {where}: {'loose things stand apart' if loose else 'its links hover'}.")
    return tuple(said)


def gap_sentence(results: Results) -> str:
    """How far an avatar that touches is from what it touches, per engine over the scenes that have the figure; "" without any."""
    found: dict[str, list[float]] = {}
    for row in results.rows:
        if row.metric == "contact_gap_p50" and row.value is not None and math.isfinite(row.value):
            found.setdefault(row.run, []).append(row.value)
    said = []
    for run, gaps in found.items():
        span = " to ".join(dict.fromkeys((quantity(min(gaps), "m"), quantity(max(gaps), "m"))))
        said.append(f"{run} {span}")
    return f"Median gap of an avatar to what it touches, from scene to scene: {'; '.join(said)}." if said else ""


def _length(text: str) -> float:
    """A length [m] from a setting's text; 0 where it is no finite number."""
    try:
        value = float(text)
    except ValueError:
        return 0.0
    return value if math.isfinite(value) else 0.0
