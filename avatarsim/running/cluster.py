"""Jobs on the machines of a Dask cluster: its scheduler hands each to a worker, which runs it as it is run here.

https://distributed.dask.org. A worker gives each job a process of its own, on one thread and with the same time limit, so that a
job that dies ends neither the worker nor another job. A worker has to run the same sources with the same packages, and to see the
folder that jobs write into under the same path.
"""

import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from types import TracebackType
from typing import Any, Self

from avatarsim.errors import InvalidInput, MissingPackage
from avatarsim.running.processes import PRELOADED, Answer, Died, Task, side_by_side

ANSWERS_WITHIN = 10.0
"""Longest [s] to wait for a scheduler."""
LOOK_EVERY, SAY_EVERY = 5.0, 60.0
"""Time [s] between two looks at the workers while jobs run, and between two lines that say that there is none."""
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


def lost_said(worker: str) -> str:
    """A sentence about a worker that was lost."""
    return f"worker {worker} was lost while jobs ran; another one did its jobs again"


class Watch:
    """Watch the workers of a cluster while jobs run: print a line a minute while there is none, and find those that were lost.

    seen  workers that were there at a look"""

    def __init__(self, client: Any, address: str, workers: Iterable[str]) -> None:
        self.client, self.address, self.seen = client, address, set(workers)
        self.over = threading.Event()
        self.thread = threading.Thread(target=self._watch, name="workers", daemon=True)

    def __enter__(self) -> Self:
        self.thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.over.set()
        # a scheduler that has gone may leave the last look without an answer
        self.thread.join(LOOK_EVERY)

    def present(self) -> set[str] | None:
        """Return the workers that are there now; None where the scheduler does not answer."""
        try:
            return set(self.client.nthreads())
        except Exception:
            # whatever becomes of the scheduler, the jobs' own futures report it
            return None

    def lost(self) -> list[str]:
        """Return the workers that have been seen and are gone; none where the scheduler does not answer."""
        present = self.present()
        return [] if present is None else sorted(self.seen - present)

    def _watch(self) -> None:
        none_since, said = None, 0.0
        while not self.over.wait(min(LOOK_EVERY, SAY_EVERY)):
            present, now = self.present(), time.monotonic()
            self.seen |= present or set()
            if present is None or present:
                none_since = None
            elif none_since is None or now - said >= SAY_EVERY:
                none_since, said = none_since or now, now
                waited = f" for {round((now - none_since) / 60.0)} min" if now - none_since >= 60.0 else ""
                print(f"{self.address} has no worker{waited}; jobs wait for one: {START}", file=sys.stderr, flush=True)


@dataclass(frozen=True)
class Cluster:
    """The cluster of the scheduler at `address`.

    code     a function of a module: the hash of the sources that a process runs
    about    one that can be pickled: what a process runs and sees, with "daemon", whether it may start no processes, and "cpu"
    same     entries of `about` in which a worker has to agree with this process
    preload  modules that processes of jobs have loaded
    lost     workers that went away while jobs ran; filled once these have ended"""

    address: str
    code: Callable[[], str]
    about: Callable[[], Mapping[str, object]]
    same: tuple[str, ...]
    preload: tuple[str, ...] = PRELOADED
    lost: list[str] = field(default_factory=list, compare=False)

    def results(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task], patience: float
    ) -> Iterator[tuple[Task, Answer | Died]]:
        """Each task with its answer, or how it died, in the order in which they end. Where the loop is left early, what has not
        begun is called off; what runs goes on to its end or its time limit, and is not heard. Raises InvalidInput where no
        scheduler answers, a worker runs something else or the cluster goes, MissingPackage without distributed.

        While there is no worker, a line a minute on the error stream says so; there lost workers are named at the end."""
        try:
            from distributed import Client, as_completed
        except ImportError as error:
            raise MissingPackage("distributed", "cluster", OPTION) from error
        try:
            client = Client(self.address, timeout=ANSWERS_WITHIN, set_as_default=False)
        except (OSError, ValueError) as error:
            raise InvalidInput(OPTION, self.address, f"the address of a Dask scheduler that answers ({error})") from error
        with client:
            workers = client.run(self.about, on_error="return")
            self.require_same(self.about(), workers)
            # twice the same task is asked twice
            wanted = self.code()
            work = partial(there, function=function, patience=patience, code=self.code, wanted=wanted, preload=self.preload)
            running = dict(zip(client.map(work, tasks, pure=False), tasks, strict=True))
            with Watch(client, self.address, workers) as watch:
                try:
                    for future in as_completed(list(running), loop=client.loop):
                        yield running.pop(future), self._answer(future)
                finally:
                    client.cancel(list(running))
                    self._name(watch.lost())

    def _name(self, lost: Sequence[str]) -> None:
        """Name workers that were lost."""
        self.lost.extend(lost)
        for worker in lost:
            print(lost_said(worker), file=sys.stderr, flush=True)

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
