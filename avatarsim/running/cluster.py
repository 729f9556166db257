"""Jobs on the machines of a Dask cluster: its scheduler hands each to a worker, which runs it as it is run here.

https://distributed.dask.org. A worker gives each job a process of its own, on one thread and with the same time limit, so that a
job that dies ends neither the worker nor another job. A worker has to run the same sources with the same packages, and to see the
folder that jobs write into under the same path.
"""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from avatarsim.errors import InvalidInput, MissingPackage
from avatarsim.running.processes import PRELOADED, Answer, Died, Task, side_by_side

ANSWERS_WITHIN = 10.0
"""Longest [s] to wait for a scheduler."""
OPTION = "--scheduler"
START = "`python -m dask worker ADDRESS --no-nanny --nthreads JOBS` in a checkout"
"""How a worker is started, whose threads are the jobs that it has at a time."""


def there(
    task: Task, function: Callable[[Task], Answer], patience: float, code: Callable[[], str], wanted: str, preload: Sequence[str]
) -> Answer | Died:
    """What a worker does with a task. One that joined late has not been asked before what it runs. Raises RuntimeError for other
    sources, an error that can travel."""
    if code() != wanted:
        raise RuntimeError(f"a worker runs other sources, {code()} in place of {wanted}")
    [(_, answer)] = side_by_side(function, [task], 1, patience=patience, preload=preload)
    return answer


@dataclass(frozen=True)
class Cluster:
    """The cluster of the scheduler at `address`.

    code     a function of a module: the hash of the sources that a process runs
    about    one that can be pickled: what a process runs and sees, with "daemon", whether it may start no processes, and "cpu"
    same     entries of `about` in which a worker has to agree with this process
    preload  modules that processes of jobs have loaded"""

    address: str
    code: Callable[[], str]
    about: Callable[[], Mapping[str, object]]
    same: tuple[str, ...]
    preload: tuple[str, ...] = PRELOADED

    def results(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task], patience: float
    ) -> Iterator[tuple[Task, Answer | Died]]:
        """Each task with its answer, or how it died, in the order in which they end. Where the loop is left early, what has not
        begun is called off; what runs goes on to its end or its time limit, and is not heard. Raises InvalidInput where no
        scheduler answers, a worker runs something else or the cluster goes, MissingPackage without distributed."""
        try:
            from distributed import Client, as_completed
        except ImportError as error:
            raise MissingPackage("distributed", "cluster", OPTION) from error
        try:
            client = Client(self.address, timeout=ANSWERS_WITHIN, set_as_default=False)
        except (OSError, ValueError) as error:
            raise InvalidInput(OPTION, self.address, f"the address of a Dask scheduler that answers ({error})") from error
        with client:
            self.require_same(self.about(), client.run(self.about, on_error="return"))
            # twice the same task is asked twice
            wanted = self.code()
            work = partial(there, function=function, patience=patience, code=self.code, wanted=wanted, preload=self.preload)
            running = dict(zip(client.map(work, tasks, pure=False), tasks, strict=True))
            try:
                for future in as_completed(list(running), loop=client.loop):
                    yield running.pop(future), self._answer(future)
            finally:
                client.cancel(list(running))

    def _answer(self, future: Any) -> Any:
        """The answer of a task that is over. A job that died has one, so that without there is something wrong with the cluster,
        and that is no result of an engine's."""
        if future.status == "finished":
            return future.result()
        why = future.exception() if future.status == "error" else future.status
        valid = f"a cluster that stays ({type(why).__name__}: {why}); what was finished is kept to go on from"
        raise InvalidInput(OPTION, self.address, valid)

    def require_same(self, here: Mapping[str, object], found: Mapping[str, Any]) -> None:
        """Raise InvalidInput for a cluster without workers, or with one whose figures would not be those of this command."""
        if not found:
            raise InvalidInput(OPTION, self.address, f"a scheduler with workers: {START}")
        for worker, told in found.items():
            if isinstance(told, BaseException):
                raise InvalidInput(OPTION, self.address, f"workers that know this project ({worker}: {told}): {START}")
            if told["daemon"]:
                raise InvalidInput(OPTION, self.address, f"workers that may start processes, which {worker} may not: {START}")
            for name in self.same:
                if told[name] != here[name]:
                    valid = f"workers of the same {name}: {worker} has {told[name]}, this command {here[name]}"
                    raise InvalidInput(OPTION, self.address, valid)
            if told["cpu"] != here["cpu"]:
                print(f"{worker} has another processor, {told['cpu']}: last bits may differ", file=sys.stderr)
