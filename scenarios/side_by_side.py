"""Tasks dealt out to as many children as there are processors, each in a process of its own."""

import multiprocessing
import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from avatarsim.errors import MissingPackage
from scenarios.processes import Died, Pool, one_thread

Task = TypeVar("Task")
Answer = TypeVar("Answer")


def _one(function: Callable[[Task], Answer], task: Task) -> tuple[Task, Answer | Died]:
    """One task in a child of its own: an engine that dies takes nobody along, and one that leaks leaks into nothing."""
    return next(Pool(function, 1).results([task]))


def side_by_side(
    function: Callable[[Task], Answer], tasks: Sequence[Task], workers: int
) -> Iterator[tuple[Task, Answer | Died]]:
    """Each task with its answer, or how it died, in the order in which they end; with 0 workers here, one after the other.

    joblib deals the tasks out (threads that wait for children, unless somebody chose another backend for it). When somebody stops
    the loop, what still runs is ended.
    """
    if workers == 0:
        for task in tasks:
            yield task, function(task)
        return
    try:
        from joblib import Parallel, delayed
    except ImportError as error:
        raise MissingPackage("joblib", "parallel", "more than one run side by side (--jobs)") from error
    before = set(multiprocessing.active_children())
    # set once here: the threads that start children would otherwise take turns in setting it back
    with one_thread():
        answers = Parallel(n_jobs=workers, prefer="threads", return_as="generator_unordered")(
            delayed(_one)(function, task) for task in tasks
        )
        ended = False
        try:
            # not `yield from`, which would hand an early end on before the children are ended
            while (answer := next(answers, None)) is not None:
                yield answer
            ended = True
        finally:
            if not ended:
                for child in set(multiprocessing.active_children()) - before:
                    child.terminate()
                with warnings.catch_warnings():
                    # joblib finds it a pity that answers go to waste
                    warnings.simplefilter("ignore", UserWarning)
                    answers.close()
