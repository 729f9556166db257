"""What each effect costs and what its absence changes, from what `python -m scenarios ablate` left in the run's folder."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from reports.words.wording import MISSING, count, listed, quantity
from runfiles.csv_rows import DAMAGED
from runfiles.metrics import METRICS

FILE, SCHEMA_VERSION, FORCED = "ablation.json", 2, "forced"
SHORT = "short"
STAGES = {"posture": "overlap_removal", "motion": "dynamics", "coupling": "coupling"}
"""The effect without which a stage of the frame has nothing to do."""
FIRST = 6
"""Scenes shown before the reader has to ask for the rest."""
ROUNDING = 1e-12
"""Metres by which a forced effect may move a body; more is a change of the result."""
NOISE = 0.05
"""Share of a frame below which a difference of two runs says nothing."""


@dataclass(frozen=True)
class Broken:
    """A bound that holds with the effect and not without it; `without` is None where nothing could be measured."""

    metric: str
    kept: float
    without: float | None
    bound: float


@dataclass(frozen=True)
class Line:
    """One effect of one scene; see `scenarios.studies.ablation.Line`."""

    scenario: str
    effect: str
    called_by: tuple[str, ...]
    with_us: float | None
    without_us: float | None
    share: float | None
    moved: float | None
    broken: tuple[Broken, ...]
    note: str
    repeats: int
    frames: int

    @property
    def cost(self) -> float | None:
        """What the effect takes of the median frame [us]; negative where a frame takes longer without it."""
        return None if self.with_us is None or self.without_us is None else self.with_us - self.without_us


@dataclass(frozen=True)
class Ablation:
    """All lines: those of single effects, and by scene that of all the others, forced; `idle`: by scene, the stages that were
    called in no frame of the run as the scene is; `form`: whether a comparison asked, or the command."""

    lines: tuple[Line, ...]
    forced: tuple[Line, ...]
    idle: Mapping[str, tuple[str, ...]]
    form: str

    @property
    def scenes(self) -> tuple[str, ...]:
        """In the order of the run."""
        return tuple(dict.fromkeys(line.scenario for line in (*self.lines, *self.forced)))

    @property
    def effects(self) -> tuple[str, ...]:
        """Those that were left out anywhere, in the order of the table of calls."""
        return tuple(dict.fromkeys(line.effect for line in self.lines))

    def at(self, scenario: str, effect: str) -> Line | None:
        """One cell; None if the scene does not call for the effect."""
        return next((line for line in self.lines if (line.scenario, line.effect) == (scenario, effect)), None)


def load(run_dir: Path) -> Ablation | None:
    """The file of a run; None when it was not asked. Raises InvalidFile for a file that is damaged or of another layout."""
    path = run_dir / FILE
    if not path.exists():
        return None
    found: Any = read_json(path, str(path), "the whole file that `ablate` wrote")
    try:
        if found["schema_version"] != SCHEMA_VERSION:
            raise InvalidFile(f"schema_version of {path}", found["schema_version"], f"{SCHEMA_VERSION}; run again")
        lines = [_line(row) for row in found["lines"]]
        idle, form = {str(scene): tuple(map(str, stages)) for scene, stages in found["idle"].items()}, str(found["form"])
    except DAMAGED as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", "the whole file that `ablate` wrote") from error
    return Ablation(
        tuple(line for line in lines if line.effect != FORCED), tuple(line for line in lines if line.effect == FORCED), idle, form
    )


def _line(row: dict[str, Any]) -> Line:
    broken = tuple(Broken(str(m), float(kept), _real(lost), float(bound)) for m, kept, lost, bound in row["broken"])
    called_by = tuple(map(str, row["called_by"]))
    return Line(
        str(row["scenario"]), str(row["effect"]), called_by, _real(row["with_us"]), _real(row["without_us"]), _real(row["share"]),
        _real(row["moved"]), broken, str(row["note"]), int(row["repeats"]), int(row["frames"]),
    )


def _real(value: Any) -> float | None:
    return None if value is None else float(value)


def cost_sentence(found: Ablation) -> str:
    """From the least to the most that each effect takes of the frame over the scenes in which it takes more than noise, the
    dearest first; then, by scene, where a frame takes longer without it by more than noise."""
    shares = {e: {line.scenario: s for line in found.lines if line.effect == e and (s := line.share) is not None}
              for e in found.effects}
    dear = {e: kept for e, by in shares.items() if (kept := [s for s in by.values() if s > NOISE])}
    order = sorted(dear, key=lambda e: -max(dear[e]))
    takes = [f"{_name(e)} {_span([100.0 * s for s in dear[e]], '.0f')} % ({len(dear[e])} of {count(len(shares[e]), 'scene')})"
             for e in order]
    saving = sorted(((1.0 - s, _name(e), scene) for e, by in shares.items() for scene, s in by.items() if s < -NOISE),
                    reverse=True)
    said = f"Of the frame an effect takes, where that is more than noise: {'; '.join(takes)}." if takes else \
        "No effect takes a measurable share of the frame."
    longer = "; ".join(f"{name} in {scene}, {times:.3g} × as long" for times, name, scene in saving)
    return f"{said} Paying for themselves, since a frame takes longer without them: {longer}." if saving else said


def _span(values: Sequence[float], digits: str) -> str:
    """"25", or "-32 to 62" where the least and the most differ in what is printed."""
    # adding 0.0 makes a minus zero a zero
    least, most = (f"{round(value, int(digits[1])) + 0.0:{digits}}" for value in (min(values), max(values)))
    return least if least == most else f"{least} to {most}"


def absence_sentence(found: Ablation) -> str:
    """Where a bound rests on an effect, and where not."""
    rests = tuple(f"{_name(e)} in {n}" for e in found.effects if (n := sum(bool(x.broken) for x in found.lines if x.effect == e)))
    idle = tuple(_name(e) for e in found.effects if not any(line.broken for line in found.lines if line.effect == e))
    of = count(len(found.scenes), "scene")
    said = f"Bounds rest on {listed(rests, 12)} of {of}." if rests else "No bound rests on any effect."
    return f"{said} No bound of these scenes notices the absence of {', '.join(idle)}." if idle else said


def forced_sentence(found: Ablation) -> str:
    """Whether effects that nothing calls for change anything when they are forced on, and what that costs."""
    changed = tuple(line.scenario for line in found.forced if line.moved is None or not line.moved <= ROUNDING or line.broken)
    if changed:
        return f"Forced on where nothing calls for them, the other effects change the result of {listed(changed)}."
    cost = [-100.0 * line.share for line in found.forced if line.share is not None]
    shorter = " (negative: they shorten it)" if any(round(part) < 0 for part in cost) else ""
    dearer = f", and lengthen the frame by {_span(cost, '.0f')} %{shorter}" if cost else ""
    most = max((line.moved or 0.0 for line in found.forced), default=0.0)
    moved = f"by more than {quantity(most, 'm')}" if most else "at all"
    where = f"in {count(len(found.forced), 'scene')}{dearer}"
    return f"Forced on where nothing calls for them, all other effects together move no body {moved} {where}."


def uncalled(found: Ablation) -> tuple[tuple[str, str], ...]:
    """(scene, stage) of every stage that ran although no part of the scene calls for its effect."""
    return tuple(
        (line.scenario, stage) for line in found.forced for stage, effect in STAGES.items()
        if effect in line.called_by and stage not in found.idle.get(line.scenario, ())
    )


def answer(found: Ablation) -> str:
    """One sentence on whether only the effects are simulated that a scene calls for."""
    ran = tuple(f"{stage} in {scene}" for scene, stage in uncalled(found))
    if ran:
        return f"Not only the effects are simulated that a scene calls for: nothing calls for {listed(ran)}, and it ran."
    together: dict[tuple[str, ...], list[str]] = {}
    for scene, stages in found.idle.items():
        if stages:
            together.setdefault(stages, []).append(scene)
    if not together:
        return "Every stage of the frame is called for in each of these scenes."
    idle = "; ".join(f"{' and '.join(stages)} in {listed(tuple(scenes))}" for stages, scenes in together.items())
    return f"Only what a scene calls for is simulated: zero calls of {idle}."


def cell(line: Line | None) -> str:
    """What the effect takes of the median frame, in words; empty where the scene does not call for the effect."""
    if line is None:
        return ""
    return MISSING if line.cost is None or math.isnan(line.cost) else quantity(line.cost, "us")


def consequence(line: Line | None) -> str:
    """Its share of the frame, and what leaving the effect out changes, in a few words."""
    if line is None:
        return ""
    share = ""
    if line.share is not None and not math.isnan(line.share):
        # round() has no minus zero
        share = f"{1.0 - line.share:.3g} × as long without it, " if line.share < -NOISE else f"{round(100.0 * line.share)} %, "
    if line.broken:
        return f"{share}breaks {len(line.broken)}"
    if line.moved is None:
        return f"{share}not measured"
    return f"{share}{quantity(line.moved, 'm')}" if line.moved > ROUNDING else f"{share}none"


def forced_cell(line: Line | None) -> str:
    """By how much the median frame grows when all other effects are forced on, with its sign."""
    if line is None or line.cost is None or math.isnan(line.cost):
        return MISSING
    return f"{'+' if line.cost < 0.0 else ''}{quantity(-line.cost + 0.0, 'us')}"


def forced_consequence(line: Line | None) -> str:
    """The same as a share of the frame, and what forcing changes, in a few words."""
    said = "" if line is None else consequence(line)
    if line is None or line.share is None or math.isnan(line.share):
        return said
    return f"{round(-100.0 * line.share):+d} %, {said.partition(', ')[2]}"


def in_unit(metric: str, value: float | None) -> str:
    """A figure of a bound in the unit of its metric."""
    return "not measured" if value is None else quantity(value, METRICS[metric][0] if metric in METRICS else "")


def protocol(found: Ablation) -> str:
    """How the times were taken."""
    frames = [line.frames for line in (*found.lines, *found.forced) if line.frames]
    if not frames:
        return "No times were taken."
    repeats = min(line.repeats for line in (*found.lines, *found.forced) if line.frames)
    span = f"{min(frames)} to {max(frames)}" if min(frames) < max(frames) else f"{frames[0]}"
    return f"Median over {span} frames, each the least of {count(repeats, 'repeat')}, with and without taking turns."


def broken_rows(found: Ablation) -> list[tuple[str, str, str, Broken]]:
    """(effect, scene, what calls for it, bound) of every bound that is lost, effect by effect."""
    return [
        (_name(effect), line.scenario, listed(line.called_by, 2), lost)
        for effect in found.effects for line in found.lines if line.effect == effect for lost in line.broken
    ]


def _name(effect: str) -> str:
    return effect.replace("_", " ")


def section(found: Ablation) -> dict[str, object]:
    """What the section is made of."""
    return {
        "effects_cost": cost_sentence(found), "effects_absence": absence_sentence(found),
        "effects_forced": forced_sentence(found), "effects_cell": cell, "effects_broken": broken_rows(found),
        "effects_forced_cell": forced_cell, "effects_forced_consequence": forced_consequence, "effects_in_unit": in_unit,
        "effects_name": _name, "effects_noise": 100.0 * NOISE,
        "effects_answer": answer(found), "effects_consequence": consequence, "effects_protocol": protocol(found),
        "effects_first": found.scenes[:FIRST], "effects_more": found.scenes[FIRST:], "effects_short": found.form == SHORT,
    }
