"""Streams of a command: progress, diagnostics on standard error, and exit codes (POSIX and sysexits conventions).

Command lines: paths as options, and ends in an exit code and a sentence, whatever becomes of the streams.

Python alone ends with 120 or a traceback where standard output is closed or full, since it flushes after the last line of code.

Diagnostics on standard error, once per topic and process.

Progress of work that takes longer than a second, on the error stream: a bar on a terminal, a line now and then elsewhere.
"""

import os
import sys
import time
import traceback
from argparse import ArgumentTypeError
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self, TextIO

from avatarsim.errors import described

_PRINTED: set[str] = set()
"""Topics on which this process has printed a diagnostic."""


def warn_once(topic: str, sentence: str) -> None:
    """Print `sentence` as one line on standard error, unless a line on `topic` was printed before."""
    if topic in _PRINTED:
        return
    _PRINTED.add(topic)
    if sys.stderr is not None:
        # The stream may be closed or full; a diagnostic must never stop the work that it comments on.
        with suppress(OSError, ValueError):
            print(f"avatarsim: {sentence}", file=sys.stderr, flush=True)


QUIET_FOR = 1.0
"""Seconds of work before anything is printed."""
LINE_EVERY = 5.0
"""Seconds between lines where there is no terminal."""
BAR_EVERY = 0.1
"""Seconds between two drawings of the bar."""
WIDTH = 30
"""Characters of the bar."""


class Progress:
    """Progress of `name`, printed on `stream`; None prints nothing."""

    def __init__(self, name: str, stream: TextIO | None) -> None:
        self.name, self.stream = name, stream
        self.begun = time.monotonic()
        self.terminal = stream is not None and stream.isatty()
        self.next = self.begun + QUIET_FOR
        self.drawn = 0

    def __enter__(self) -> Self:
        return self

    @property
    def due(self) -> bool:
        """Return True if `step` would write anything now: for callers for which computing the progress takes long."""
        return self.stream is not None and time.monotonic() >= self.next

    def step(self, share: float, what: str) -> None:
        """Report that `share` from 0 to 1 is done, and that `what` is under way."""
        now = time.monotonic()
        if self.stream is None or now < self.next:
            return
        self.next = now + (BAR_EVERY if self.terminal else LINE_EVERY)
        text = f"{self.name} {100.0 * share:3.0f} % {now - self.begun:5.1f} s  {what}"
        if self.terminal:
            full = round(WIDTH * share)
            text = f"[{'#' * full}{'.' * (WIDTH - full)}] {text}"
            self.stream.write("\r" + text.ljust(self.drawn))
            self.drawn = len(text)
        else:
            self.stream.write(text + "\n")
        self.stream.flush()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.erase()

    def erase(self) -> None:
        """Take the bar off the terminal until the next step."""
        if self.drawn and self.stream is not None:
            self.stream.write("\r" + " " * self.drawn + "\r")
            self.stream.flush()
            self.drawn = 0


def printable(text: str) -> str:
    """Return a text from elsewhere as a terminal or a page may have it: characters that cannot be printed by their codes."""
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in text)


USAGE, UNSAID, FAULT = 2, 3, 70
"""Exit codes: wrong usage; the answer could not be computed or written; a fault of the program (EX_SOFTWARE of sysexits).
Python's own code for the last is 1, which is the answer of several commands: a bound failed, something got worse."""


def path_option(text: str) -> Path:
    """Return a path given on a command line. An empty one, as of a shell's unset variable, would mean the current folder."""
    if not text:
        raise ArgumentTypeError("an empty name; valid: the path of a folder or a file")
    return Path(text)


def lost_output() -> OSError | None:
    """Return why standard output takes nothing more; None if it does. Unwritten text is dropped, and later prints too."""
    try:
        sys.stdout.flush()
    except OSError as error:
        # the interpreter flushes the same buffer once more at its end
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
        return error
    return None


def ended(main: Callable[[], int]) -> int:
    """Return the exit code of `main`, once all it printed is written: USAGE where standard output is closed, UNSAID where it is
    full, where its reader has gone, or where memory is short, FAULT with a traceback where `main` raised an unexpected error."""
    if sys.stderr is None:
        # a file that is opened later would get its number, and with it the diagnostics of children
        sys.stderr = open(os.devnull, "w", encoding="utf-8")
    if sys.stdout is None:
        print("standard output is closed: direct it to a file, or to /dev/null", file=sys.stderr)
        return USAGE
    code, refused = UNSAID, list[str]()
    try:
        code = main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else USAGE if end.code else 0
    except BrokenPipeError:
        # `head` has read enough: nothing is wrong, and nothing is printed
        pass
    except OSError as error:
        refused.append(f"the system refused {error.filename or 'a file or a stream'}: {error.strerror or error}")
    except MemoryError as error:
        refused.append(described(error))
    except Exception:
        code = FAULT
        refused.append(traceback.format_exc().rstrip())
    lost = lost_output()
    if lost is not None:
        code = UNSAID
        refused = [] if isinstance(lost, BrokenPipeError) else [f"standard output: {lost.strerror or lost}"]
    with suppress(OSError):
        for said in refused:
            print(said, file=sys.stderr)
    return code
