"""Command lines: paths as options, and ends in an exit code and a sentence, whatever becomes of the streams.

Python alone ends with 120 or a traceback where standard output is closed or full, since it flushes after the last line of code.
"""

import os
import sys
from argparse import ArgumentTypeError
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

USAGE, UNSAID = 2, 3
"""Exit codes: wrong usage; the answer could not be written."""


def path_option(text: str) -> Path:
    """A path given on a command line. An empty one, as of a shell's variable that is not set, would mean the current folder."""
    if not text:
        raise ArgumentTypeError("an empty name; valid: the path of a folder or a file")
    return Path(text)


def lost_output() -> OSError | None:
    """Why standard output takes nothing more; None if it does. What could not be written is dropped, and later prints too."""
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
    """The exit code of `main`, once all it printed is written: USAGE where standard output is closed, UNSAID where it is full or
    where its reader has gone."""
    if sys.stderr is None:
        # a file that is opened later would get its number, and with it what children complain of
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
        # `head` has read enough: nothing is wrong, and there is nothing to say
        pass
    except OSError as error:
        refused.append(f"the system refused {error.filename or 'a file or a stream'}: {error.strerror or error}")
    lost = lost_output()
    if lost is not None:
        code = UNSAID
        refused = [] if isinstance(lost, BrokenPipeError) else [f"standard output: {lost.strerror or lost}"]
    with suppress(OSError):
        for said in refused:
            print(said, file=sys.stderr)
    return code
