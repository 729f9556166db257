"""Jobs of the harness side by side: as `avatarsim/running/` runs them, in processes that have the harness loaded."""

from collections.abc import Callable, Iterator, Sequence

from avatarsim.running import processes
from avatarsim.running.processes import PATIENCE, Answer, Died, Forking, Task, Workers, alone

PRELOADED = (*processes.PRELOADED, "scenarios.run.preloaded")
"""What the fork server of the harness imports once."""


def context() -> Forking:
    """What processes of the harness are started by."""
    return processes.context(PRELOADED)


def side_by_side(
    function: Callable[[Task], Answer], tasks: Sequence[Task], workers: Workers, tidy: Callable[[Task], bool] = alone,
    patience: float = PATIENCE,
) -> Iterator[tuple[Task, Answer | Died]]:
    """As `avatarsim.running.processes.side_by_side`."""
    return processes.side_by_side(function, tasks, workers, tidy, patience, PRELOADED)
