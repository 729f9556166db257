"""Every task gets its answer, side by side or not; who dies is told, and nobody else is lost."""

import os
import signal

import pytest

from scenarios.processes import Died
from scenarios.side_by_side import side_by_side


def answer(task: int) -> int:
    if task == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    if task == 5:
        raise ValueError("five")
    return 10 * task


@pytest.mark.parametrize("workers", [1, 2])
def test_each_task_has_its_answer(workers: int) -> None:
    found = dict(side_by_side(answer, [1, 2, 3, 4, 5], workers))
    assert {task: found[task] for task in (1, 2, 4)} == {1: 10, 2: 20, 4: 40}
    assert isinstance(found[3], Died) and "signal 9" in str(found[3]) and isinstance(found[5], Died)
    assert dict(side_by_side(answer, [1, 2], 0)) == {1: 10, 2: 20}


def test_who_stops_leaves_no_child_behind() -> None:
    import multiprocessing

    running = side_by_side(answer, [1, 2, 4, 6, 7, 8, 9], 2)
    next(running)
    running.close()
    # one that was just being started when the loop ended answers its task first
    for _ in range(200):
        if left := multiprocessing.active_children():
            left[0].join(0.1)
    assert multiprocessing.active_children() == []
