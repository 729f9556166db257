"""One engine with one preset in one scene of the map, and what each coefficient became."""

from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError, MissingPackage
from scenarios.engines import STEPPED, opened
from scenarios.job import Job
from scenarios.law_map import worlds
from scenarios.law_map.obtained import friction, restitution
from scenarios.law_map.rows import Row, summed_up
from scenarios.run import described, gathered


def job_of(law: str, shape: str, rate: int, engine: str, preset: str) -> Job:
    """What is asked."""
    # one step per frame
    options = {"dt": 1.0 / rate} if engine in STEPPED else {}
    return Job(worlds.name_of(law, shape, rate), engine, preset, base=preset, options=options, catalogue=worlds.__name__)


def obtained(job: Job) -> list[Row]:
    """A row per coefficient; of an engine that fails, rows without figures that say so."""
    law, rest = job.scenario.split("_", 1)
    shape, rate = rest.rsplit("_", 1)
    try:
        found = _figures(job, law, shape)
    except (AvatarsimError, ArithmeticError, ValueError, RuntimeError) as error:
        if isinstance(error, MissingPackage):
            raise
        nothing = [(asked, (float("nan"),) * 3, described(error)) for asked in worlds.ASKED[law]]
        return [Row(law, shape, job.engine, job.preset, int(rate), asked, *three, note) for asked, three, note in nothing]
    return [
        Row(law, shape, job.engine, job.preset, int(rate), asked, *summed_up(found[asked])) for asked in worlds.ASKED[law]
    ]


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
