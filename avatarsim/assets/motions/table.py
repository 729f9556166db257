"""Tables of text (.csv): a row of root position, quaternion and joints a frame, with or without a row of names above.

A table with joint names but without root columns drives an avatar with a fixed root.

The convention of the retargeted LAFAN1 clips of the Unitree G1: x, y, z [m], the quaternion as x, y, z, w, then 29 joints [rad]
in the model's order, 30 rows a second, no names. With names the columns may have any order, with others between them.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from avatarsim.assets import caps
from avatarsim.assets.motions import matching
from avatarsim.assets.motions.archive import finite_rows
from avatarsim.assets.motions.frame_times import HIGHEST, at_rate, steady_rate
from avatarsim.assets.motions.trajectory import Changed, Trajectory
from avatarsim.errors import InvalidFile
from avatarsim.files import read_text
from avatarsim.spatial.rotation import Array

USUAL_RATE = 30.0
"""Default rows a second [1/s]: that of the LAFAN1 recordings, whose retargeted clips are the tables in use."""

VALID = "a table of numbers: a row of root position, quaternion and joints a frame, under an optional row of names"

DELIMITERS = (",", ";", "\t")
"""Separators of numbers; without one of them, white space."""

ROOT = re.compile(
    r"(?:(?:floating_)?(?:root|base|pelvis)_?)?(?:joint_)?(?P<kind>pos|position|trans|translation|t|p|rot|quat|quaternion|ori|orientation|q)?"
    r"_?(?P<axis>[xyzw])"
)
"""Names of a root's columns, in lower case: x, root_x, base_pos_x, root_translation_x, qx, quat_w, root_rot_y, ..."""

TURNS = ("rot", "quat", "quaternion", "ori", "orientation", "q")

INDICES, INSTANTS = ("frame", "index", "frame_index", "frame_id", ""), ("time", "t", "timestamp", "times", "seconds")
"""Names of columns that count the rows, and that contain their instants [s]."""

SUFFIXES = ("_dof", "_pos", "_position", "_angle")
"""Suffixes that a table may append to a joint's name."""


@dataclass(frozen=True, eq=False)
class TextStore:
    """The lines of a table: those `above` the first row, a row each, separator and line ending; the column of its
    `instants`, and `columns`: for each column of the trajectory's table that of the file."""

    above: tuple[str, ...]
    rows: tuple[str, ...]
    delimiter: str
    end: str
    numbers: Array
    columns: tuple[int, ...]
    counting: int | None
    instants: int | None

    def written(self, changed: Changed) -> bytes:
        """Return the table: unchanged rows keep their text, others have the shortest text of each float64."""
        frames = len(changed.now)
        if changed.stayed is None:
            numbers = self._at(changed)
            stayed = np.zeros(frames, dtype=bool)
        else:
            numbers, stayed = self.numbers.copy(), changed.stayed
        numbers[:, list(self.columns)] = changed.now
        whole = [] if self.counting is None else [self.counting]
        lines = [
            self.rows[frame] if stayed[frame] else self.delimiter.join(
                str(int(value)) if column in whole and value == int(value) else repr(value) for column, value in enumerate(row)
            )
            for frame, row in enumerate(numbers.tolist())
        ]
        return (self.end.join([*self.above, *lines]) + self.end).encode("utf-8")

    def _at(self, changed: Changed) -> Array:
        """Return all columns at other instants, interpolated linearly; rows counted from the first one's number."""
        times = changed.after.times
        numbers = np.stack([np.interp(times, changed.before.times, column) for column in self.numbers.T], axis=1)
        if self.counting is not None:
            numbers[:, self.counting] = self.numbers[0, self.counting] + np.arange(len(times))
        if self.instants is not None:
            numbers[:, self.instants] = self.numbers[0, self.instants] + times
        elif len(times) > 1:
            steady_rate(changed.after)
        return numbers


def read_csv(
    path: str | Path, *, rate: float | None = None, quaternion: str | None = None, joints: str | Iterable[str] | None = None
) -> Trajectory:
    """Read the trajectory in a table. Raises InvalidFile.

    rate        rows a second [1/s]; else by the column of instants, else USUAL_RATE
    quaternion  "wxyz" or "xyzw", of a table without names; else "xyzw"
    joints      names of the joints in the file's order, where it has none; a text of names with commas between"""
    path = Path(path)
    name = path.name
    text = read_text(path, f"table {name}", VALID, caps.TEXT_BYTES)
    # checked before splitting: a line of three bytes becomes a text of sixty
    caps.require_frames(name, text.count("\n") - 1)
    end = "\r\n" if "\r\n" in text else "\n"
    lines = [line for line in text.replace("\r\n", "\n").split("\n") if line.strip()]
    if not lines:
        raise InvalidFile(f"rows of table {name}", 0, VALID)
    delimiter = next((found for found in DELIMITERS if found in lines[-1]), None)
    names = _names(name, lines[0], delimiter)
    rows = tuple(lines if names is None else lines[1:])
    numbers = _numbers(name, rows, delimiter)
    if names is not None and len(names) != numbers.shape[1]:
        raise InvalidFile(f"columns of {name}", numbers.shape[1], f"{len(names)}, as its first row names")
    notes: list[str] = []
    listed = matching.listed(joints)
    if names is None:
        order = matching.require_order(quaternion or "xyzw")
        if quaternion is None:
            notes.append(f'{name}: quaternions taken as x, y, z, w; quaternion="wxyz" says otherwise')
        layout = matching.Layout(listed, order)
        counting, instants, columns = _uncounted(numbers)
    else:
        layout, counting, instants, columns = _named(name, names)
        if listed not in (None, layout.joints):
            valid = f"those that its first row names: {matching.shortened(layout.joints or ())}; or none"
            raise InvalidFile(f"joints for {name}", matching.shortened(listed or ()), valid)
    times = _times(name, numbers, rate, instants, notes)
    above = () if names is None else (lines[0],)
    store = TextStore(above, rows, delimiter or " ", end, numbers, columns, counting, instants)
    return Trajectory(name, "csv", times, numbers[:, list(columns)], layout, store, sentences=notes)


