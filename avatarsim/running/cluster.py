"""Jobs on the machines of a Dask cluster: its scheduler sends each to a worker, which runs it as it is run here.

https://distributed.dask.org. A worker runs each job in its own process, on one thread and with the same time limit, so that a
crashed job ends neither the worker nor another job. A worker has to run the same sources with the same packages, and to see the
output folder of the jobs under the same path.
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
"""Longest time to wait for a scheduler [s]."""
LOOK_EVERY, REPORT_INTERVAL = 5.0, 60.0
"""Time between two checks of the workers while jobs run, and between two messages that there is none [s]."""
OPTION = "--scheduler"
START = "`python -m dask worker ADDRESS --no-nanny --nthreads JOBS` in a checkout"
"""Command that starts a worker; its threads are the jobs that it runs at a time."""


def there(
    task: Task, function: Callable[[Task], Answer], patience: float, code: Callable[[], str], wanted: str, preload: Sequence[str]
) -> Answer | Died:
    """Run a task on a worker, after a check of its sources, since it may have joined late.
    Raises RuntimeError for other sources, an error that can be pickled."""
    if code() != wanted:
        raise RuntimeError(f"a worker runs other sources, {code()} in place of {wanted}")
    [(_, answer)] = side_by_side(function, [task], 1, patience=patience, preload=preload)
    return answer


def lost_worker_message(worker: str) -> str:
    """Return a sentence about a worker that was lost."""
    return f"worker {worker} was lost while jobs ran; another one did its jobs again"


class Watch:
    """Monitor of a cluster's workers while jobs run: prints a line a minute while there is none, and finds lost ones.

    seen  workers that were present at a check"""

    def __init__(self, client: Any, address: str, workers: Iterable[str]) -> None:
        self.client, self.address, self.seen = client, address, set(workers)
        self.over = threading.Event()
        self.thread = threading.Thread(target=self._watch, name="workers", daemon=True)

    def __enter__(self) -> Self:
        self.thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.over.set()
        # the last check may get no answer after the scheduler has gone
        self.thread.join(LOOK_EVERY)

    def present(self) -> set[str] | None:
        """Return the workers that are present; None where the scheduler does not answer."""
        try:
            return set(self.client.nthreads())
        except Exception:
            # the futures of the jobs report any failure of the scheduler
            return None

    def lost(self) -> list[str]:
        """Return the workers that were seen and are gone; none where the scheduler does not answer."""
        present = self.present()
        return [] if present is None else sorted(self.seen - present)

    def _watch(self) -> None:
        none_since, reported = None, 0.0
        while not self.over.wait(min(LOOK_EVERY, REPORT_INTERVAL)):
            present, now = self.present(), time.monotonic()
            self.seen |= present or set()
            if present is None or present:
                none_since = None
            elif none_since is None or now - reported >= REPORT_INTERVAL:
                none_since, reported = none_since or now, now
                waited = f" for {round((now - none_since) / 60.0)} min" if now - none_since >= 60.0 else ""
                print(f"{self.address} has no worker{waited}; jobs wait for one: {START}", file=sys.stderr, flush=True)


@dataclass(frozen=True)
class Cluster:
    """The cluster of the scheduler at `address`.

    code     a function of a module: the hash of the sources that a process runs
    about    one that can be pickled: environment of a process, with "daemon", whether it may start no processes, and "cpu"
    same     entries of `about` in which a worker has to agree with this process
    preload  modules that processes of jobs have loaded
    lost     workers that went away while jobs ran; filled at the end"""

    address: str
    code: Callable[[], str]
    about: Callable[[], Mapping[str, object]]
    same: tuple[str, ...]
    preload: tuple[str, ...] = PRELOADED
    lost: list[str] = field(default_factory=list, compare=False)

    def results(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task], patience: float
    ) -> Iterator[tuple[Task, Answer | Died]]:
        """Yield each task with its answer, or the error with which it died, in the order in which they end.

        If the loop is left early, jobs not yet started are cancelled; running ones go on to their end or time limit, ignored.
        While there is no worker, the error stream gets a line a minute, and in the end the lost workers. Raises InvalidInput
        where no scheduler answers, a worker differs or the cluster goes, MissingPackage without distributed."""
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
            # equal tasks are run separately
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
        """Report the names of lost workers."""
        self.lost.extend(lost)
        for worker in lost:
            print(lost_worker_message(worker), file=sys.stderr, flush=True)

    def _answer(self, future: Any) -> Any:
        """Return the answer of a finished task.
        A job that died has one too, so that a missing answer is an error of the cluster, not a result of an engine."""
        if future.status == "finished":
            return future.result()
        why = future.exception() if future.status == "error" else future.status
        valid = f"a cluster that stays ({type(why).__name__}: {why}); what was finished is kept to go on from"
        raise InvalidInput(OPTION, self.address, valid)

    def require_same(self, here: Mapping[str, object], found: Mapping[str, Any]) -> None:
        """Raise InvalidInput for a cluster without workers, or with a worker whose figures would differ from this process's."""
        if not found:
            raise InvalidInput(OPTION, self.address, f"a scheduler with workers: {START}")
        for worker, about in found.items():
            if isinstance(about, BaseException):
                raise InvalidInput(OPTION, self.address, f"workers that know this project ({worker}: {about}): {START}")
            if about["daemon"]:
                raise InvalidInput(OPTION, self.address, f"workers that may start processes, which {worker} may not: {START}")
            for name in self.same:
                if about[name] != here[name]:
                    valid = f"workers of the same {name}: {worker} has {about[name]}, this command {here[name]}"
                    raise InvalidInput(OPTION, self.address, valid)
            if about["cpu"] != here["cpu"]:
                print(f"{worker} has another processor, {about['cpu']}: last bits may differ", file=sys.stderr)
