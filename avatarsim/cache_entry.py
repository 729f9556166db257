"""Cache entries written atomically (temporary file, fsync, rename) and checked by length and SHA-256 before they are used."""

import hashlib
import os
import stat
import struct
import tempfile
from contextlib import suppress
from pathlib import Path

from avatarsim.cache_folder import require_trusted

HEAD = struct.Struct("<8sQ32s")
"""What an entry begins with: MAGIC, the number of bytes that follow, their SHA-256."""

MAGIC = b"avsim-1\n"
"""Marks an entry of this layout; another layout gets another number, and entries of this one count as damaged then."""

PART = ".part"
"""How the name of a file ends that is not whole yet. A process that is killed may leave one."""


class Damaged(ValueError):
    """An entry that is not as it was written."""


def write_entry(path: Path, data: bytes) -> None:
    """Write an entry, readable by this user alone: after it, `path` holds either all of it or what it held before, even if the
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
    """What was written to `path`. Raises Damaged if it is not whole, Distrusted if it must be private and another user may have
    written it, and OSError if it is not there or cannot be read."""
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
