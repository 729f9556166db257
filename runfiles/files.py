"""Files that are whole or absent: written to a temporary place, then moved, so that a killed run leaves no halves."""

import json
import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO

from avatarsim.errors import InvalidInput

OUT = Path(__file__).resolve().parent.parent / "reports" / "out"
"""Where runs go unless `--out` names another folder; ignored by git."""
COMPARE = "compare"
"""The command whose last run is the one that reports and studies are about."""


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Let `write` fill a file that takes the name `path` only once it is complete."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with temporary.open("wb") as file:
            write(file)
        os.replace(temporary, path)
    except OSError as error:
        if error.errno is not None and error.filename is None:
            # a disk that is full names no file
            error.filename = str(path)
        raise
    finally:
        temporary.unlink(missing_ok=True)


HALF = re.compile(r"\.(.+)\.([0-9]+)")
"""Name of a file that is being written: that of its place, and the process that writes it."""


def clear_halves(folder: Path) -> None:
    """Remove, in and below `folder`, files that processes were writing when they were killed; halves of a living one stay."""
    for path in folder.rglob(".*"):
        match = HALF.fullmatch(path.name)
        if match and path.is_file() and not _runs(int(match.group(2))):
            path.unlink(missing_ok=True)


def _runs(process: int) -> bool:
    """Return whether a process of that number exists, so far as the system can report."""
    if os.name != "posix":
        # where the question itself would end it
        return True
    try:
        os.kill(process, 0)
    except OSError as error:
        # any other error is that of another user's process
        return not isinstance(error, ProcessLookupError)
    except OverflowError:
        return False
    return True


def write_text(path: Path, text: str) -> None:
    """Write a text as UTF-8, whole or not at all."""
    write_whole(path, lambda file: file.write(text.encode()))


def write_json(path: Path, value: object) -> None:
    """Write strict JSON; numbers that JSON has no word for become the texts NaN, Infinity and -Infinity."""
    write_text(path, _in_lines(plain(value), DEEP) + "\n")


DEEP = 2
"""Levels of a JSON file whose members have a line each: enough for one row of a table. With more, writing takes five times as
long, since Python's quick encoder knows no line ends."""


def _in_lines(value: object, deep: int) -> str:
    """Return JSON with a line for each member of the first `deep` levels."""
    if deep and value and isinstance(value, dict):
        members = [f"{json.dumps(name, ensure_ascii=False)}: {_in_lines(member, deep - 1)}" for name, member in value.items()]
        return "{\n" + ",\n".join(members) + "\n}"
    if deep and value and isinstance(value, list):
        return "[\n" + ",\n".join(_in_lines(member, deep - 1) for member in value) + "\n]"
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def plain(value: object) -> object:
    """Return mappings, sequences and numbers as strict JSON can hold them; anything else as text."""
    if isinstance(value, float):
        # a finite number as the float that it is: most of a run's figures are
        return float(value) if math.isfinite(value) else "NaN" if value != value else f"{'-' * (value < 0.0)}Infinity"
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, Sequence):
        return [plain(item) for item in value]
    return plain(value.tolist()) if hasattr(value, "tolist") else str(value)


def run_folder(out: Path, command: str) -> Path:
    """Make a folder below `out`, named by the time and the command. Raises InvalidInput where none can be made."""
    stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
    try:
        out.mkdir(parents=True, exist_ok=True)
        for attempt in range(1000):
            folder = out / f"{stamp}-{command}{f'-{attempt}' if attempt else ''}"
            with suppress(FileExistsError):
                folder.mkdir()
                return folder
    except OSError as error:
        why = error.strerror or type(error).__name__
        raise InvalidInput("--out", str(out), f"a folder in which one can be made ({why.lower()})") from error
    raise InvalidInput("number of runs of one second", 1000, "fewer")


def latest(out: Path, command: str = COMPARE) -> Path:
    """Return the link in `out` to the last run of `command`: `latest` for a comparison, else `latest-COMMAND`.

    Studies write their files into the last comparison and reports are made of it, so that no other run may take its place."""
    return out / ("latest" if command == COMPARE else f"latest-{command}")


def last_comparison(out: Path, otherwise: str) -> Path:
    """Return the link to the last comparison in the folder `out`, or, before the first one, the sibling folder `otherwise`: a
    folder that is made in the place of the link would keep its name for ever."""
    return latest(out) if latest(out).exists() else out / otherwise


def point_latest(folder: Path, command: str = COMPARE) -> None:
    """Let the link `latest` of `command`, in the parent of `folder`, lead to it. A folder put there by hand is left alone."""
    link = latest(folder.parent, command)
    if link.exists() and not link.is_symlink():
        return
    temporary = link.with_name(f".{link.name}.{os.getpid()}")
    temporary.unlink(missing_ok=True)
    temporary.symlink_to(folder.name, target_is_directory=True)
    os.replace(temporary, link)
