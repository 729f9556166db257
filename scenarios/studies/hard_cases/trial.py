"""One trial of a hard case: its state, the deepest overlap, energy from nothing, and the last places of all bodies."""

import math
from contextlib import closing
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import FrameRecord
from avatarsim.errors import InvalidInput, described
from reference.judging.judge import Judge
from runfiles.record import Recording
from scenarios import catalog
from scenarios.engines import opened
from scenarios.job import Job, State
from scenarios.measure.bodies.energy import energy
from scenarios.measure.frames import not_finite
from scenarios.measure.side import wrong_side
from scenarios.run.accuracy import Prepared, gathered, show
from scenarios.scenario import REFUSAL, Scenario
from scenarios.studies.checkpoint import Entry
from scenarios.studies.hard_cases.plan import Trial
from scenarios.studies.hard_cases.variation import Variation, Varied, varied

Array = NDArray[np.float64]

FIGURES = ("residual_overlap_max", "energy_added_max", "not_finite_frames", "wrong_side_frames")
"""Figures of a trial, lengths and energies as in a world of size 1."""
JUDGED = 30
"""Most states of a trial that are judged, spread evenly, the last one among them."""
LATE = 60.0
"""Longest a trial may take [s] before it is given up; looked at between frames."""
STEP = "dt"
"""Setting in which an engine states the length of its solver's step [s]."""
LENGTHS = ("margin", "loose_margin")
"""Settings [m] of another engine that its preset chose for the lengths of a scene: they grow with a world, as the presets of
scenes of another size have them. Left as they are, 0.4 mm push a pile of ten boxes at size 0.15 apart by 23 mm of size 1."""


@dataclass(frozen=True)
class Task:
    """One trial of so many seconds of the case of a job."""

    job: Job
    seconds: float
    trial: Trial


def tried(task: Task) -> Entry:
    """Run a task in this process: state, note, frames, values of FIGURES, and the last places of all that moves.

    A fault of an engine is its state, and never ends the study.
    """
    job, change = task.job, task.trial.change
    scenario = catalog.get(job.scenario)
    try:
        case = varied(scenario, task.seconds, change)
    except InvalidInput as error:
        return _without("cannot-say", f"there is no such scene: {described(error)}")
    options = _options(job, case, change)
    if options is None:
        return _without("cannot-say", "it has no solver step of a set length")
    # a start that the change has made overlap may be refused
    timed = replace(scenario, dt=case.dt, frames=len(case.samples), short=None, expects={REFUSAL: True})
    prepared = Prepared(timed, case.scene, case.samples.__getitem__)
    shown = show(replace(job, options=options), prepared, inside=False, latest=LATE)
    if shown.state != "measured":
        return _without(shown.state, shown.note, len(shown.frames))
    judged = _judged(job, change, scenario, case, shown.frames)
    return {"state": "measured", "note": "", "frames": len(shown.frames) - 1, **judged}


def _without(state: State, note: str, frames: int = 0) -> Entry:
    return {"state": state, "note": note, "frames": frames, "values": {}, "end": []}


def _options(job: Job, case: Varied, change: Variation) -> dict[str, object] | None:
    """Return options by which the solver's step is the requested one, and the preset's lengths are of a world of that size, from
    the values that the preset sets in this very scene; None for an engine that has no such step."""
    if change.step == 1.0 and change.scale == 1.0:
        return {}
    try:
        with closing(opened(job.engine)) as engine:
            engine.load(case.scene, job.settings(engine), case.dt)
            run = engine.settings_as_run()
    except Exception:
        # the run finds it again
        return {}
    numbers = {name: value[0] if isinstance(value := run[name], tuple) else value for name in (STEP, *LENGTHS) if name in run}
    options: dict[str, object] = {}
    for name in LENGTHS if change.scale != 1.0 else ():
        if isinstance(length := numbers.get(name), float) and length > 0.0:
            options[name] = change.scale * length
    if change.step == 1.0:
        return options
    step = numbers.get(STEP)
    return {**options, STEP: change.step * step} if isinstance(step, float) else None


def _judged(
    job: Job, change: Variation, scenario: Scenario, case: Varied, frames: list[FrameRecord],
) -> dict[str, object]:
    """Return figures and end of a run that came to its end, brought back to where the case is."""
    samples = [case.scene.first_sample, *case.samples]
    recording = change.elsewhere.back(gathered(job, scenario, case.scene, samples, frames, {}))
    values: dict[str, float] = {"not_finite_frames": _value(not_finite(recording)["not_finite_frames"])}
    if values["not_finite_frames"]:
        return {"values": values, "end": []}
    values["residual_overlap_max"] = float(np.max(_depths(case, recording)))
    values["energy_added_max"] = _value(energy(recording, case.here).get("energy_added_max", math.nan))
    values["wrong_side_frames"] = _value(wrong_side(recording, scenario, case.here).get("wrong_side_frames", 0.0))
    moving = [k for k, role in enumerate(case.here.roles) if role.name != "FIXED"]
    return {"values": values, "end": recording.positions[-1, moving].tolist()}


def _depths(case: Varied, recording: Recording) -> Array:
    chosen = np.unique(np.linspace(0, recording.frames, min(JUDGED, recording.frames + 1)).round().astype(int))
    return Judge(case.here).depths(recording.positions[chosen], recording.orientations[chosen])


def _value(value: object) -> float:
    """Return a figure, nan for one that is missing."""
    return float(value) if isinstance(value, int | float) else math.nan
