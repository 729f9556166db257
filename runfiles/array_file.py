"""Arrays by name in one .npz file: numbers as byte planes of their differences in time, deflated, and read with a bound.

The motion of bodies from frame to frame is smooth, so of a difference between two numbers, taken as integers of their 64 bits,
the upper bytes are nearly always zero: put together they deflate to nearly nothing. Not a bit is lost. Files come from elsewhere
too: a member is read only if its header and the archive declare one and the same size, and all together stay below MOST.
"""

import math
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.files import check

MAX_BYTES = 2**30
"""Bytes that all arrays of one file may take. The longest recording of the catalogue takes a twentieth; a file of a megabyte that
deflate can blow up to a thousand must not take a machine's memory."""
WHOLE = "a whole .npz file from this runner"
LEVEL = 1
"""Of deflate. A higher one takes three times as long and saves a tenth."""
PLANES = {"@float64": np.dtype(np.float64), "@int64": np.dtype(np.int64)}
"""Endings of the names of members that hold byte planes (8, ..., n) of an array (n, ...), and the type of that array."""
TIME = 0
"""The axis along which differences are taken."""


def write(file: IO[bytes], arrays: Mapping[str, NDArray[np.generic]]) -> None:
    """Write arrays by name; those of float64 and int64 as byte planes, all others as they are."""
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=LEVEL) as archive:
        for name, array in arrays.items():
            ending = f"@{array.dtype}"
            coded = ending in PLANES and array.ndim > 0
            # a member opened by its name has no date: equal arrays are equal files, whenever they were written
            with archive.open(f"{name}{ending if coded else ''}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, planes(array) if coded else np.asarray(array), allow_pickle=False)


def planes(array: NDArray[np.generic]) -> NDArray[np.uint8]:
    """Return bytes (8, ..., n) of an array (n, ...) of 64-bit numbers: those of equal weight together, time last."""
    bits = np.moveaxis(array, TIME, -1).copy(order="C").view(np.int64)
    bits[..., 1:] = np.diff(bits, axis=-1)
    # the sign goes to the lowest bit: a small step down has zeros above as a small step up has
    bits = (bits << 1) ^ (bits >> 63)
    split = bits.astype("<i8", copy=False).view(np.uint8).reshape(*bits.shape, 8)
    return np.ascontiguousarray(np.moveaxis(split, -1, 0))


def joined(split: NDArray[np.uint8], kind: np.dtype[Any]) -> NDArray[np.generic]:
    """Return the array whose `planes` these are. Raises ValueError for bytes of another layout."""
    if split.dtype != np.uint8 or split.ndim < 2 or split.shape[0] != 8:
        raise ValueError(f"byte planes of {split.dtype}, {split.shape}")
    bits = np.ascontiguousarray(np.moveaxis(split, 0, -1)).view("<i8")[..., 0].astype(np.int64)
    bits = ((bits >> 1) & np.int64(2**63 - 1)) ^ -(bits & 1)
    np.cumsum(bits, axis=-1, out=bits)
    return np.ascontiguousarray(np.moveaxis(bits, -1, TIME)).view(kind)


def read(path: Path, wanted: Callable[[str], bool] = lambda name: True) -> dict[str, NDArray[Any]]:
    """Read the arrays of a file whose name is `wanted`. Raises InvalidFile for one that is missing, damaged, or too large."""
    check(path, f"arrays of {path}", WHOLE, MAX_BYTES)
    try:
        with path.open("rb") as file, zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            declared = sum(member.file_size for member in members)
            if declared > MAX_BYTES:
                raise InvalidFile(f"size of {path} unpacked [bytes]", declared, f"up to {MAX_BYTES}")
            return dict(_array(archive, member) for member in members if wanted(_name(member)[0]))
    except InvalidFile:
        raise
    except Exception as error:
        # zipfile, zlib and numpy have no common error
        raise InvalidFile(f"arrays of {path}", f"{type(error).__name__}: {error}", WHOLE) from error


def _name(member: zipfile.ZipInfo) -> tuple[str, str]:
    """Return the name of an array, and the ending of its layout."""
    name, at, kind = member.filename.removesuffix(".npy").rpartition("@")
    return (name, at + kind) if at + kind in PLANES else (member.filename.removesuffix(".npy"), "")


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> tuple[str, NDArray[Any]]:
    name, ending = _name(member)
    with archive.open(member) as stored:
        if np.lib.format.read_magic(stored) != (1, 0):
            raise ValueError(f"{name} has a header of another version")
        shape, column_major, kind = np.lib.format.read_array_header_1_0(stored)
        size = math.prod(shape) * kind.itemsize
        if kind.hasobject or column_major or stored.tell() + size != member.file_size:
            raise ValueError(f"{name} is declared as {kind} {shape}, and has {member.file_size} bytes")
        array = np.frombuffer(bytearray(stored.read()), dtype=kind).reshape(shape)
    return name, joined(array, PLANES[ending]) if ending else array
