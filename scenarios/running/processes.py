"""Worker processes: each job in one of its own, as many side by side as processors; one that dies takes no other along."""

import gc
import multiprocessing
import os
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import TYPE_CHECKING, Generic, TypeVar

from avatarsim.errors import InvalidInput

if TYPE_CHECKING:
    from multiprocessing.context import ForkServerContext, SpawnContext

Task = TypeVar("Task")
Answer = TypeVar("Answer")

PRELOADED = ("numpy", "numba", "scipy.spatial", "scenarios.running.preloaded")
"""What the mother of all children imports once. No engine is among it, so that each child begins with a fresh one."""
PATIENCE = 1800.0
"""Longest a job may take [s] before it counts as crashed; an endless loop in an engine must end somewhere."""
LAST_WORDS = 30.0
"""Longest [s] to wait for how a child ended once its connection has; shorter, and a busy machine would leave that untold."""
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Set to 1 in every child: as many jobs as processors run side by side, and the timing pass promises one thread."""


class Died(Exception):
    """A child ended without an answer; the text says how."""


def context() -> "ForkServerContext | SpawnContext":
    """Children forked from a clean, small process where the system can (10 ms each), else started anew (0.6 s each)."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    server = multiprocessing.get_context("forkserver")
    server.set_forkserver_preload(list(PRELOADED))
    return server


@contextmanager
def one_thread() -> Iterator[None]:
    """The environment that children inherit, for the time in which they are started."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextmanager
def deaf() -> Iterator[None]:
    """No Ctrl-C while children are started, who inherit it: the terminal sends it to all, and only the parent may answer it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # it would lift the block if it were started within
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        # what came meanwhile reaches the parent here
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def begin(target: Callable[..., None], *arguments: object) -> tuple[BaseProcess, Connection]:
    """Start `target(connection, *arguments)` in a process of its own; returns it and this end of the connection."""
    here, there = multiprocessing.Pipe()
    with one_thread(), deaf():
        child = context().Process(target=target, args=(there, *arguments), daemon=True)
        child.start()
    there.close()
    return child, here


def spare_the_collector() -> None:
    """Keep Python's collector away from what the mother of this child loaded, and nobody here can free: going through all of it
    again and again is a seventh of what a short run costs, and would count as time of whichever engine runs just then."""
    gc.freeze()


def quiet() -> None:
    """Drop what this process prints: some engines greet from C on import, and tables belong to the parent. Errors stay.

    Ctrl-C is left to the parent, which ends its children itself."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.stdout.flush()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)


def ended(child: BaseProcess) -> str:
    """How a child that gave no answer came to its end."""
    child.join(timeout=LAST_WORDS)
    code = child.exitcode
    if code is None:
        child.kill()
        return f"its process left without an answer, and had not ended {LAST_WORDS:g} s later"
    return f"its process was killed by signal {-code}" if code < 0 else f"its process ended with code {code}"


def _work(connection: Connection, function: Callable[[Task], Answer]) -> None:
    """Life of a child: one task after another for as long as it is told to stay, and none after a fault."""
    quiet()
    spare_the_collector()
    stays = True
    while stays:
        try:
            task, stays = connection.recv()
        except (EOFError, ConnectionError):
            # the parent needs no more
            return
        said: tuple[str, object]
        try:
            said = "answer", function(task)
        except Exception as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            said, stays = ("raised", f"{type(error).__name__}: {error} (line {where.lineno} of {where.name})"), False
        try:
            connection.send(said)
        except ConnectionError:
            # the parent has gone, and nobody is left to tell
            return
        except Exception as error:
            with suppress(ConnectionError):
                connection.send(("raised", f"{type(error).__name__}: {error} (its answer cannot travel)"))
            return


def alone(task: object) -> bool:
    """Every task has a process of its own."""
    return False


Child = tuple[BaseProcess, Connection]


class Pool(Generic[Task, Answer]):
    """Runs `function` on tasks, at most `workers` at a time, each in a process of its own; those of which `tidy` says that they
    leave nothing behind share a few."""

    def __init__(self, function: Callable[[Task], Answer], workers: int, patience: float = PATIENCE,
                 tidy: Callable[[Task], bool] = alone) -> None:
        self.function, self.workers, self.patience, self.tidy = function, workers, patience, tidy

    def results(self, tasks: Iterable[Task]) -> Iterator[tuple[Task, Answer | Died]]:
        """Each task with its answer, or with how it died, in the order in which they end."""
        waiting = list(tasks)
        running: dict[Connection, tuple[Task, BaseProcess, float]] = {}
        idle: list[Child] = []
        try:
            while waiting or running:
                while waiting and len(running) < self.workers:
                    task = waiting.pop(0)
                    stays = self.tidy(task)
                    child, connection = idle.pop() if stays and idle else begin(_work, self.function)
                    with suppress(ConnectionError):
                        # one that has died meanwhile is heard of below
                        connection.send((task, stays))
                    running[connection] = (task, child, time.monotonic())
                ready = [end for end in wait(list(running), timeout=1.0) if isinstance(end, Connection)]
                late = [end for end, (_, _, since) in running.items() if time.monotonic() - since > self.patience]
                for connection in ready or late:
                    task, child, _ = running.pop(connection)
                    answer = self._answer(connection, child)
                    if self.tidy(task) and not isinstance(answer, Died):
                        idle.append((child, connection))
                    else:
                        connection.close()
                        child.join()
                    yield task, answer
        finally:
            for connection, (_, child, _) in running.items():
                child.terminate()
                child.join()
                connection.close()
            for child, connection in idle:
                # the end of its connection is the end of its work
                connection.close()
                child.join()

    def _answer(self, connection: Connection, child: BaseProcess) -> Answer | Died:
        try:
            if not connection.poll():
                child.kill()
                return Died(f"no answer within {self.patience:g} s")
            kind, answer = connection.recv()
        except (EOFError, ConnectionError):
            return Died(ended(child))
        return answer if kind == "answer" else Died(str(answer))


def side_by_side(
    function: Callable[[Task], Answer], tasks: Sequence[Task], workers: int, tidy: Callable[[Task], bool] = alone
) -> Iterator[tuple[Task, Answer | Died]]:
    """Each task with its answer, or how it died, in the order in which they end; with 0 workers here, one after the other.
    Tasks of which `tidy` says that they leave nothing behind share processes.

    When the loop is stopped, what still runs is ended. Raises InvalidInput for fewer workers than none.
    """
    if workers < 0:
        raise InvalidInput("--jobs", workers, "0 at least")
    if workers == 0:
        yield from ((task, function(task)) for task in tasks)
    else:
        # from one thread: where two look after children, either may read how the other's ended, which can be read but once
        yield from Pool(function, workers, tidy=tidy).results(tasks)
