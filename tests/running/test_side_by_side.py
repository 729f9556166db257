"""Every task gets its answer, side by side or not; a process that dies is reported, and no other answer is lost."""

import multiprocessing
import os
import signal
import threading

import pytest

from avatarsim.errors import InvalidInput
from avatarsim.running.processes import Died, side_by_side


def answer(task: int) -> int:
    if task == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    if task == 5:
        raise ValueError("five")
    return 10 * task


def killed(task: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize("workers", [1, 2])
def test_each_task_has_its_answer(workers: int) -> None:
    found = dict(side_by_side(answer, [1, 2, 3, 4, 5], workers))
    assert {task: found[task] for task in (1, 2, 4)} == {1: 10, 2: 20, 4: 40}
    assert isinstance(found[3], Died) and "signal 9" in str(found[3]) and isinstance(found[5], Died)
    assert dict(side_by_side(answer, [1, 2], 0)) == {1: 10, 2: 20}


def test_everyone_who_dies_is_told_how() -> None:
    """Threads that look after processes would lose the news of one end in seventy: each start of one asks after all others."""
    before = threading.active_count()
    for _, how in side_by_side(killed, range(24), 4):
        assert isinstance(how, Died) and "signal 9" in str(how)
    assert threading.active_count() == before


def test_who_stops_leaves_no_child_behind() -> None:
    running = side_by_side(answer, [1, 2, 4, 6, 7, 8, 9], 2)
    next(running)
    running.close()
    assert multiprocessing.active_children() == []


def test_fewer_workers_than_none_are_refused() -> None:
    with pytest.raises(InvalidInput, match="number of workers is -1"):
        list(side_by_side(answer, [1], -1))
