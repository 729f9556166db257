"""One engine with one preset in one scene of the map, and what each coefficient became."""

import math
from collections.abc import Mapping

from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError, MissingPackage, described
from scenarios.engines import STEPPED, opened
from scenarios.job import Job
from scenarios.law_map import worlds
from scenarios.law_map.obtained import friction, restitution
from scenarios.law_map.rows import Row, summed_up
from scenarios.running.run import gathered


def job_of(law: str, shape: str, rate: int, engine: str, preset: str) -> Job:
    """What is asked."""
    # one step per frame
    options = {"dt": 1.0 / rate} if engine in STEPPED else {}
    return Job(worlds.name_of(law, shape, rate), engine, preset, base=preset, options=options, catalogue=worlds.__name__)


def obtained(job: Job) -> list[Row]:
    """A row per coefficient; of an engine that fails, rows without figures that say so."""
    law, shape, _ = asked_of(job)
    try:
        found = _figures(job, law, shape)
    except (AvatarsimError, ArithmeticError, ValueError, RuntimeError) as error:
        if isinstance(error, MissingPackage):
            raise
        return without_figures(job, described(error))
    return _rows(job, {asked: summed_up(found[asked]) for asked in worlds.ASKED[law]})


def without_figures(job: Job, why: str) -> list[Row]:
    """The same rows of an engine that gave none."""
    return _rows(job, {asked: (math.nan, math.nan, math.nan, why) for asked in worlds.ASKED[asked_of(job)[0]]})


def asked_of(job: Job) -> tuple[str, str, int]:
    """Law, shape and steps per second that a job is about."""
    law, rest = job.scenario.split("_", 1)
    shape, rate = rest.rsplit("_", 1)
    return law, shape, int(rate)


def _rows(job: Job, found: Mapping[float, tuple[float, float, float, str]]) -> list[Row]:
    law, shape, rate = asked_of(job)
    return [Row(law, shape, job.engine, job.preset, rate, asked, *figures) for asked, figures in found.items()]


def _figures(job: Job, law: str, shape: str) -> dict[float, list[float]]:
    scenario, scene, motion = job.asked()
    samples = [motion(k) for k in range(scenario.frames)]
    engine = opened(job.engine)
    try:
        frames = [engine.load(scene, Settings(job.base, job.options, job.seed), scenario.dt)]
        frames += [engine.advance(sample, scenario.dt) for sample in samples]
    finally:
        engine.close()
    recording = gathered(job, scenario, scene, [scene.first_sample, *samples], frames, {})
    touch, gravity = worlds.solid_of(law, shape)[2], -scene.gravity[2]
    found: dict[float, list[float]] = {}
    for asked in worlds.ASKED[law]:
        for phase in range(worlds.PHASES):
            body = scene.names.index(worlds.body_name(asked, phase))
            height, velocity = recording.positions[:, body, 2] - touch, recording.velocities[:, body]
            if law == "restitution":
                figure = restitution(height, velocity[:, 2], gravity, scenario.dt)
            else:
                figure = friction(velocity, height, scenario.dt)
            found.setdefault(asked, []).append(figure)
    return found
