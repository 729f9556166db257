"""Diagnostics on standard error, once per topic and process."""

import sys
from contextlib import suppress

_SAID: set[str] = set()
"""Topics of which this process has spoken."""


def say_once(topic: str, sentence: str) -> None:
    """Print `sentence` as one line on standard error, unless something was said about `topic` already."""
    if topic in _SAID:
        return
    _SAID.add(topic)
    if sys.stderr is not None:
        # The stream may be closed or full; a diagnostic must never stop what it comments on.
        with suppress(OSError, ValueError):
            print(f"avatarsim: {sentence}", file=sys.stderr, flush=True)
