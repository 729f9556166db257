"""NumPy archives (.npz: a zip of .npy arrays, NEP 1), untrusted, read with limits; equal arrays are written as equal bytes.

The unpacked size, shape and type of an entry are compared with the limits before a byte of it is unpacked; nothing is ever
unpickled. An entry of Python objects (a pickle) is left out and named.
"""

import io
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from avatarsim.assets import caps
from avatarsim.errors import InvalidFile
from avatarsim.spatial.rotation import Array

AnyArray = NDArray[Any]

KINDS = "biufUS"
"""Kinds of numbers and text allowed in entries: bool, integers, floats, text."""

PICKLED = "made of Python objects (a pickle, which could run any program)"

DAMAGED = (
    zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, OSError, ValueError, KeyError, OverflowError,
    struct.error,
)
"""Exceptions of the standard library for damaged archives."""

BAD_HEADERS = (ValueError, SyntaxError, TypeError, MemoryError, RecursionError, OverflowError, tokenize.TokenError)
"""Exceptions of numpy for an invalid header: it is a literal of Python, which it parses as one."""

VALID = "an .npz archive of arrays of numbers, as numpy.savez writes it"


@dataclass(frozen=True, eq=False)
class Archive:
    """The arrays of a file `name` in its order, whether they were `compressed`, and the names of entries that were `left_out`."""

    name: str
    arrays: Mapping[str, AnyArray]
    compressed: bool
    left_out: tuple[str, ...]

    def first(self, keys: tuple[str, ...]) -> str | None:
        """Return the first of these keys that the file has."""
        return next((key for key in keys if key in self.arrays or key in self.left_out), None)

    def table(self, key: str, width: int | None = None) -> Array:
        """Return an entry as finite float64 (F, width), F at least 1. Raises InvalidFile that names entry, frame and column."""
        found = self._numbers(key)
        if found.ndim != 2 or len(found) == 0 or (width is not None and found.shape[1] != width):
            raise InvalidFile(f"shape of {key} in {self.name}", found.shape, f"(frames, {width or 'columns'})")
        caps.require_frames(self.name, len(found))
        if found.shape[1] > caps.COLUMNS:
            raise InvalidFile(f"columns of {key} in {self.name}", found.shape[1], f"up to {caps.COLUMNS}")
        return finite_rows(f"{key} in {self.name}", found)

    def numbers(self, key: str) -> Array:
        """Return an entry as finite float64 numbers of its own shape. Raises InvalidFile."""
        found = self._numbers(key).astype(np.float64)
        if not np.isfinite(found).all():
            raise InvalidFile(f"{key} in {self.name}", "not finite", "finite numbers")
        return found

    def scalar(self, key: str) -> float:
        """Return an entry of one finite number. Raises InvalidFile."""
        found = self._numbers(key)
        if found.size != 1:
            raise InvalidFile(f"shape of {key} in {self.name}", found.shape, "one number")
        return float(self.numbers(key).ravel()[0])

    def words(self, key: str) -> tuple[str, ...]:
        """Return an entry of names (n,). Raises InvalidFile for numbers, and for names that cannot be printed."""
        found = self._entry(key)
        if found.dtype.kind not in "US" or found.ndim != 1 or len(found) > caps.COLUMNS:
            raise InvalidFile(f"{key} in {self.name}", f"{found.dtype} {found.shape}", "a row of names")
        text = found if found.dtype.kind == "U" else np.char.decode(found, "latin-1")
        return tuple(caps.require_name(f"entry of {key} in {self.name}", str(word)) for word in text)

    def rewritten(
        self, now: Mapping[str, Array], anew: Mapping[str, AnyArray], derived: Collection[str], frames: int | None
    ) -> dict[str, AnyArray]:
        """Return the arrays with those of `now`, in the file's types where these suffice, and of `anew`.
        The rest is unchanged, without `derived` ones and, if the old number of `frames` is given, those with as many rows."""
        found: dict[str, AnyArray] = {}
        for key, recorded in self.arrays.items():
            if key in now:
                found[key] = narrowed(now[key], recorded)
            elif key in anew:
                found[key] = anew[key]
            elif key not in derived and not (recorded.ndim > 0 and len(recorded) == frames):
                found[key] = recorded
        return found

    def _numbers(self, key: str) -> AnyArray:
        found = self._entry(key)
        if found.dtype.kind not in "iuf":
            raise InvalidFile(f"type of {key} in {self.name}", str(found.dtype), "numbers")
        return found

    def _entry(self, key: str) -> AnyArray:
        if key in self.left_out:
            raise InvalidFile(f"{key} in {self.name}", PICKLED, f"numbers: save it as numpy.asarray({key}, dtype=float)")
        if key not in self.arrays:
            raise InvalidFile(f"entries of {self.name}", sorted(self.arrays), f"{key} among them")
        return self.arrays[key]


