"""The errors of each cell: in a process of its own each, as many side by side as there are processors, kept as soon as found."""

import multiprocessing
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

from avatarsim.errors import MissingPackage
from scenarios.job import Job, Outcome
from scenarios.measure.value import Missing
from scenarios.processes import Died, Pool, one_thread
from scenarios.run import accuracy
from scenarios.sweep.store import Entry

Task = TypeVar("Task")
Answer = TypeVar("Answer")


def errors(job: Job) -> Entry:
    """Run and measure one job; the recording, which can be large, is not kept."""
    with tempfile.TemporaryDirectory(prefix="sweep-") as folder:
        return entry_of(accuracy(job, Path(folder)))


def entry_of(outcome: Outcome) -> Entry:
    """What is kept of an outcome: its state, why, and all figures; `missing` says why a figure is none."""
    values = {name: value for name, value in outcome.values.items() if not isinstance(value, Missing)}
    missing = {name: value.reason for name, value in outcome.values.items() if isinstance(value, Missing)}
    return {
        "run": outcome.job.run, "scenario": outcome.job.scenario, "state": outcome.state, "note": outcome.note,
        "frames": outcome.frames, "values": values, "missing": missing,
    }


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
        try:
            yield from answers
        finally:
            for child in set(multiprocessing.active_children()) - before:
                child.terminate()


def died(job: Job, how: Died) -> Entry:
    """The entry of a job whose process ended without an answer."""
    return entry_of(Outcome(job, "crashed", str(how)))


def told(pairs: Iterable[tuple[Job, Entry | Died]]) -> Iterator[tuple[Job, Entry]]:
    """The same with an entry for whoever died."""
    for job, found in pairs:
        yield job, died(job, found) if isinstance(found, Died) else found
