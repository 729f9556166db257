"""Fake versions of both passes of a study of settings, which record their jobs."""

from collections.abc import Sequence

import numpy as np
import pytest

from scenarios.job import Job
from scenarios.measure.timing import Round, Timed
from scenarios.run.timing import Clocked
from scenarios.studies.checkpoint import Entry
from scenarios.studies.settings import clock, measure

VALUES = {"stop_distance_error_max": 1.0, "residual_overlap_max": 0.0, "course_error_max": 0.5}


class Fakes:
    """Fake passes: a timed cell takes `each` s of `time`; preset `dead` has no times; a user stops after `stop_after` jobs."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.requested: list[str] = []
        self.timed: list[str] = []
        self.time, self.each, self.dead, self.stop_after = 0.0, 0.0, "", 1000
        patch.setattr(measure, "errors", self.errors)
        patch.setattr(clock, "timed_pass", self.clock)

    def errors(self, job: Job) -> Entry:
        if len(self.requested) == self.stop_after:
            raise KeyboardInterrupt
        self.requested.append(f"{job.scenario} {job.preset}")
        return {"run": job.run, "state": "measured", "note": "", "frames": 3, "values": VALUES, "missing": {}}

    def clock(self, jobs: Sequence[Job], full: bool, plan: Sequence[Round], workers: object) -> list[Clocked]:
        self.timed += [f"{job.scenario} {job.preset}" for job in jobs]
        self.time += self.each * len(jobs)
        timed = [Timed(np.full((each.repeats, each.frames), 5000, dtype=np.int64)) for each in plan]
        return [
            Clocked(job, None, "it died") if job.preset == self.dead else Clocked(job, found)
            for job, found in zip(jobs, timed, strict=True)
        ]


@pytest.fixture
def fakes(monkeypatch: pytest.MonkeyPatch) -> Fakes:
    """Return the fakes, installed in place of both passes."""
    return Fakes(monkeypatch)
