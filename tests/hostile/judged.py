"""The judgement of an answer to a hostile input: a valid result or a typed error, in time and memory; all else is a finding."""

import os
import resource
import signal
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from types import FrameType
from typing import NoReturn

from avatarsim.errors import AvatarsimError
from tests.hostile.doors import Case

SECONDS = 5.0
"""Longest that a case may keep the processor [s], its children counted."""
SILENCE = 20.0
"""Longest that it may take by the clock [s]; a case that waits for something uses no processor and never ends."""
MEMORY = 2 * 2**30
"""Bytes that a case may take in addition to those of its process at the start."""
ROOT = Path(__file__).resolve().parents[2]


class TooLong(BaseException):
    """The clock has run out; no Exception, since readers of foreign files catch all of these."""


@dataclass(frozen=True)
class Finding:
    """An answer that is none: the exception or limit, the deepest line of ours that it passed, and its words."""

    kind: str
    place: str
    said: str


class Judge:
    """Asks cases in this process, which from now on has limits; of resident memory only where libraries `reserve` more."""

    def __init__(self, reserves: bool) -> None:
        if not reserves:
            limit_memory()
        self.most = peak() + MEMORY

    def verdict(self, case: Case) -> Finding | None:
        """Ask a case; None if its answer is a result or a typed error."""
        began = sum(os.times()[:4])
        try:
            with alarm(SILENCE), redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                case.ask()
        except AvatarsimError:
            pass
        except TooLong as error:
            return Finding("no answer", place_of(error), f"nothing within {SILENCE:g} s")
        except MemoryError as error:
            return Finding("memory", place_of(error), f"more than {MEMORY / 2**30:g} GB")
        except (Exception, SystemExit, KeyboardInterrupt) as error:
            return Finding(type(error).__name__, place_of(error), str(error)[:200])
        if peak() > self.most:
            self.most = peak() + MEMORY
            return Finding("memory", "", f"more than {MEMORY / 2**30:g} GB")
        took = sum(os.times()[:4]) - began
        return Finding("slow", "", f"{took:.1f} s") if took > SECONDS else None


def peak() -> int:
    """Return most bytes that were ever resident."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def place_of(error: BaseException) -> str:
    """File and line of the deepest frame that is not the test's own; of a foreign module none is named, since they vary."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename).is_relative_to(ROOT)]
    ours = [frame for frame in frames if "tests/hostile" not in frame.filename and ".venv" not in frame.filename]
    chosen = (ours or frames)[-1] if frames else None
    return f"{Path(chosen.filename).relative_to(ROOT)}:{chosen.lineno}" if chosen else ""


@contextmanager
def alarm(seconds: float) -> Iterator[None]:
    """Raise TooLong in the main thread once so many seconds have passed."""

    def ring(number: int, frame: FrameType | None) -> NoReturn:
        raise TooLong

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def limit_memory() -> None:
    """Let this process grow by MEMORY and no more; a crash leaves no core."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    most = pages * resource.getpagesize() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
