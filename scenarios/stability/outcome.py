"""What came of one trial: did the engine get through, how deep, how much energy from nothing, and where did everything end."""

import math
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Engine, FrameRecord, Settings
from avatarsim.errors import InvalidInput, MissingPackage, StartOverlaps, described
from avatarsim.scene.tracker import checked
from reference.judging.judge import Judge
from runfiles.record import Recording
from scenarios import catalog
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.measure.bodies.energy import energy
from scenarios.measure.frames import not_finite
from scenarios.measure.side import wrong_side
from scenarios.running.run import gathered
from scenarios.scenario import Scenario
from scenarios.stability.plan import Trial
from scenarios.stability.variation import Varied, varied

Array = NDArray[np.float64]

JUDGED = 30
"""Most states of a trial that are judged, spread evenly, the last one among them."""
LATE = 60.0
"""Longest a trial may take [s] before it is given up as late; looked at between frames."""
SURVIVED, LOST, NOT_A_NUMBER, CRASHED, TOO_LATE, REFUSED, SILENT, ABSENT = (
    "survived", "lost", "not a number", "crashed", "late", "refused", "cannot say", "not measured",
)
"""How a trial ends. Lost: something ended up outside the region that the scene declares for it."""
UNASKED = (SILENT, ABSENT)
"""Ends that say nothing about how stable an engine is."""


STEP = "dt"
"""Setting in which an engine says the length of its solver's step [s]."""
LENGTHS = ("margin", "loose_margin")
"""Settings [m] of another engine that its preset chose for the lengths of a scene: they grow with a world, as the presets of
scenes of another size have them. Left as they are, 0.4 mm push a pile of ten boxes at size 0.15 apart by 23 mm of size 1."""


@dataclass(frozen=True)
class Task:
    """One trial of one case by one engine and preset."""

    case: str
    seconds: float
    engine: str
    preset: str
    trial: Trial

    @property
    def run(self) -> str:
        """Engine and preset as tables name them."""
        return f"{self.engine}/{self.preset}"


@dataclass(frozen=True)
class Outcome:
    """How a task ended. `frames` shown; `overlap` [m] deepest of the states judged and `energy` [J] largest gain of a frame that
    nothing explains, both brought back to a world of size 1; `bad` states that are no numbers; `end` the last places of all that
    moves, there as well, empty where there are none; `seconds` it took."""

    state: str
    frames: int = 0
    overlap: float = math.nan
    energy: float = math.nan
    bad: int = 0
    end: tuple[tuple[float, ...], ...] = ()
    seconds: float = 0.0
    note: str = ""

    def as_json(self) -> dict[str, object]:
        """As a line of the file of what is finished."""
        return asdict(self)

    @staticmethod
    def from_json(entry: Mapping[str, object]) -> "Outcome":
        """From such a line; raises KeyError, OverflowError, TypeError or ValueError for one that is damaged."""
        for name, kind in (("state", str), ("frames", int), ("bad", int), ("end", list), ("note", str)):
            if type(entry[name]) is not kind:
                raise TypeError(f"{name} of an outcome")
        end: Any = entry["end"]
        read = {**entry, "end": tuple(tuple(float(x) for x in row) for row in end)}
        for name in ("overlap", "energy", "seconds"):
            read[name] = float(str(entry[name]))
        return Outcome(**read)  # type: ignore[arg-type]


@dataclass
class _Shown:
    """What an engine has shown so far."""

    frames: list[FrameRecord] = field(default_factory=list)
    late: bool = False


