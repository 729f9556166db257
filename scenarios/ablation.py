"""What each effect costs and what leaving it out changes: every scene again without each of its effects, and with all others."""

import argparse
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

import numpy as np

from avatarsim.scene.calls import KEPT
from avatarsim.scene.effects import Effects
from avatarsim.scene.scene import Scene
from scenarios import record
from scenarios.commands import Plan, begun, finished, nothing, passes, scenes
from scenarios.engines import GATED
from scenarios.files import plain, point_latest, write_json
from scenarios.gate import bounds_of
from scenarios.harness import Run
from scenarios.job import Job, Outcome
from scenarios.scenario import Scenario

ENGINE, PRESET = GATED
"""Only this engine has the switches."""

FILE = "ablation.json"
"""What the command leaves in the run's folder, for the report."""

FORCED = "forced"
"""Preset of the run with every effect that nothing calls for."""


@dataclass(frozen=True)
class Line:
    """One effect of one scene: frame time p50 [us] as the scene calls for it and without, and what changes without it.

    `without_us` is None where the run without it ended early (`note` says why). `moved` [m] is how far any body is shown from
    where it was with the effect, at most; `broken` are bounds that no longer hold: metric, value with, value without, bound.
    `timed` says how often and over how many frames both were timed. The line of FORCED is the other way round: all effects that
    nothing calls for, forced on.
    """

    scenario: str
    effect: str
    called_by: tuple[str, ...]
    with_us: float | None
    without_us: float | None
    moved: float | None
    broken: tuple[tuple[str, float | None, float | None, float], ...]
    note: str
    timed: str = ""

    @property
    def share(self) -> float | None:
        """Share of the frame that goes into the effect; negative if leaving it out costs more."""
        if not self.with_us or self.without_us is None:
            return None
        return (self.with_us - self.without_us) / self.with_us


def jobs(name: str, scene: Scene, seed: int, full: bool, frames: int | None) -> list[Job]:
    """The scene as it is, without each effect that can be left out, and with all that nothing calls for."""
    on = [effect.name for effect in fields(Effects) if getattr(scene.effects, effect.name)]
    off = tuple(effect.name for effect in fields(Effects) if not getattr(scene.derived_effects, effect.name))
    plain = Job(name, ENGINE, PRESET, seed, full, frames, base=PRESET)
    without = [replace(plain, preset=f"without-{effect}", narrow=(effect,)) for effect in on if effect not in KEPT]
    return [plain, *without, replace(plain, preset=FORCED, force=off)]


def lines(ran: Run, scenes: Mapping[str, Scene]) -> list[Line]:
    """What a finished run says, scene by scene."""
    timed = {(row.scenario, row.preset): row for row in ran.rows() if row.metric == "frame_time_p50"}
    p50 = {key: row.value for key, row in timed.items()}
    done = {(outcome.job.scenario, outcome.job.preset): outcome for outcome in ran.outcomes.values()}
    found = []
    for job in ran.jobs:
        effect = (*job.narrow, FORCED)[0]
        plain, other = done.get((job.scenario, PRESET)), done.get((job.scenario, job.preset))
        if job.preset == PRESET or plain is None or other is None:
            continue
        found.append(
            Line(
                job.scenario, effect, scenes[job.scenario].calls.get(effect, job.force), p50.get((job.scenario, PRESET)),
                p50.get((job.scenario, job.preset)), moved(plain, other), broken(plain, other, ran.scenarios[job.scenario]),
                "" if other.state == "measured" else f"{other.state}: {other.note}",
                timed[job.scenario, job.preset].note if (job.scenario, job.preset) in timed else "",
            )
        )
    return found


def moved(plain: Outcome, other: Outcome) -> float | None:
    """Largest distance [m] between the same body in the same frame of two runs; None if one has no recording."""
    if plain.recording is None or other.recording is None:
        return None
    a, b = record.load(plain.recording).positions, record.load(other.recording).positions
    frames = min(len(a), len(b))
    return float(np.linalg.norm(a[:frames] - b[:frames], axis=-1).max())


def broken(plain: Outcome, other: Outcome, scenario: Scenario) -> tuple[tuple[str, float | None, float | None, float], ...]:
    """Bounds that hold in one run and not in the other."""
    def value(outcome: Outcome, metric: str) -> float | None:
        found = outcome.values.get(metric)
        return found if isinstance(found, float) else None

    found = []
    for metric, bound in bounds_of(scenario).items():
        kept, lost = value(plain, metric), value(other, metric)
        if kept is not None and bound.holds(kept) and not (lost is not None and bound.holds(lost)):
            found.append((metric, kept, lost, bound.limit))
    return tuple(found)


def write(found: Iterable[Line], folders: Sequence[Path]) -> None:
    """The file for the report, in each folder."""
    rows = [asdict(line) | {"share": line.share} for line in found]
    for folder in folders:
        write_json(folder / FILE, {"schema_version": 1, "lines": rows})


def table(found: Sequence[Line]) -> str:
    """The same for a terminal."""
    head = f"{'scene':24} {'without':16} {'with us':>9} {'without us':>10} {'share':>6} {'moved m':>9}"
    rows = [f"{head}  bounds that no longer hold"]
    for line in found:
        name = f"{FORCED}: all else" if line.effect == FORCED else line.effect
        said = ", ".join(f"{metric} {_number(lost)} (bound {limit:.3g})" for metric, _, lost, limit in line.broken)
        share = "" if line.share is None else f"{100.0 * line.share:5.0f}%"
        figures = f"{_number(line.with_us):>9} {_number(line.without_us):>10} {share:>6} {_number(line.moved):>9}"
        rows.append(f"{line.scenario:24} {name:16} {figures}  {said or line.note or 'none'}")
    return "\n".join(rows)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


def ablate(asked: argparse.Namespace, words: Sequence[str]) -> int:
    """Each scene as it is, without each of its effects, and with all others: accuracy, then time, our engine only."""
    found = scenes(asked)
    if not found:
        return nothing(asked)
    built = {name: scenario.as_run(asked.full).build() for name, scenario in found.items()}
    planned = [
        job for name, scene in built.items() for seed in asked.seed[:1]
        for job in jobs(name, scene, seed, asked.full, asked.frames)
    ]
    made = Plan(found, planned, [], frozenset())
    ran = begun(asked, words, made, {})
    code = passes(asked, made, ran, timed=True)
    told = lines(ran, built)
    beside = asked.out.resolve() / "latest"
    write(told, [ran.folder, *([beside] if beside.is_dir() else [])])
    if not beside.exists():
        # nothing was compared here before: the report is that of this run
        point_latest(ran.folder)
    print(json.dumps(plain([asdict(line) for line in told]), allow_nan=False) if asked.json else table(told))
    return finished(asked, made, ran, code)