def _cells(line: str, delimiter: str | None) -> list[str]:
    return [cell.strip() for cell in line.split(delimiter)]


def _names(name: str, line: str, delimiter: str | None) -> list[str] | None:
    """Return the names in a first line; None if it contains numbers."""
    if len(line) > caps.COLUMNS * caps.NAME:
        raise InvalidFile(f"characters of the first line of {name}", len(line), f"up to {caps.COLUMNS * caps.NAME}")
    cells = _cells(line, delimiter)
    if any(_is_number(cell) for cell in cells):
        return None
    return [cell.strip('"').lstrip("# ") for cell in cells]


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _numbers(name: str, rows: tuple[str, ...], delimiter: str | None) -> Array:
    """Return the numbers (F, columns) of the rows."""
    if not rows:
        raise InvalidFile(f"rows of numbers of table {name}", 0, VALID)
    caps.require_frames(name, len(rows))
    widths = [row.count(delimiter) + 1 if delimiter else len(row.split()) for row in rows]
    if max(widths) > caps.COLUMNS:
        raise InvalidFile(f"columns of row {int(np.argmax(widths)) + 1} of {name}", max(widths), f"up to {caps.COLUMNS}")
    other = next((row for row, width in enumerate(widths) if width != widths[0]), None)
    if other is not None:
        raise InvalidFile(f"columns of row {other + 1} of {name}", widths[other], f"{widths[0]}, as in row 1")
    try:
        numbers = np.loadtxt(rows, delimiter=delimiter, comments=None, ndmin=2, dtype=np.float64, quotechar=None)
    except (ValueError, OverflowError) as error:
        raise InvalidFile(f"numbers of table {name}", str(error).partition(";")[0][: caps.NAME], VALID) from error
    return finite_rows(f"table {name}", numbers)


def _uncounted(numbers: Array) -> tuple[int | None, None, tuple[int, ...]]:
    """Return the columns of a table without names; a first one that counts the rows is not part of the posture."""
    every = tuple(range(numbers.shape[1]))
    first = numbers[:, 0]
    counts = len(first) > 1 and bool((first == first[0] + np.arange(len(first))).all()) and first[0] in (0.0, 1.0)
    return (0, None, every[1:]) if counts else (None, None, every)


def _named(name: str, names: list[str]) -> tuple[matching.Layout, int | None, int | None, tuple[int, ...]]:
    """Return the layout of named columns, the columns that count and time the rows, and the posture's columns, root first."""
    counting = instants = None
    places: dict[str, int] = {}
    turns: dict[str, int] = {}
    joints: dict[str, int] = {}
    for column, column_name in enumerate(names):
        word = column_name.lower()
        root = ROOT.fullmatch(word.replace(".", "_").replace(" ", "_"))
        if word in INDICES and counting is None:
            counting = column
        elif word in INSTANTS and instants is None:
            instants = column
        elif root is not None:
            turning = root["kind"] in TURNS or root["axis"] == "w"
            _put(name, turns if turning else places, root["axis"], column, column_name)
        else:
            _put(name, joints, caps.require_name(f"name of column {column} of {name}", column_name), column, column_name)
    rooted = bool(places or turns)
    if rooted and (set(places) != set("xyz") or set(turns) != set("wxyz")):
        valid = "columns root_x, root_y, root_z, root_qw, root_qx, root_qy, root_qz, none of them, or a table without names"
        raise InvalidFile(f"root's columns of {name}", f"{', '.join(names[:12])}", valid)
    first = [*(places[axis] for axis in "xyz"), *(turns[axis] for axis in "wxyz")] if rooted else []
    layout = matching.Layout(tuple(_joint(word) for word in joints), "wxyz", rooted)
    return layout, counting, instants, (*first, *joints.values())


def _put(name: str, found: dict[str, int], key: str, column: int, column_name: str) -> None:
    if key in found:
        raise InvalidFile(f"name of column {column} of {name}", column_name, "names, each once")
    found[key] = column


def _joint(word: str) -> str:
    """Return a joint's name without suffixes of tables."""
    return next((word.removesuffix(suffix) for suffix in SUFFIXES if word.endswith(suffix) and word != suffix), word)


def _times(name: str, numbers: Array, rate: float | None, instants: int | None, notes: list[str]) -> Array:
    """Return instants (F,) [s] from 0."""
    if rate is not None:
        return at_rate(rate, len(numbers), "rate")
    if instants is None:
        notes.append(f"{name}: {USUAL_RATE:g} rows a second assumed, as in retargeted LAFAN1 clips; rate= says otherwise")
        return at_rate(USUAL_RATE, len(numbers), "rate")
    times = numbers[:, instants]
    if not (np.diff(times) >= 1.0 / HIGHEST).all():
        row = int(np.argmin(np.diff(times) >= 1.0 / HIGHEST)) + 1
        raise InvalidFile(f"instant of row {row + 1} of {name} [s]", float(times[row]), "later than the row before")
    return np.asarray(times - times[0])