def outcome(task: Task) -> Outcome:
    """Run `task` in this process; whatever an engine does wrong is its outcome, and never ends the sweep."""
    begun = time.monotonic()
    scenario, shown = catalog.get(task.case), _Shown()
    try:
        case = varied(scenario, task.seconds, task.trial.change)
    except InvalidInput as error:
        return Outcome(SILENT, note=f"there is no such scene: {described(error)}")
    try:
        engine = opened(task.engine)
        silence = engine.cannot_say(case.scene)
        if "scene" in silence:
            return Outcome(SILENT, note=silence["scene"])
        try:
            options = _options(engine, task, case)
            if options is None:
                return Outcome(SILENT, note="it has no solver step of a set length")
            _run(engine, task, case, options, shown, begun)
        finally:
            engine.close()
    except MissingPackage as error:
        return Outcome(ABSENT, note=str(error))
    except StartOverlaps as error:
        return Outcome(REFUSED, note=described(error), seconds=time.monotonic() - begun)
    except Exception as error:
        # an engine may raise anything: that is its result
        return Outcome(CRASHED, len(shown.frames), note=described(error), seconds=time.monotonic() - begun)
    found = _judged(task, scenario, case, shown)
    return Outcome(**{**found, "seconds": time.monotonic() - begun})  # type: ignore[arg-type]


def _options(engine: Engine, task: Task, case: Varied) -> dict[str, object] | None:
    """Options by which the solver's step is the one that is asked for, and the preset's lengths are of a world of that size, from
    what the preset sets in this very scene; None for an engine that has no such step."""
    change = task.trial.change
    if change.step == 1.0 and change.scale == 1.0:
        return {}
    engine.load(case.scene, Settings(task.preset, seed=change.seed), case.dt)
    told = engine.settings_as_run()
    found = {name: value[0] if isinstance(value := told[name], tuple) else value for name in (STEP, *LENGTHS) if name in told}
    options: dict[str, object] = {}
    for name in LENGTHS if change.scale != 1.0 else ():
        if isinstance(length := found.get(name), float) and length > 0.0:
            options[name] = change.scale * length
    if change.step == 1.0:
        return options
    step = found.get(STEP)
    return {**options, STEP: change.step * step} if isinstance(step, float) else None


def _run(engine: Engine, task: Task, case: Varied, options: dict[str, object], shown: _Shown, begun: float) -> None:
    """Show all frames, or those that come within LATE."""
    shown.frames.append(engine.load(case.scene, Settings(task.preset, options, task.trial.change.seed), case.dt))
    for sample in case.samples:
        if time.monotonic() - begun > LATE:
            shown.late = True
            return
        shown.frames.append(engine.advance(checked(sample, case.scene.avatars), case.dt))


def _judged(task: Task, scenario: Scenario, case: Varied, shown: _Shown) -> dict[str, object]:
    """State and figures of a run that came to an end, or was given up."""
    there = [case.scene.first_sample, *case.samples][: len(shown.frames)]
    about = Job(task.case, task.engine, task.preset)
    recording = task.trial.change.elsewhere.back(gathered(about, scenario, case.scene, there, shown.frames, {}))
    bad = int(_value(not_finite(recording)["not_finite_frames"]))
    found: dict[str, object] = {"frames": len(shown.frames) - 1, "bad": bad}
    if bad:
        return {**found, "state": NOT_A_NUMBER, "note": f"{bad} of {len(shown.frames)} states"}
    found["overlap"] = float(np.max(_depths(case, recording)))
    found["energy"] = _value(energy(recording, case.here).get("energy_added_max", math.nan))
    moving = [k for k, role in enumerate(case.here.roles) if role.name != "FIXED"]
    found["end"] = tuple(tuple(place) for place in recording.positions[-1, moving].tolist())
    astray = _value(wrong_side(recording, scenario, case.here).get("wrong_side_frames", 0.0))
    state = TOO_LATE if shown.late else LOST if astray else SURVIVED
    return {**found, "state": state, "note": outside_for(round(astray))}


def outside_for(frames: int) -> str:
    """In how many frames something was outside its region; "" for none."""
    return f"outside its region in {frames} frame{'' if frames == 1 else 's'}" if frames else ""


def _depths(case: Varied, recording: Recording) -> Array:
    chosen = np.unique(np.linspace(0, recording.frames, min(JUDGED, recording.frames + 1)).round().astype(int))
    return Judge(case.here).depths(recording.positions[chosen], recording.orientations[chosen])


def _value(value: object) -> float:
    """A figure, or nan for one that is missing."""
    return float(value) if isinstance(value, int | float) else math.nan
