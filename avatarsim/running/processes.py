"""Process isolation of jobs by Pebble: each in a fresh process with a time limit, as many side by side as processors.

https://pebble.readthedocs.io. A job that crashes, hangs or is killed is that job's result and no other's: its answer has a pipe
of its own. Tidy jobs follow each other in processes that stay, pools of one worker each: the workers of a larger pool share a
pipe and its lock, which a worker that is killed while it sends would take along. Beside Pebble stand here the fork server that
processes come from, and that the end of each process is read once.
"""

import gc
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from itertools import count, islice
from multiprocessing import active_children, forkserver, popen_forkserver, resource_tracker
from multiprocessing.context import ForkServerContext, ForkServerProcess
from multiprocessing.process import BaseProcess
from typing import TYPE_CHECKING, Any, TypeVar, Union

from pebble import ProcessExpired, ProcessPool, concurrent

from avatarsim.errors import InvalidInput, described, ended_by

if TYPE_CHECKING:
    from avatarsim.running.cluster import Cluster

Task = TypeVar("Task")
Answer = TypeVar("Answer")
Workers = Union[int, "Cluster"]
"""So many processes side by side, or the machines of a cluster."""

PRELOADED = ("numpy", "numba", "scipy.spatial")
"""What the fork server imports once, unless a caller asks for more. No engine is among it: each begins with a fresh one."""
PATIENCE = 1800.0
"""Longest a job may take [s] before it counts as crashed; an endless loop in an engine must end somewhere."""
LOOK = 1.0
"""Time [s] after which it is looked for pools that have given up, while no job ends."""
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Set to 1 in every worker: as many jobs as processors run side by side, and the timing pass promises one thread."""
_numbers, _starting = count(), threading.Lock()


class Died(Exception):
    """A job ended without an answer; the text says how."""


class Told(popen_forkserver.Popen):
    """A process whose end is read by one thread at a time. The fork server tells it once, each start of a process asks after all
    others, and Pebble has a thread for each: without this, one end in seventy would be told as code 255."""

    def __init__(self, process: BaseProcess) -> None:
        self.asking = threading.Lock()
        super().__init__(process)

    def poll(self, flag: int = os.WNOHANG) -> int | None:
        """The exit code, once there is one."""
        with self.asking:
            return super().poll(flag)


class Forked(ForkServerProcess):
    """A process of the fork server."""

    @staticmethod
    def _Popen(process_obj: BaseProcess) -> Told:
        return Told(process_obj)


class Forking(ForkServerContext):
    """What processes are started by."""

    Process = Forked


def context(preload: Sequence[str] = PRELOADED) -> Forking:
    """Processes forked from a clean, small one that has loaded the modules `preload` (10 ms each, in place of 0.6 s): a process
    has one such server, so that the first call decides. It runs on one thread, and is deaf to Ctrl-C, which a terminal sends to
    all and the parent alone answers; both are inherited."""
    forking = Forking()
    forking.set_forkserver_preload(list(preload))
    with _starting:
        # started within, it would lift the block
        resource_tracker.ensure_running()
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        kept = {name: os.environ[name] for name in THREADS if name in os.environ}
        os.environ.update(dict.fromkeys(THREADS, "1"))
        try:
            forkserver.ensure_running()
        finally:
            for name in THREADS:
                del os.environ[name]
            os.environ.update(kept)
            # what came meanwhile reaches the parent here
            signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
    return forking


def settled() -> None:
    """What each process begins with. What it prints is dropped: some engines greet from C on import, and tables belong to the
    parent; errors stay. Ctrl-C is the parent's. Python's collector is kept away from what the fork server loaded: going through
    all of it again and again is a seventh of what a short run costs, and would count as time of the engine."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.stdout.flush()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)
    gc.freeze()


def attempt(function: Callable[[Task], Answer], task: Task) -> Answer | Died:
    """The answer, or what was raised, in words: an exception of an engine's own class need not travel."""
    try:
        return function(task)
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        return Died(f"{described(error)} (line {where.lineno} of {where.name})")


def only(function: Callable[[Task], Answer], task: Task) -> Answer | Died:
    """The life of a process that has one job."""
    settled()
    return attempt(function, task)


def heard(future: Future[Any], patience: float) -> Any:
    """The answer of a job that is over, or how it died."""
    error = future.exception() if future.done() else RuntimeError("its process gave up before it had begun")
    if isinstance(error, ProcessExpired):
        return Died(f"its process {ended_by(error.exitcode)}")
    if isinstance(error, TimeoutError):
        return Died(f"no answer within {patience:g} s")
    return future.result() if error is None else Died(described(error))


def stopped(pools: Sequence[ProcessPool]) -> None:
    """End their processes, in the middle of their work if need be."""
    for pool in pools:
        pool.stop()
    for pool in pools:
        pool.join()


def alone(task: object) -> bool:
    """Every task has a process of its own."""
    return False


def side_by_side(
    function: Callable[[Task], Answer], tasks: Sequence[Task], workers: Workers, tidy: Callable[[Task], bool] = alone,
    patience: float = PATIENCE, preload: Sequence[str] = PRELOADED,
) -> Iterator[tuple[Task, Answer | Died]]:
    """Each task with its answer, or how it died, in the order in which they end; with 0 workers here, one after the other; on a
    cluster, each in a process of its own.

    Tasks of which `tidy` says that they leave nothing behind share processes, each until one of its tasks fails. No task takes
    longer than `patience` [s]. Processes have the modules `preload` loaded. Where the loop is left early, what still runs is
    ended. Raises InvalidInput for fewer workers than none.
    """
    if not isinstance(workers, int):
        yield from workers.results(function, tasks, patience)
        return
    if workers < 0:
        raise InvalidInput("number of workers", workers, "0 at least")
    if workers == 0:
        yield from ((task, function(task)) for task in tasks)
        return
    waiting, name, forking = iter(tasks), f"jobs-{next(_numbers)}", context(preload)
    # the overloads say mp_context, what they stand for takes context
    fresh = concurrent.process(name=name, timeout=patience, context=forking)(only)  # type: ignore[call-overload]
    running: dict[Future[Any], tuple[Task, ProcessPool | None]] = {}
    idle: list[ProcessPool] = []
    try:
        while True:
            idle = [pool for pool in idle if pool.active]
            for task in islice(waiting, workers - len(running)):
                if tidy(task):
                    pool = idle.pop() if idle else ProcessPool(1, initializer=settled, context=forking)
                    running[pool.schedule(attempt, (function, task), timeout=patience)] = task, pool
                else:
                    running[fresh(function, task)] = task, None
            if not running:
                return
            done, _ = wait(running, LOOK, FIRST_COMPLETED)
            for future in done or [each for each, (_, pool) in running.items() if pool and not pool.active]:
                task, stays = running.pop(future)
                answer = heard(future, patience)
                if stays and isinstance(answer, Died):
                    stopped([stays])
                elif stays:
                    idle.append(stays)
                yield task, answer
    finally:
        for child in active_children():
            if child.name == name:
                # Pebble's own way to call a job off fails where its answer comes at that moment
                child.kill()
        stopped([*idle, *(stays for _, stays in running.values() if stays)])
        for thread in threading.enumerate():
            if thread.name == name:
                # it is over once its process is
                thread.join()