def finite_rows(thing: str, rows: AnyArray) -> Array:
    """Return numbers (F, n) as float64. Raises InvalidFile that names frame and column of numbers that are not finite."""
    values = rows.astype(np.float64)
    bad = ~np.isfinite(values)
    if bad.any():
        frame, column = (int(k) for k in np.argwhere(bad)[0])
        raise InvalidFile(f"column {column} of frame {frame} of {thing}", float(values[frame, column]), "a finite number")
    return values


def open_archive(path: Path) -> Archive:
    """Return the arrays of an .npz file. Raises InvalidFile for invalid files, and for those beyond limits of `assets.caps`."""
    name = path.name
    raw = caps.content(path, f"archive {name}", VALID)
    arrays: dict[str, AnyArray] = {}
    left_out: list[str] = []
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as file:
            members = _members(name, file)
            for key, member in members.items():
                found = _array(f"{key} in {name}", file, member)
                if found is None:
                    left_out.append(key)
                else:
                    arrays[key] = found
    except DAMAGED as error:
        raise InvalidFile(f"archive {name}", f"damaged or no archive: {error}", VALID) from error
    compressed = any(member.compress_type != zipfile.ZIP_STORED for member in members.values())
    return Archive(name, arrays, compressed, tuple(left_out))


def _members(name: str, file: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """Return the members of an archive, by the names of its arrays, if all of it can be unpacked at once."""
    listed = file.infolist()
    if len(listed) > caps.ENTRIES:
        raise InvalidFile(f"entries of {name}", len(listed), f"up to {caps.ENTRIES}")
    size = sum(member.file_size for member in listed)
    if size > caps.BYTES:
        raise InvalidFile(f"unpacked size of {name} [bytes]", size, f"up to {caps.BYTES}")
    found: dict[str, zipfile.ZipInfo] = {}
    for member in listed:
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) or member.flag_bits & 1:
            thing = f"packing of {member.filename[:caps.NAME]} in {name}"
            raise InvalidFile(thing, member.compress_type, "stored (0) or deflated (8), without a password")
        key = caps.require_name(f"name of an entry of {name}", member.filename.removesuffix(".npy"))
        if not member.filename.endswith(".npy") or key in found:
            raise InvalidFile(f"entry of {name}", member.filename, "names that end in .npy, each once")
        found[key] = member
    return found


def _array(thing: str, file: zipfile.ZipFile, member: zipfile.ZipInfo) -> AnyArray | None:
    """Return one array; None for one of Python objects, of which only the header is read."""
    with file.open(member) as stream:
        try:
            version = npy.read_magic(stream)
            header = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}.get(version)
            if header is None:
                _no_array(thing, f"version {version}")
            shape, by_columns, dtype = header(stream)
        except BAD_HEADERS as error:
            _no_array(thing, f"a header that says: {error}", error)
        if dtype.hasobject:
            return None
        if dtype.kind not in KINDS or dtype.names is not None:
            raise InvalidFile(f"type of {thing}", str(dtype)[: caps.NAME], "numbers, truth or text")
        claimed, rest = prod(shape) * dtype.itemsize, member.file_size - stream.tell()
        if claimed != rest:
            raise InvalidFile(f"bytes of {thing}", rest, f"{claimed}, as its shape {shape} says")
        values = np.frombuffer(stream.read(), dtype=dtype)
    if values.size != prod(shape):
        _no_array(thing, f"{values.size} values")
    return values.reshape(shape, order="F" if by_columns else "C")


def _no_array(thing: str, value: str, error: Exception | None = None) -> NoReturn:
    raise InvalidFile(thing, value, VALID) from error


def npz_bytes(arrays: Mapping[str, AnyArray], compressed: bool) -> bytes:
    """Return an .npz file of these arrays, as equal bytes at any time."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED if compressed else zipfile.ZIP_STORED) as file:
        for key, values in arrays.items():
            # a separate ZipInfo carries no time of day
            member = zipfile.ZipInfo(f"{key}.npy")
            member.compress_type = file.compression
            with file.open(member, "w", force_zip64=True) as entry:
                npy.write_array(entry, np.asanyarray(values), allow_pickle=False)
    return stream.getvalue()


def narrowed(values: Array, like: AnyArray) -> AnyArray:
    """Return numbers in the file's type, where it can represent them: float64, and float32 up to FLOAT32_MOST."""
    if like.dtype == np.dtype(np.float32).newbyteorder(like.dtype.byteorder) and np.abs(values).max(initial=0.0) <= FLOAT32_MOST:
        return values.astype(like.dtype)
    return values


FLOAT32_MOST = 8.0
"""Largest coordinate [m] or angle [rad] that is written as float32: its steps there are 4.8e-7, so a body is written within
2.4e-7 m. Farther out the file's float32 becomes float64, and so does any narrower type: else bodies that were free to 1e-6 m
overlap when read back."""
