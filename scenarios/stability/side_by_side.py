"""Tasks side by side: in processes that go on, or, where an engine leaks settings, a few at a time in one of their own."""

from collections.abc import Iterable, Iterator, Sequence

from avatarsim.errors import MissingPackage
from scenarios.processes import Died, Pool
from scenarios.stability.outcome import CRASHED, LATE, TOO_LATE, Outcome, Task, outcome

FRESH = ("pybullet",)
"""Engines some of whose settings outlive a world: a few trials of one case and preset in a process of its own."""
TOGETHER_IN_ONE = 8
"""Trials in such a process: to start it takes longer than most of them do."""
PATIENCE = 3.0 * LATE
"""Longest [s] without an answer: an engine that never comes back from a frame is an endless loop."""


def answered(task: Task) -> tuple[Task, Outcome]:
    """Do one task here."""
    return task, outcome(task)


def answers(tasks: Sequence[Task], jobs: int) -> Iterator[tuple[Task, Outcome]]:
    """All tasks, in the order in which they end: side by side in processes that go on, then those that want one of their own."""
    try:
        from joblib import Parallel, delayed, effective_n_jobs
    except ImportError as error:
        raise MissingPackage("joblib", "parallel", "trials side by side") from error
    shared = [task for task in tasks if task.engine not in FRESH]
    work = Parallel(n_jobs=jobs, return_as="generator_unordered", timeout=PATIENCE, batch_size=1)
    yield from map(answered, shared) if jobs == 1 else work(delayed(answered)(task) for task in shared)
    yield from in_own_processes(chunks(task for task in tasks if task.engine in FRESH), effective_n_jobs(jobs))


def chunks(tasks: Iterable[Task]) -> list[tuple[Task, ...]]:
    """Tasks of one case, engine and preset, some of them at a time."""
    groups: dict[tuple[str, str], list[Task]] = {}
    for task in tasks:
        groups.setdefault((task.case, task.run), []).append(task)
    size = TOGETHER_IN_ONE
    return [tuple(group[k : k + size]) for group in groups.values() for k in range(0, len(group), size)]


def outcomes(tasks: Sequence[Task]) -> list[Outcome]:
    """Do some tasks here, one after the other."""
    return [outcome(task) for task in tasks]


def in_own_processes(groups: Iterable[tuple[Task, ...]], workers: int) -> Iterator[tuple[Task, Outcome]]:
    """Each group in a process of its own; of one that dies, every task again by itself, so that one end does not hide others."""
    for group, answer in Pool(outcomes, workers, PATIENCE * TOGETHER_IN_ONE).results(groups):
        if not isinstance(answer, Died):
            yield from zip(group, answer, strict=True)
        elif len(group) > 1:
            yield from in_own_processes([(task,) for task in group], workers)
        else:
            yield group[0], Outcome(TOO_LATE if "no answer" in str(answer) else CRASHED, note=str(answer))
