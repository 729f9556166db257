"""Requests to end, taken as Ctrl-C is (POSIX signals): what was finished is kept, and child processes are ended."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

ENDINGS = ("SIGTERM", "SIGHUP")
"""Requests to end beside Ctrl-C: of `kill`, and of a terminal or a connection that is closed. Not every system has both."""


@contextmanager
def stoppable() -> Iterator[None]:
    """A request to end (SIGTERM, SIGHUP) is taken like Ctrl-C: what was finished is kept, and child processes are ended. One that
    is ignored, as under `nohup`, stays ignored."""

    def stop(number: int, frame: FrameType | None) -> NoReturn:
        raise KeyboardInterrupt

    before: dict[int, Callable[[int, FrameType | None], object] | int | None] = {}
    try:
        for name in ENDINGS:
            number = getattr(signal, name, None)
            if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
                before[number] = signal.signal(number, stop)
    except ValueError:
        # not the main thread, which alone hears of signals
        yield
        return
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
