"""Atomic replacement of output files (temporary file in the same folder, fsync, rename), and one writer at a time (flock).

A killed command leaves no partial output file. Unfinished files lie in a temporary folder next to their place, and the next
command that uses the output folder removes it.
"""

import errno
import fcntl
import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BufferedReader
from pathlib import Path

from avatarsim.errors import InvalidInput

BEGUN, PART = ".avatarsim-", ".part"
"""Prefix and suffix of the temporary folder in which a file is written."""

BEGINNING = 4096
"""Bytes at the beginning of a file that must contain its mark."""


@contextmanager
def temporary_path(place: Path) -> Iterator[Path]:
    """Yield a path for a file that is to become `place`: same name, in a temporary folder next to it, removed at the end.

    Raises OSError where none can be made."""
    place.parent.mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(prefix=BEGUN, suffix=PART, dir=place.parent))
    try:
        yield folder / place.name
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def put(content: bytes, at: Path) -> None:
    """Write a new file and flush it to disk."""
    try:
        with at.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        # the error of a full disk has no file name
        error.filename = error.filename or str(at)
        raise


def moved(written: Path, place: Path) -> None:
    """Move a completely written file to its place, and flush the folder to disk."""
    os.replace(written, place)
    # not supported by every file system
    with suppress(OSError):
        handle = os.open(place.parent, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def write_atomically(place: Path, content: bytes) -> None:
    """Write `content` to `place` atomically: it has the old or the new bytes even after a power loss. Raises OSError."""
    with temporary_path(place) as path:
        put(content, path)
        moved(path, place)


def remove_partial_files(out: Path) -> None:
    """Remove the partial files of killed commands in and below a folder."""
    for folder, names, _ in os.walk(out):
        for name in [name for name in names if name.startswith(BEGUN) and name.endswith(PART)]:
            shutil.rmtree(Path(folder, name), ignore_errors=True)
            names.remove(name)


@contextmanager
def alone_in(out: Path) -> Iterator[None]:
    """Lock the folder `out`, made if need be, against other commands. The lock goes with the process, however that ends.

    Raises InvalidInput where another command holds the lock or no file can be written there."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        handle = os.open(out, os.O_RDONLY | os.O_DIRECTORY)
    except (OSError, ValueError) as error:
        raise InvalidInput("output folder", str(out), f"a folder that can be written to ({_why(error)})") from error
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno in (errno.EWOULDBLOCK, errno.EACCES):
                valid = "a folder that no other command is writing into; wait for it, or take another folder"
                raise InvalidInput("output folder", str(out), valid) from error
            # a file system without locks
        try:
            tempfile.TemporaryFile(dir=out).close()
        except OSError as error:
            raise InvalidInput("output folder", str(out), f"a folder that can be written to ({_why(error)})") from error
        remove_partial_files(out)
        try:
            yield
        finally:
            # of commands stopped while writing
            remove_partial_files(out)
    finally:
        os.close(handle)


def require_replaceable(place: Path, mark: str, force: bool, named: str = "") -> None:
    """Raise InvalidInput where an existing file at the place of an output does not have `mark` near its beginning.
    With `force` it may be overwritten. `named`: the place's name in the error; else its path."""
    if force or not os.path.lexists(place):
        return
    try:
        with open_nonblocking(place) as file:
            has_mark = mark.encode() in file.read(BEGINNING)
    except OSError:
        has_mark = False
    if not has_mark:
        valid = "a place without a file that something else wrote; take another folder, or --force to write over it"
        raise InvalidInput("place of a result", named or str(place), valid)


def _why(error: OSError | ValueError) -> str:
    return (getattr(error, "strerror", None) or str(error)).lower()


def open_nonblocking(path: Path) -> BufferedReader:
    """Return a file open for reading, without waiting for a writer if the name is a pipe. Raises OSError."""
    return open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK))


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal digits. Raises OSError."""
    with open_nonblocking(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
