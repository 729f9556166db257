"""Doors that do what none may: crash, hang, fill memory, raise untyped errors. A campaign that misses one is worth nothing."""

import os
import signal
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from tests.hostile.doors import Case, Door, Unsound

BAD = 2
"""The case of each door that does it; those before and after are well."""


def cases(deed: Callable[[], object], seed: int, count: int, folder: Path) -> Iterator[Case]:
    """Cases of which one is bad."""
    for k in range(count):
        yield Case(f"case {k}", deed if k == BAD else int)


def crashes() -> object:
    """End the process as native code does that writes where it may not."""
    os.kill(os.getpid(), signal.SIGSEGV)
    return None


def hangs() -> object:
    """Never answer, nor hear the alarm, as a loop in native code."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGALRM})
    signal.pause()
    return None


def fills_memory() -> object:
    """Ask for more than is allowed."""
    return bytearray(3 * 2**30)


def raises() -> object:
    """What a reader's author did not think of."""
    return {}["key"]


def shows_nan() -> object:
    """An answer that is none."""
    raise Unsound("time is nan")


def ends() -> object:
    """End the process in the middle of a batch without a word."""
    os._exit(7)


DEEDS = {
    "bad crash": crashes, "bad hang": hangs, "bad memory": fills_memory, "bad words": raises, "bad nan": shows_nan,
    "bad end": ends,
}
"""What each does."""


def doors() -> dict[str, Door]:
    """All of them, by name."""
    return {name: Door(name, 1.0, partial(cases, deed)) for name, deed in DEEDS.items()}
