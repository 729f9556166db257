"""The study of the contact law: every law, shape, step and engine, and rows of the result of each stated coefficient."""

import math
from collections.abc import Sequence

import numpy as np

from avatarsim.errors import AvatarsimError, described
from runfiles.engines import about
from runfiles.naming import BASELINE, GATED
from runfiles.table import Row
from scenarios.job import Job, reuses_process
from scenarios.run.accuracy import gathered, prepare, show
from scenarios.studies.checkpoint import Entry, key_of
from scenarios.studies.contact_law import worlds
from scenarios.studies.contact_law.obtained import friction, restitution
from scenarios.studies.study import Head, Request, Study, answers

NAME = "contact_law"
SHAPES, RATES = ("sphere", "box_flat"), (240, 1000)
"""Shapes and steps a second of the short form: one contact and four, a common step and a fine one."""


def jobs_of(request: Request) -> list[Job]:
    """Return every engine and preset with every law, shape and step. Of the gated engine one preset: they share one law."""
    shapes, rates = (worlds.SHAPES, worlds.RATES) if request.long else (SHAPES, RATES)
    return [
        # one step a frame
        Job(
            worlds.name_of(law, shape, rate), engine, preset, base=preset,
            options={"dt": 1.0 / rate} if about(engine).has_time_step else {}, catalogue=worlds.__name__,
        )
        for law in worlds.LAWS for shape in shapes for rate in rates for engine, presets in request.presets.items()
        for preset in (presets[:1] if engine == GATED[0] else presets) if engine != BASELINE
    ]


def obtained(job: Job) -> Entry:
    """Return the obtained value of each stated coefficient: "values", lists over bodies, phases of a step and directions."""
    law, _, _ = worlds.parts_of(job.scenario)
    try:
        prepared = prepare(job)
    except AvatarsimError as error:
        return {"state": "not-measured", "note": described(error), "values": {}}
    shown = show(job, prepared, inside=False)
    if shown.state != "measured":
        return {"state": shown.state, "note": shown.note, "values": {}}
    scene, dt = prepared.scene, prepared.scenario.dt
    recording = gathered(job, prepared.scenario, scene, prepared.states, shown.frames, {})
    touch, gravity = worlds.solid_of(law, worlds.parts_of(job.scenario)[1])[2], -scene.gravity[2]
    by_value: dict[str, list[float]] = {}
    for stated in worlds.ASKED[law]:
        for phase in range(worlds.PHASES):
            body = scene.names.index(worlds.body_name(stated, phase))
            height, velocity = recording.positions[:, body, 2] - touch, recording.velocities[:, body]
            figure = restitution(height, velocity[:, 2], gravity, dt) if law == "restitution" else friction(velocity, height, dt)
            by_value.setdefault(f"{stated:g}", []).append(figure)
    return {"state": "measured", "note": "", "values": by_value}


def ask(request: Request) -> tuple[list[Row], list[str]]:
    """Run everything, side by side, and return the rows."""
    tasks = {key_of(NAME, job): job for job in jobs_of(request)}
    entries = dict(answers(obtained, tasks, request, request.checkpoint(NAME), NAME, reuses_process))
    return [row for key, job in tasks.items() for row in rows_of(job, entries[key])], []


def rows_of(job: Job, entry: Entry) -> list[Row]:
    """Return a row for the median, lowest and highest of each coefficient."""
    law, shape, rate = worlds.parts_of(job.scenario)
    head = Head(NAME, f"{law}_{shape}", job.engine, job.preset, f"1/{rate} s")
    if entry["state"] != "measured":
        return [head.without(entry["state"], entry["note"])]
    rows = []
    for stated, values in entry["values"].items():
        middle, low, high, note = summed_up([float(value) for value in values])
        name = f"obtained_{stated}"
        rows += [head.row(name, middle, note), head.row(f"{name}_low", low), head.row(f"{name}_high", high)]
    return rows


def summed_up(values: Sequence[float]) -> tuple[float | None, float | None, float | None, str]:
    """Return median, lowest and highest of the numbers among `values`, and how many gave none."""
    usable = [value for value in values if not math.isnan(value)]
    lost = len(values) - len(usable)
    note = f"{lost} of {len(values)} bodies gave no figure" if lost else ""
    if not usable:
        return None, None, None, note
    return float(np.median(usable)), min(usable), max(usable), note


STUDY = Study(NAME, ask)
