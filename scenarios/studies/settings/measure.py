"""The errors of one cell: the part that is kept, and why a figure is none."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from scenarios.job import Job, Outcome
from scenarios.measure.value import Missing
from scenarios.run.accuracy import accuracy
from scenarios.studies.checkpoint import Entry

JUDGED = 50
"""Snapshots inside frames that are judged: shown overlaps count as error, and hundreds of cells are measured."""


def errors(job: Job) -> Entry:
    """Run and measure one job; the recording, which can be large, is not kept."""
    with tempfile.TemporaryDirectory(prefix="sweep-") as folder:
        return entry_of(accuracy(job, Path(folder), JUDGED))


def entry_of(outcome: Outcome) -> Entry:
    """Return the kept part of an outcome: its state, why, and all figures; `missing` gives why a figure is none. `step` is the
    engine's own time step [s], None where it has none; `resting` of every frame whether nothing moves in it."""
    values = {name: value for name, value in outcome.values.items() if not isinstance(value, Missing)}
    missing = {name: value.reason for name, value in outcome.values.items() if isinstance(value, Missing)}
    return {
        "run": outcome.job.run, "scenario": outcome.job.scenario, "state": outcome.state, "note": outcome.note,
        "frames": outcome.frames, "values": values, "missing": missing, "unsupported": outcome.about.get("unsupported", {}),
        "step": step_of(outcome), "resting": [int(rests) for rests in outcome.resting],
    }


def step_of(outcome: Outcome) -> float | None:
    """Return the time step [s] that the engine reports; None where it reports none."""
    step = number_of(outcome, "dt")
    return step if step is not None and step > 0.0 else None


def number_of(outcome: Outcome, name: str) -> float | None:
    """Return a setting that the engine reports, if it is a number."""
    settings = outcome.about.get("settings")
    entry = settings.get(name) if isinstance(settings, Mapping) else None
    value = entry[0] if isinstance(entry, list | tuple) else entry
    return float(value) if isinstance(value, int | float) else None

