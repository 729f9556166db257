"""Files from elsewhere and cache folders: XDG Base Directory Specification, StrictModes of OpenSSH, atomic replacement.

Per-user cache folders in the order of the XDG Base Directory Specification, trusted as OpenSSH trusts its files (StrictModes).

Compiled code that is read from a cache runs. So a folder or a file counts only if its owner is this user or the administrator and
no other user may write to it. New folders get the mode 0700, which the specification asks for.

Cache entries written atomically (temporary file, fsync, rename) and checked by length and SHA-256 before they are used.

Bounded reads of regular files: kind and size are checked before a byte is read, and text that is nested too deeply is refused.

A named pipe or a device in the place of a file would be waited for, or read without end; a file of gigabytes would take the
machine's memory. Every reader of files that come from elsewhere goes through here. Errors name the file as the caller does.
"""

import errno
import hashlib
import json
import os
import stat
import struct
import tempfile
import tomllib
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

from avatarsim.console import warn_once
from avatarsim.errors import InvalidFile

VARIABLE = "AVATARSIM_CACHE_DIR"
"""Environment variable that names the first folder to look in, for all caches of this package."""

ADMINISTRATOR = 0
"""User number whose files are trusted as one's own are: it may change any file anyway, and container images belong to it."""

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
"""Mode bits by which another user can replace code that is run."""


class Distrusted(PermissionError):
    """A file or folder that another user owns or may write to."""


def bases(name: str, *variables: str) -> list[Path]:
    """Return folders called `name` for a cache to lie in, best first: below AVATARSIM_CACHE_DIR, below each of the further
    environment `variables`, XDG_CACHE_HOME, ~/.cache, and in the temporary folder one per user. None of them needs to exist."""
    named = [os.environ.get(variable, "") for variable in (VARIABLE, *variables, "XDG_CACHE_HOME")]
    found: list[Path] = []
    for value in filter(None, named):
        # A relative name means nothing once the current folder is gone.
        with suppress(OSError):
            found.append(Path(value).absolute() / name)
    home = Path(os.path.expanduser("~"))
    if home.is_absolute():
        found.append(home / ".cache" / name)
    # There may be no temporary folder that can be written to.
    with suppress(OSError):
        found.append(Path(tempfile.gettempdir()) / f"{name}-{os.geteuid()}")
    return found


def require_trusted(status: os.stat_result, path: Path) -> None:
    """Raise Distrusted if another user owns the file or folder of `status`, or may write to it."""
    require_owner(status, path)
    if status.st_mode & OTHERS_WRITE:
        mode = stat.S_IMODE(status.st_mode)
        raise Distrusted(errno.EPERM, f"other users may write to it (mode {mode:04o}; chmod go-w makes it private)", str(path))


def require_owner(status: os.stat_result, path: Path) -> None:
    """Raise Distrusted if neither this user nor the administrator owns the file or folder of `status`."""
    if status.st_uid not in (ADMINISTRATOR, os.geteuid()):
        raise Distrusted(errno.EPERM, f"it belongs to user {status.st_uid}", str(path))


def require_trusted_folder(folder: Path) -> None:
    """Raise Distrusted if a folder, or the link that leads to it, is in another user's hands; OSError if there is none."""
    # The mode of a symbolic link means nothing.
    require_owner(folder.lstat(), folder)
    status = folder.stat()
    if not stat.S_ISDIR(status.st_mode):
        raise NotADirectoryError(errno.ENOTDIR, "it is not a folder", str(folder))
    require_trusted(status, folder)


def make_private(folder: Path) -> None:
    """Make a folder and the missing ones above it, with the mode 0700; OSError if that is impossible."""
    try:
        os.mkdir(folder, 0o700)
    except FileExistsError:
        pass
    except FileNotFoundError:
        if folder.parent == folder:
            raise
        make_private(folder.parent)
        with suppress(FileExistsError):
            os.mkdir(folder, 0o700)


def is_readable(folder: Path) -> bool:
    """Return True if a folder exists and is trusted; one that is not is reported once."""
    try:
        require_trusted_folder(folder)
    except Distrusted as error:
        say_distrust(error)
        return False
    except OSError:
        return False
    return True


def is_writable(folder: Path) -> bool:
    """Return True if a folder, made if need be, is trusted and takes a file; one that is not is reported once."""
    with suppress(OSError):
        make_private(folder)
    if not is_readable(folder):
        return False
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def say_distrust(error: Distrusted) -> None:
    """Print on standard error why a file or folder is left alone."""
    warn_once(f"distrust {error.filename}", f"{error.filename} is not used as a cache: {error.strerror}")


HEAD = struct.Struct("<8sQ32s")
"""First bytes of an entry: MAGIC, the number of bytes that follow, their SHA-256."""

MAGIC = b"avsim-1\n"
"""Marks an entry of this layout; another layout gets another number, and entries of this one count as damaged then."""

PART = ".part"
"""End of the name of a file that is not whole yet. A process that is killed may leave one."""


class Damaged(ValueError):
    """An entry that is not as it was written."""


