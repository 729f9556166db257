"""Tasks side by side: in processes that go on where the engine leaves nothing behind, otherwise each in one of its own."""

from collections.abc import Iterator, Sequence

from avatarsim.running.processes import Died, Workers
from scenarios.engines import TIDY
from scenarios.running.processes import side_by_side
from scenarios.stability.outcome import CRASHED, LATE, TOO_LATE, Outcome, Task, outcome

PATIENCE = 3.0 * LATE
"""Longest [s] without an answer: an engine that never comes back from a frame is an endless loop."""


def answers(tasks: Sequence[Task], workers: Workers) -> Iterator[tuple[Task, Outcome]]:
    """All tasks, in the order in which they end; with 0 workers here, one after the other. A process that dies costs its task."""
    for task, answer in side_by_side(outcome, tasks, workers, leaves_nothing, PATIENCE):
        yield task, died(answer) if isinstance(answer, Died) else answer


def died(how: Died) -> Outcome:
    """What a process that ended without an answer stands for."""
    return Outcome(TOO_LATE if "no answer" in str(how) else CRASHED, note=str(how))


def leaves_nothing(task: Task) -> bool:
    """Whether the next task may have this one's process."""
    return task.engine in TIDY
