"""Process isolation of jobs by Pebble: each in a fresh process with a time limit, as many side by side as processors.

https://pebble.readthedocs.io. A job that crashes, hangs or is killed affects no other job: its answer has its own pipe. Tidy jobs
share persistent processes, in pools of one worker each: the workers of a larger pool share a pipe and its lock, which a worker
that is killed while it sends would block. In addition to Pebble this module has the fork server that starts the processes, and
ensures that the end of each process is read once.
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
"""Number of parallel processes, or the machines of a cluster."""

PRELOADED = ("numpy", "numba", "scipy.spatial")
"""Modules that the fork server imports once, unless a caller adds more. No engine is among them: each begins with a fresh one."""
PATIENCE = 1800.0
"""Longest time of a job [s] before it counts as crashed; an endless loop in an engine must end somewhere."""
LOOK = 1.0
"""Interval [s] of the check for failed pools while no job ends."""
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Variables set to 1 in every worker: jobs run in parallel on all processors, and the timing pass promises one thread."""
_numbers, _starting = count(), threading.Lock()


class Died(Exception):
    """A job ended without an answer; the text describes how."""


class SinglePollPopen(popen_forkserver.Popen):
    """A process whose exit code is read by one thread at a time. The fork server reports it once, each start of a process polls
    all others, and Pebble has a thread for each: without this, one exit in seventy would be reported as code 255."""

    def __init__(self, process: BaseProcess) -> None:
        self.poll_lock = threading.Lock()
        super().__init__(process)

    def poll(self, flag: int = os.WNOHANG) -> int | None:
        """Return the exit code, once there is one."""
        with self.poll_lock:
            return super().poll(flag)


class Forked(ForkServerProcess):
    """A process of the fork server."""

    @staticmethod
    def _Popen(process_obj: BaseProcess) -> SinglePollPopen:  # noqa: N802
        return SinglePollPopen(process_obj)


class Forking(ForkServerContext):
    """Context that starts processes."""

    Process = Forked


def context(preload: Sequence[str] = PRELOADED) -> Forking:
    """Return a context that forks processes from a clean server with the modules `preload` loaded, in 10 ms instead of 0.6 s.

    A process has one such server, so that the first call decides. It runs on one thread and ignores Ctrl-C, which a terminal
    sends to all processes and the parent handles; both are inherited."""
    forking = Forking()
    forking.set_forkserver_preload(list(preload))
    with _starting:
        # starting it inside would lift the block
        resource_tracker.ensure_running()
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        saved = {name: os.environ[name] for name in THREADS if name in os.environ}
        os.environ.update(dict.fromkeys(THREADS, "1"))
        try:
            forkserver.ensure_running()
        finally:
            for name in THREADS:
                del os.environ[name]
            os.environ.update(saved)
            # signals that arrived meanwhile reach the parent here
            signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
    return forking


def settled() -> None:
    """Prepare a process: no standard output, which engines print to from C on import; no Ctrl-C, which the parent handles.

    Garbage collection of the fork server's objects is off: it takes a seventh of a short run, counted as time of the engine."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.stdout.flush()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)
    gc.freeze()


def attempt(function: Callable[[Task], Answer], task: Task) -> Answer | Died:
    """Return the answer, or the exception as text: an exception of an engine's own class may not be picklable."""
    try:
        return function(task)
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        return Died(f"{described(error)} (line {where.lineno} of {where.name})")


def only(function: Callable[[Task], Answer], task: Task) -> Answer | Died:
    """Run the only job of a process."""
    settled()
    return attempt(function, task)


def heard(future: Future[Any], patience: float) -> Any:
    """Return the answer of a finished job, or how it died."""
    error = future.exception() if future.done() else RuntimeError("its process gave up before it had begun")
    if isinstance(error, ProcessExpired):
        return Died(f"its process {ended_by(error.exitcode)}")
    if isinstance(error, TimeoutError):
        return Died(f"no answer within {patience:g} s")
    return future.result() if error is None else Died(described(error))


def stopped(pools: Sequence[ProcessPool]) -> None:
    """Terminate the processes of pools, also while they work."""
    for pool in pools:
        pool.stop()
    for pool in pools:
        pool.join()


def alone(task: object) -> bool:
    """Return False: every task has its own process."""
    return False


def side_by_side(
    function: Callable[[Task], Answer], tasks: Sequence[Task], workers: Workers, tidy: Callable[[Task], bool] = alone,
    patience: float = PATIENCE, preload: Sequence[str] = PRELOADED,
) -> Iterator[tuple[Task, Answer | Died]]:
    """Yield each task with its answer, or how it died, in the order in which they end.

    With 0 workers tasks run here, one after the other; on a cluster, each in its own process. Tasks for which `tidy` is True
    leave nothing behind and share processes, each until a task fails. `patience` is the longest time per task [s]. Processes have
    the modules `preload` loaded. Leaving the loop early terminates running tasks. Raises InvalidInput for negative workers.
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
    # the overloads name mp_context, the implementation takes context
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
                # Pebble's own cancellation fails if the answer arrives at that moment
                child.kill()
        stopped([*idle, *(stays for _, stays in running.values() if stays)])
        for thread in threading.enumerate():
            if thread.name == name:
                # finished once its process has ended
                thread.join()
