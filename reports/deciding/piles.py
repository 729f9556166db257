"""Stacking and granular benchmarks: which engine for stacks of boxes, at rest and in motion, by time and by overlap."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reports.deciding.alike import asleep, sleepers
from reports.deciding.tables import RAW_TRACKER, engine_of
from reports.reading.load import Results
from reports.words.wording import factor, limit, quantity

RESTS, MOVES = ("stack_ten",), ("stack_struck", "balls_216")
"""Scenes of piles that stand for all but their first frames, and of piles in motion throughout."""
TIME, SLOWEST, OVERLAP = "frame_time_p50", "frame_time_max", "residual_overlap_max"
LEVELS = (1e-2, 1e-3, 1e-6)
"""Overlaps [m] for which the fastest is named."""


@dataclass(frozen=True)
class Pace:
    """Median or slowest time of a frame [us] and deepest overlap [m] of one run in one scene."""

    run: str
    time: float
    overlap: float

    @property
    def said(self) -> str:
        """"mujoco/tuned 230 µs, leaves 1.23 mm"."""
        return f"{self.run} {quantity(self.time, 'us')}, leaves {quantity(self.overlap, 'm')}"


def paces(results: Results, scene: str, time: str = TIME) -> tuple[Pace, ...]:
    """Every run of a scene that has overlap and `time`, fastest first; of several seeds the worst."""
    found: dict[str, dict[str, float]] = {}
    for row in results.of(scene):
        if row.metric in (time, OVERLAP) and row.value is not None and math.isfinite(row.value) and row.engine != RAW_TRACKER:
            own = found.setdefault(row.run, {})
            own[row.metric] = max(own.get(row.metric, 0.0), row.value)
    made = [Pace(run, own[time], own[OVERLAP]) for run, own in found.items() if len(own) == 2]
    return tuple(sorted(made, key=lambda one: one.time))


def in_motion(results: Results, ours: str) -> str:
    """Where a pile in motion takes ours longer than another engine and where it does not, the worst first; "" without such a
    scene."""
    said: list[tuple[float, str]] = []
    for scene in MOVES:
        found = paces(results, scene)
        own = next((one for one in found if one.run == ours), None)
        rival = next((one for one in found if engine_of(one.run) != engine_of(ours)), None)
        if own is None or rival is None:
            continue
        times = own.time / rival.time if rival.time > 0.0 else math.inf
        far = f"{factor(times)} the time of the fastest" if times > 1.0 else "less time than any other"
        said.append((times, f"{scene} takes ours {far} (median {quantity(own.time, 'us')}, leaves {quantity(own.overlap, 'm')}; "
                            f"{rival.said})"))
    worst_first = [text for _, text in sorted(said, key=lambda one: -one[0])]
    return f"Piles of bodies in motion: {'; '.join(worst_first)}." if worst_first else ""


def which(results: Results, ours: str) -> str:
    """For stacks at rest and piles in motion the fastest run that leaves at most so much, scene by scene, of ours as it comes and
    of all presets of other engines. Where any of them sleeps in the median frame, by the slowest frame, and the medians asleep
    stand beside it: a frame of what sleeps is no measure of the engine."""
    said, sleeping = [], sleepers(results)
    for kind, scenes in (("At rest", RESTS), ("In motion", MOVES)):
        for scene in scenes:
            sleeps = asleep(sleeping.get(scene, {}), "p50")
            found, moving = _as_it_comes(paces(results, scene), ours), _as_it_comes(paces(results, scene, SLOWEST), ours)
            medians = [f"{one.run} {quantity(one.time, 'us')}" for one in found if one.run in sleeps]
            if medians and moving:
                said.append(f"{kind} ({scene}), least slowest frame with an overlap of {_by_level(moving)}; "
                            f"median asleep: {', '.join(medians)}.")
            elif found:
                said.append(f"{kind} ({scene}), fastest median with an overlap of {_by_level(found)}.")
    return " ".join(said)


def _as_it_comes(found: Sequence[Pace], ours: str) -> list[Pace]:
    """Those of our engine as it comes and of all presets of other engines."""
    return [one for one in found if one.run == ours or engine_of(one.run) != engine_of(ours)]


def _by_level(found: Sequence[Pace]) -> str:
    """"at most 10 mm: ...; 1 mm: ...", equal answers together."""
    answers: dict[str, list[str]] = {}
    for level in LEVELS:
        best = next((one for one in found if one.overlap <= level), None)
        text = "none of those run" if best is None else best.said
        answers.setdefault(text, []).append(limit(level, "m"))
    return "; ".join(f"at most {' or '.join(levels)}: {text}" for text, levels in answers.items())
