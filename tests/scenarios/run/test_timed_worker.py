"""A worker process loads and runs in two steps, keeps nothing of the job before, and ends when it is told to between them."""

import pytest

from scenarios.job import Job
from scenarios.run.timed_worker import TimedWorker, repeat

BALL, ZENO = Job("ball_drop", "avatarsim", "default", frames=12), Job("zeno", "avatarsim", "default", frames=7)


def run(worker: TimedWorker, job: Job, frames: int) -> tuple[list[int], str]:
    worker.prepare(job, frames)
    loaded = worker.answer()
    assert not isinstance(loaded, str) and loaded[0] > 0.0 and loaded[1] is None
    worker.start()
    ran = worker.answer()
    assert not isinstance(ran, str) and ran[0] > 0.0 and ran[1] is not None
    around, stages, last = ran[1]
    assert all(len(spent) == len(around) for spent in stages.values()) and min(around) > 0
    return around, last


def test_each_repeat_is_a_fresh_load_whatever_ran_before() -> None:
    worker = TimedWorker()
    found = [run(worker, job, frames) for job, frames in ((BALL, 12), (BALL, 12), (ZENO, 7), (BALL, 5), (BALL, 100))]
    worker.close()
    assert [len(around) for around, _ in found] == [12, 12, 7, 5, 12]
    lasts = [last for _, last in found]
    assert lasts[0] == lasts[1] == lasts[4] == repeat(BALL, 12)[2]
    assert lasts[2] == repeat(ZENO, 7)[2] and lasts[3] == repeat(BALL, 5)[2] != lasts[0]


@pytest.mark.parametrize("prepared", [False, True])
def test_it_leaves_when_told_to_even_with_something_loaded(prepared: bool) -> None:
    worker = TimedWorker()
    if prepared:
        worker.prepare(BALL, 5)
        assert not isinstance(worker.answer(), str)
    worker.close()
    assert worker.child.exitcode == 0
