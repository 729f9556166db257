"""Termination signals handled like Ctrl-C (POSIX): finished results are kept, and child processes are ended."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

ENDINGS = ("SIGTERM", "SIGHUP")
"""Signals other than Ctrl-C: of `kill`, and of a closed terminal or connection. Not every system has both."""


@contextmanager
def stoppable() -> Iterator[None]:
    """Handle SIGTERM and SIGHUP like Ctrl-C: finished results are kept, and child processes are ended.
    An ignored signal, as under `nohup`, stays ignored."""

    def stop(number: int, frame: FrameType | None) -> NoReturn:
        raise KeyboardInterrupt

    before: dict[int, Callable[[int, FrameType | None], object] | int | None] = {}
    try:
        for name in ENDINGS:
            number = getattr(signal, name, None)
            if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
                before[number] = signal.signal(number, stop)
    except ValueError:
        # not the main thread, which alone receives signals
        yield
        return
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