def write_entry(path: Path, data: bytes) -> None:
    """Write an entry, readable by this user alone: after it, `path` holds either all of it or its earlier content, even if the
    machine loses power. Raises OSError and leaves nothing else behind."""
    handle, scratch = tempfile.mkstemp(prefix=".", suffix=PART, dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(HEAD.pack(MAGIC, len(data), hashlib.sha256(data).digest()))
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(scratch, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(scratch)
        raise


def read_entry(path: Path, *, must_be_private: bool = True) -> bytes:
    """Return the data written to `path`. Raises Damaged if it is not whole, Distrusted if it must be private and another user may
    have written it, and OSError if it is not there or cannot be read."""
    # Not to wait for a writer, should the name lead to a pipe.
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as stream:
        status = os.fstat(stream.fileno())
        if must_be_private:
            require_trusted(status, path)
        if not stat.S_ISREG(status.st_mode):
            raise Damaged(f"{path} is not a file")
        raw = stream.read()
    if len(raw) < HEAD.size:
        raise Damaged(f"{path} ends after {len(raw)} bytes")
    magic, length, digest = HEAD.unpack_from(raw)
    data = raw[HEAD.size :]
    if magic != MAGIC or length != len(data) or digest != hashlib.sha256(data).digest():
        raise Damaged(f"{path} is not as it was written")
    return data


Parsed = TypeVar("Parsed")
MOST = 2**27
"""Bytes that a file may have unless its reader says otherwise. Parsed as text it takes up to ten times its size in memory; the
largest mesh that we know of has a tenth of this."""

CHUNK = 2**20
"""Bytes read at a time of a file that grows, or whose system states no size."""

DEEPEST = 64
"""Levels to which lists and objects of a file may be nested. Our own files take 8, glTF some more. Less: such a file is refused;
more: readers recurse as deep as the value, and Python ends that at 1,000 calls. How deep its parsers go by themselves differs
from version to version."""


def check(path: Path, thing: str, valid: str, most: int = MOST) -> None:
    """Raise InvalidFile unless `path` is a regular file of at most `most` bytes; `thing` is its name in the error."""
    try:
        found = path.stat()
    except (OSError, ValueError) as error:
        # ValueError: a name with a zero byte in it
        raise InvalidFile(thing, _reason(error), valid) from error
    if not stat.S_ISREG(found.st_mode):
        kind = "a folder" if stat.S_ISDIR(found.st_mode) else "a pipe, a socket or a device"
        raise InvalidFile(thing, kind, f"a regular file: {valid}")
    if found.st_size > most:
        raise InvalidFile(f"size of {thing} [bytes]", found.st_size, f"up to {most}")


def read_bytes(path: Path, thing: str, valid: str, most: int = MOST) -> bytes:
    """Return all bytes of a regular file. Raises InvalidFile."""
    check(path, thing, valid, most)
    try:
        with path.open("rb") as file:
            # a read of so many bytes takes their memory at once, however short the file is
            content = file.read(os.fstat(file.fileno()).st_size)
            while len(content) <= most and (more := file.read(CHUNK)):
                content += more
    except OSError as error:
        raise InvalidFile(thing, _reason(error), valid) from error
    if len(content) > most:
        # it grew meanwhile, or its system states no size
        raise InvalidFile(f"size of {thing} [bytes]", f"above {most}", f"up to {most}")
    return content


def read_text(path: Path, thing: str, valid: str, most: int = MOST, errors: str = "strict") -> str:
    """Return a regular file of UTF-8 text, without the byte order mark that some editors put first. Raises InvalidFile."""
    try:
        return read_bytes(path, thing, valid, most).decode("utf-8-sig", errors)
    except UnicodeDecodeError as error:
        raise InvalidFile(thing, f"not UTF-8: {error}", valid) from error


def read_json(path: Path, thing: str, valid: str, most: int = MOST, constant: Callable[[str], object] | None = None) -> object:
    """Return the value of a JSON file; `constant` is called for NaN and Infinity. Raises InvalidFile."""
    return parsed_json(read_text(path, thing, valid, most), thing, valid, constant)


def parsed_json(content: str, thing: str, valid: str, constant: Callable[[str], object] | None = None) -> Any:
    """Return the value of JSON text of a file, nested no deeper than DEEPEST. Raises InvalidFile."""
    try:
        return shallow(json.loads(content, parse_constant=constant))
    except (ValueError, RecursionError) as error:
        raise InvalidFile(thing, _unparsed(error, "JSON"), valid) from error


def read_toml(path: Path, thing: str, valid: str, most: int = MOST) -> dict[str, object]:
    """Return the tables of a TOML file. Raises InvalidFile."""
    content = read_text(path, thing, valid, most)
    try:
        return shallow(tomllib.loads(content))
    except (ValueError, RecursionError) as error:
        raise InvalidFile(thing, _unparsed(error, "TOML"), valid) from error


def shallow(value: Parsed, most: int = DEEPEST) -> Parsed:
    """Return `value`, level by level found to be nested no deeper than `most`. Raises RecursionError."""
    level: list[object] = [value]
    for _ in range(most):
        level = [part for node in level for part in _parts(node) if isinstance(part, list | dict)]
        if not level:
            return value
    raise RecursionError


def _parts(node: object) -> Iterable[object]:
    return node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()


def _unparsed(error: Exception, language: str) -> str:
    if isinstance(error, RecursionError):
        return f"{language} nested too deeply"
    return f"cut off or not {language}: {error}"


def _reason(error: Exception) -> str:
    """Return the system's reason, without the path, which the error names by itself."""
    return getattr(error, "strerror", None) or str(error)
