"""Are settings that a user brings ones that their engine takes? Asked by loading one scene, before anything else runs."""

from collections.abc import Iterable, Sequence
from contextlib import closing, suppress
from pathlib import Path

from avatarsim.errors import InvalidInput
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.own_settings import OwnSettings
from scenarios.processes import Died, Pool

Fault = tuple[str, object, str]
"""What is wrong, the value it has, what would be valid."""


def fault(job: Job) -> Fault | None:
    """What the engine of `job` says against its settings when it loads the scene. Only what it calls invalid: whatever else goes
    wrong is a result, and the run has it."""
    # a name that nobody has, a scene that overlaps, an engine that falls over: the run says so
    with suppress(Exception), closing(opened(job.engine)) as engine:
        scenario, scene, _ = job.asked()
        try:
            engine.load(scene, job.settings(engine), scenario.dt)
        except InvalidInput as error:
            return error.thing, error.value, error.valid
    return None


def tried(rows: Iterable[OwnSettings], scene: str, path: Path, workers: int) -> None:
    """Load `scene` once with each of `rows`, which came from `path`. Raises InvalidInput with what an engine does not take."""
    jobs = [Job(scene, row.engine, row.name, base=row.base, options=row.options, frames=1) for row in rows]
    # in the order of the file, whichever answers first
    for job, found in sorted(answers(jobs, workers), key=lambda answer: jobs.index(answer[0])):
        if found is not None and not isinstance(found, Died):
            thing, value, valid = found
            raise InvalidInput(f"in [{job.engine}.{job.preset}] of {path}: {thing}", value, valid)


def answers(jobs: Sequence[Job], workers: int) -> Iterable[tuple[Job, Fault | Died | None]]:
    """Each job with what its engine says, in a process of its own unless there are to be none."""
    return [(job, fault(job)) for job in jobs] if workers == 0 else Pool(fault, workers).results(jobs)
