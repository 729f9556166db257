"""What each effect costs and what leaving it out changes: every scene again without each of its effects, and with all others.

`python -m scenarios ablate` asks it of any scenes; STUDY, part of every comparison, of the everyday ones.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from shutil import rmtree
from tempfile import TemporaryDirectory

import numpy as np

from avatarsim.engine import ADAPTER
from avatarsim.scene.effects import KEPT, Effects
from avatarsim.scene.scene import Scene
from runfiles import record
from runfiles.files import write_json
from runfiles.naming import GATED
from runfiles.timing_protocol import REPEATS
from scenarios.job import Job, Outcome
from scenarios.results.gate import bounds_of
from scenarios.results.machine import Meter
from scenarios.running.harness import outcomes
from scenarios.running.progress import Progress
from scenarios.running.seat import Seats
from scenarios.running.timing import MOST_FRAMES, Clocked, Turns, loaded
from scenarios.scenario import Scenario
from scenarios.studies.study import Request, Study

ENGINE, PRESET = GATED
"""Only this engine has the switches."""

FILE = "ablation.json"
"""What the command leaves in the run's folder, for the report."""

FORCED = "forced"
"""Preset of the run with every effect that nothing calls for."""


ASIDE = ".effects-"
"""How the folder of recordings that are not kept begins; the rest of its name is random."""
LONG, SHORT = "long", "short"
"""Forms of the file: of the command, and of the study that a comparison asks."""


@dataclass(frozen=True)
class Line:
    """One effect of one scene: frame time p50 [us] as the scene calls for it and without, and what changes without it.

    `without_us` is None where the run without it ended early (`note` says why). Each frame counts with the least of `repeats`
    repeats of the same `frames`. `moved` [m] is how far any body is shown from where it was with the effect, at most; `broken`
    are bounds that no longer hold: metric, value with, value without, bound. The line of FORCED is the other way round: all
    effects that nothing calls for, forced on.
    """

    scenario: str
    effect: str
    called_by: tuple[str, ...]
    with_us: float | None
    without_us: float | None
    repeats: int
    frames: int
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
    plain = Job(name, ENGINE, PRESET, seed, full, frames)
    without = [replace(plain, preset=f"without-{effect}", base=PRESET, narrow=(effect,)) for effect in on if effect not in KEPT]
    return [plain, *without, replace(plain, preset=FORCED, base=PRESET, force=off)]


def lines(
    planned: Sequence[Job], done: Mapping[str, Outcome], clocked: Mapping[str, Clocked], scenes: Mapping[str, Scene],
    scenarios: Mapping[str, Scenario],
) -> list[Line]:
    """What `planned` jobs came to, scene by scene; outcomes and times by the job's stem."""
    plain = {job.scenario: job for job in planned if job.preset == PRESET}
    found = []
    for job in planned:
        there = plain[job.scenario]
        if job is there or job.stem not in done or there.stem not in done:
            continue
        one, other = done[there.stem], done[job.stem]
        repeats, frames = _protocol(clocked, there, job)
        found.append(
            Line(
                job.scenario, (*job.narrow, FORCED)[0], scenes[job.scenario].calls.get((*job.narrow, FORCED)[0], job.force),
                _p50(clocked, there), _p50(clocked, job), repeats, frames, moved(one, other),
                broken(one, other, scenarios[job.scenario]), "" if other.state == "measured" else f"{other.state}: {other.note}",
            )
        )
    return found


def _p50(clocked: Mapping[str, Clocked], job: Job) -> float | None:
    """Median frame [us], engine only; None where nothing was timed."""
    found = clocked.get(job.stem)
    return float(np.median(found.timed.best_us)) if found and found.timed else None


def _protocol(clocked: Mapping[str, Clocked], *jobs: Job) -> tuple[int, int]:
    """Repeats and frames that all of these jobs were timed with, at least."""
    shapes = [found.timed.around_ns.shape for job in jobs if (found := clocked.get(job.stem)) and found.timed]
    return (min(shape[0] for shape in shapes), min(shape[1] for shape in shapes)) if len(shapes) == len(jobs) else (0, 0)


def idle(planned: Sequence[Job], clocked: Mapping[str, Clocked]) -> dict[str, tuple[str, ...]]:
    """Stages of the frame that were called in no frame of a scene as it is. A stage that is not called takes no nanosecond, and
    the clock's reading alone takes some of one that is."""
    found = {}
    for job in planned:
        timed = clocked[job.stem].timed if job.preset == PRESET and job.stem in clocked else None
        if timed is not None:
            found[job.scenario] = tuple(name for name, ns in timed.stage_ns.items() if name != ADAPTER and not ns.any())
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


def write(found: Sequence[Line], idle: Mapping[str, Sequence[str]], form: str, folders: Sequence[Path]) -> None:
    """The file for the report, in each folder."""
    rows = [asdict(line) | {"share": line.share} for line in found]
    for folder in folders:
        write_json(folder / FILE, {"schema_version": 2, "form": form, "idle": idle, "lines": rows})


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


def ask(request: Request) -> list[str]:
    """The everyday scenes of a comparison that brought a recording of our engine; nothing where there are none.

    The run as the scene is has been recorded and judged, and is read again; its time is taken anew, in turn with the others."""
    scenarios = {name: scenario for name, scenario in request.scenarios.items() if scenario.everyday}
    if not scenarios or PRESET not in request.presets.get(ENGINE, ()):
        return []
    built = {name: scenario.as_run(request.full).build() for name, scenario in scenarios.items()}
    planned = [job for name, scene in built.items() for job in jobs(name, scene, request.seed, request.full, None)]
    for left in request.folder.glob(f"{ASIDE}*"):
        # of a run that was killed here
        rmtree(left, ignore_errors=True)
    aside_of = TemporaryDirectory(prefix=ASIDE, dir=request.folder)
    with Progress("effects", 2 * len(planned), sys.stderr) as progress, aside_of as aside:
        done = {}
        for folder, as_it_is in ((request.folder, True), (Path(aside), False)):
            for outcome in outcomes([job for job in planned if (job.preset == PRESET) is as_it_is], folder, request.jobs):
                done[outcome.job.stem] = outcome
                progress.step(f"{outcome.job.scenario} {outcome.job.preset} {outcome.state}")
        clocked = {}
        with Seats() as seats:
            for name in built:
                sound = [job for job in planned if job.scenario == name and done[job.stem].state == "measured"]
                for found in timed_in_turn(sound, seats):
                    clocked[found.job.stem] = found
                    progress.step(f"{name} {found.job.preset} timed")
        told = lines(planned, done, clocked, built, scenarios)
    write(told, idle(planned, clocked), SHORT, [request.folder])
    return []


def timed_in_turn(jobs: Sequence[Job], seats: Seats) -> list[Clocked]:
    """Time jobs of one scene in one process, turn by turn: what is compared then differs in the effect alone."""
    table, meter = list[Turns](), Meter()
    for _ in range(REPEATS):
        for k, job in enumerate(jobs):
            seat = seats.at(ENGINE)
            if k == len(table):
                table.append(Turns(job, seat, fresh=False))
            table[k].seat = seat
            for ready in loaded([table[k]], [MOST_FRAMES]):
                ready.turn(meter)
    return [turns.clocked() for turns in table]


STUDY = Study("effects", ask)
