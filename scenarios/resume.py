"""Going on with an earlier run: which folders are one, and how a run that somebody stops says where it can go on."""

import json
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import NoReturn

from avatarsim.errors import InvalidFile, InvalidInput
from scenarios.results import SCHEMA_VERSION


def earlier_run(folder: Path, command: str) -> Path:
    """`folder`, resolved, once it has proved to be a run of `command` that this harness wrote.

    Raises InvalidInput or InvalidFile: files are written there, and nobody's own folder may be taken for a run."""
    if not folder.is_dir():
        raise InvalidInput("--resume", str(folder), "the folder of an earlier run")
    path = folder / "results.json"
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else "not JSON"
        raise InvalidInput("--resume", str(folder), f"the folder of an earlier run, with its results.json ({why})") from error
    version = found.get("schema_version") if isinstance(found, dict) else None
    if version != SCHEMA_VERSION:
        raise InvalidFile(f"schema_version of {path}", version, f"{SCHEMA_VERSION}; run again")
    origin = found.get("provenance")
    words = str(origin.get("command", "")).split() if isinstance(origin, dict) else []
    # python -m scenarios COMMAND ...
    wrote = words[3] if words[:3] == ["python", "-m", "scenarios"] and len(words) > 3 else None
    if wrote != command:
        raise InvalidInput("--resume", str(folder), f"a run of the same command, {command}; this one was written by {wrote}")
    return folder.resolve()


@contextmanager
def stoppable() -> Iterator[None]:
    """A request to end (SIGTERM) is taken like Ctrl-C: what was finished is kept, and children are ended."""

    def stop(number: int, frame: FrameType | None) -> NoReturn:
        raise KeyboardInterrupt

    try:
        before = signal.signal(signal.SIGTERM, stop)
    except ValueError:
        # not the main thread, which alone hears of signals
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def how_to_go_on(folder: Path) -> str:
    """One sentence for whoever stopped a run."""
    return f"stopped; what was finished is kept, and the same command with `--resume {folder}` goes on from there"
