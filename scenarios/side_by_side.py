"""Tasks dealt out to as many children as there are processors, each in a process of its own."""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from avatarsim.errors import InvalidInput
from scenarios.processes import Died, Pool, alone

Task = TypeVar("Task")
Answer = TypeVar("Answer")


def side_by_side(
    function: Callable[[Task], Answer], tasks: Sequence[Task], workers: int, tidy: Callable[[Task], bool] = alone
) -> Iterator[tuple[Task, Answer | Died]]:
    """Each task with its answer, or how it died, in the order in which they end; with 0 workers here, one after the other.
    Tasks of which `tidy` says that they leave nothing behind share processes.

    When somebody stops the loop, what still runs is ended. Raises InvalidInput for fewer workers than none.
    """
    if workers < 0:
        raise InvalidInput("--jobs", workers, "0 at least")
    if workers == 0:
        yield from ((task, function(task)) for task in tasks)
    else:
        # from one thread: where two look after children, either may read how the other's ended, which can be read but once
        yield from Pool(function, workers, tidy=tidy).results(tasks)
