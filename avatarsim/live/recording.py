"""Append-only log of the inputs and shown states of a loop (write-ahead logging; Gray and Reuter 1993, ch. 9).

A file is `MAGIC`, a format number, a head in JSON, then rows: kind, length, CRC-32 of these two, payload, CRC-32 of the row. A
frame's row has the sample as the engine received it and the hash of the shown state; a command's row has the command that came
between two frames. The log of a killed process ends in a torn row and is read up to the last whole one; the separate checksum of
the lengths distinguishes a torn row from a damaged one. No content of a file is run or imported.
"""

import errno
import json
import os
import platform
import re
import struct
import zlib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from avatarsim.assets.caps import BODIES, BYTES, FRAMES, JSON_BYTES, LINKS, content, require_name
from avatarsim.engine import Settings
from avatarsim.errors import InvalidFile, InvalidInput, InvalidSample
from avatarsim.files import parsed_json
from avatarsim.jit.packages import TESTED as COMPILER
from avatarsim.jit.processor import compiled_for
from avatarsim.live.messages import RATES, Array, Command, Order, Plan, Switch
from avatarsim.scene.checks import within
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.scene.written import scene_from, written
from avatarsim.version import VERSION

MAGIC = b"avatarsim live\r\n\0"
"""First bytes of a recording; the line end reveals files that were transferred as text."""
FORMAT = 1
"""Number of this layout. Any change of the written data needs a new one."""
HEAD, ROW, SUM = struct.Struct("<II"), struct.Struct("<BI"), struct.Struct("<I")
"""Format and bytes of the head; kind and bytes of a row; a CRC-32."""
BEFORE = ROW.size + SUM.size
"""Bytes of a row before its payload."""
FRAME, COMMAND = 1, 2
"""Kinds of rows."""
DIGEST = 8
"""Bytes of a state's hash."""
HASH = re.compile(f"[0-9a-f]{{{2 * DIGEST}}}")
"""A state's hash in hexadecimal digits."""
VALID = "a recording of avatarsim live"
ENGINE = "avatarsim.simulator:AvatarsimEngine"
"""The one engine whose recordings replay to the same bits, and the only one that a file may name."""
RECORDED_ORDERS = (Order.KEEP, Order.BACK, Order.TAKE, Order.PINCH, Order.SWITCH)
"""Orders that are recorded: those that change later frames. A reset begins another file."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame: the `sample` as the engine received it, and the hash of the shown state."""

    sample: TrackerSample
    state_hash: str


@dataclass(frozen=True, eq=False)
class Recorded:
    """A recording: the plan, the hash of the first state, rows in order, versions of packages, and whether its end is torn."""

    plan: Plan
    first_hash: str
    rows: tuple[Frame | Command, ...]
    versions: Mapping[str, str]
    is_torn: bool

    @property
    def frames(self) -> int:
        """Number of frames."""
        return sum(isinstance(row, Frame) for row in self.rows)


class Recorder:
    """Writer of a log at `path`, for a world that has just begun from `plan` and shows the state of `first_hash`.

    Raises OSError if no file can be created, or if the scene is larger than `read` accepts. Later failures only clear `is_open`:
    the log closes when the disk refuses a write, or at the limits within which `read` accepts a file."""

    def __init__(self, path: Path, plan: Plan, first_hash: str) -> None:
        self.path, self.is_open = path, True
        head = json.dumps({
            "engine": plan.engine, "name": plan.name, "rate": float(plan.rate), "preset": plan.settings.preset,
            "options": _options(plan.settings.options), "seed": plan.settings.seed, "off": list(plan.off),
            "first_hash": first_hash, "versions": versions(), "scene": written(plan.scene),
        }, allow_nan=False).encode()
        if len(head) > JSON_BYTES or _is_large(plan.scene):
            raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))
        self._file = path.open("wb")
        self._room, self._rows = BYTES, 0
        self._put(MAGIC + HEAD.pack(FORMAT, len(head)) + head + SUM.pack(zlib.crc32(head)))

    def frame(self, sample: TrackerSample, state_hash: str) -> None:
        """Append a frame."""
        numbers = np.concatenate([[sample.time], sample.positions.ravel(), sample.rotations.ravel(), sample.angles])
        self._row(FRAME, bytes.fromhex(state_hash) + numbers.astype("<f8").tobytes())

    def command(self, command: Command) -> None:
        """Append a command that comes before the next frame."""
        if command.order in RECORDED_ORDERS:
            self._row(COMMAND, json.dumps(_order(command)).encode())

    def _row(self, kind: int, payload: bytes) -> None:
        self._rows += 1
        if self._rows > FRAMES:
            self.close()
        begun = ROW.pack(kind, len(payload))
        row = begun + SUM.pack(zlib.crc32(begun)) + payload
        self._put(row + SUM.pack(zlib.crc32(row)))

    def _put(self, data: bytes) -> None:
        if not self.is_open:
            return
        self._room -= len(data)
        if self._room < 0:
            self.close()
            return
        try:
            self._file.write(data)
        except OSError:
            self.close()

    def flush(self) -> None:
        """Flush written data to the system."""
        with suppress(OSError, ValueError):
            self._file.flush()

    def close(self) -> None:
        """Close the file; later rows are ignored."""
        self.is_open = False
        with suppress(OSError):
            self._file.close()


def versions() -> dict[str, str]:
    """Return the versions of all that affects the last bits: the package, its compiler and the processor."""
    return {
        "avatarsim": VERSION, "numpy": np.__version__, **{name: version(name) for name in COMPILER},
        "python": platform.python_version(), "machine": platform.machine(), "processor": compiled_for().name,
    }


def _options(options: Mapping[str, object]) -> dict[str, Any]:
    """Return options of an engine as JSON, with NumPy numbers as plain ones."""
    return {name: written(value) for name, value in options.items()}


def _is_large(scene: Scene) -> bool:
    """Return True if a file with this scene would be refused."""
    return len(scene.bodies) > BODIES or len(scene.links) > LINKS


def read(path: Path) -> Recorded:
    """Read a recording. Raises InvalidFile if the file is no recording, is damaged, or exceeds the limits of recordings."""
    thing = f"recording {path.name}"
    data = content(path, thing, VALID)
    if not data.startswith(MAGIC) or len(data) < len(MAGIC) + HEAD.size:
        raise InvalidFile(thing, data[: len(MAGIC)], f"{VALID}, which begins with {MAGIC!r}")
    number, length = HEAD.unpack_from(data, len(MAGIC))
    if number != FORMAT:
        raise InvalidFile(f"format of {thing}", number, f"{FORMAT}; another version of avatarsim reads others")
    if length > JSON_BYTES:
        raise InvalidFile(f"bytes of the head of {thing}", length, f"up to {JSON_BYTES}")
    at = len(MAGIC) + HEAD.size
    head, at = data[at: at + length], at + length
    if len(data) < at + SUM.size or SUM.unpack_from(data, at)[0] != zlib.crc32(head):
        raise InvalidFile(f"head of {thing}", f"{len(head)} bytes", "bytes that agree with their CRC-32")
    plan, first_hash, stated = _plan(_parsed(head, f"head of {thing}"), thing)
    rows, is_torn = _rows(data, at + SUM.size, plan.scene, thing)
    return Recorded(plan, first_hash, rows, stated, is_torn)


def _parsed(data: bytes, thing: str) -> dict[str, Any]:
    """Parse a JSON object of finite numbers."""
    def refused(word: str) -> None:
        raise ValueError(f"{word} is no number")

    try:
        found = parsed_json(data.decode(), thing, "JSON", refused)
    except UnicodeDecodeError as error:
        raise InvalidFile(thing, f"not UTF-8: {error}", "JSON") from error
    if not isinstance(found, dict):
        raise InvalidFile(thing, found, "a JSON object")
    return found


def _plan(head: dict[str, Any], thing: str) -> tuple[Plan, str, dict[str, str]]:
    """Return the plan, the first hash and the versions from the head."""
    kinds = {
        "engine": str, "name": str, "rate": float, "preset": str, "options": dict, "seed": int, "off": list, "first_hash": str,
        "versions": dict, "scene": dict,
    }
    for name, kind in kinds.items():
        if not isinstance(head.get(name), kind) or isinstance(head[name], bool):
            raise InvalidFile(f"{name} in the head of {thing}", head.get(name), f"a {kind.__name__}")
    if head["engine"] != ENGINE:
        raise InvalidFile(f"engine of {thing}", head["engine"], f"{ENGINE}, whose recordings alone replay to the same bits")
    try:
        settings = Settings(head["preset"], head["options"], head["seed"])
        rate = within(f"rate of {thing} [1/s]", head["rate"], *RATES, InvalidInput)
        bodies = head["scene"].get("bodies")
        if isinstance(bodies, list) and len(bodies) > BODIES:
            # before any body is constructed
            raise InvalidFile(f"bodies of {thing}", len(bodies), f"up to {BODIES}")
        scene = scene_from(head["scene"], thing)
    except InvalidFile:
        raise
    except InvalidInput as error:
        raise InvalidFile(f"head of {thing}", str(error), VALID) from error
    if _is_large(scene):
        raise InvalidFile(f"links of {thing}", len(scene.links), f"up to {LINKS}")
    if not HASH.fullmatch(head["first_hash"]):
        raise InvalidFile(f"first hash of {thing}", head["first_hash"], f"{2 * DIGEST} hexadecimal digits")
    stated = {require_name(f"version in {thing}", name): require_name(f"version of {name} in {thing}", str(value))
            for name, value in head["versions"].items()}
    off = _names(head["off"], f"effects that are off in {thing}")
    return Plan(ENGINE, scene, settings, rate, name=head["name"], off=off), head["first_hash"], stated


def _rows(data: bytes, at: int, scene: Scene, thing: str) -> tuple[tuple[Frame | Command, ...], bool]:
    """Return all whole rows, and whether a torn one follows. Raises InvalidFile for a damaged row within the file."""
    rows: list[Frame | Command] = []
    while at < len(data):
        number = len(rows)
        if len(data) - at < BEFORE:
            return tuple(rows), True
        place = f"row {number} of {thing}"
        kind, length = ROW.unpack_from(data, at)
        if SUM.unpack_from(data, at + ROW.size)[0] != zlib.crc32(data[at: at + ROW.size]):
            raise InvalidFile(f"beginning of {place}", f"kind {kind}, {length} bytes", "bytes that agree with their CRC-32")
        if kind not in (FRAME, COMMAND):
            raise InvalidFile(f"kind of {place}", kind, f"{FRAME}, a frame, or {COMMAND}, a command")
        end = at + BEFORE + length
        if end + SUM.size > len(data):
            return tuple(rows), True
        if SUM.unpack_from(data, end)[0] != zlib.crc32(data[at:end]):
            raise InvalidFile(place, f"{length} bytes", "bytes that agree with their CRC-32")
        payload = data[at + BEFORE: end]
        rows.append(_frame(payload, scene, place) if kind == FRAME else _command(payload, place))
        if len(rows) > FRAMES:
            raise InvalidFile(f"rows of {thing}", f"more than {FRAMES}", f"{FRAMES} at most")
        at = end + SUM.size
    return tuple(rows), False


def _frame(payload: bytes, scene: Scene, place: str) -> Frame:
    links = sum(len(avatar.links) for avatar in scene.avatars)
    hinges = sum(avatar.hinge_count for avatar in scene.avatars)
    numbers = 1 + 7 * links + hinges
    if len(payload) != DIGEST + 8 * numbers:
        raise InvalidFile(f"bytes of {place}", len(payload), f"{DIGEST + 8 * numbers}, for {links} links and {hinges} hinges")
    values: Array = np.frombuffer(payload, dtype="<f8", offset=DIGEST).astype(np.float64)
    positions, rotations, angles = np.split(values[1:], [3 * links, 7 * links])
    sample = TrackerSample(float(values[0]), positions.reshape(links, 3), rotations.reshape(links, 4), angles)
    try:
        return Frame(checked(sample, scene.avatars), payload[:DIGEST].hex())
    except InvalidSample as error:
        raise InvalidFile(place, str(error), "a posture of the scene's avatars") from error


def _order(command: Command) -> dict[str, Any]:
    """Return a command as JSON."""
    values: dict[str, Any] = {"order": command.order.name}
    if command.order is Order.PINCH:
        values["on"] = command.value is True
    if isinstance(command.value, Switch):
        values |= {"off": list(command.value.off), "preset": command.value.preset, "options": _options(command.value.options)}
    return values


def _command(payload: bytes, place: str) -> Command:
    values = _parsed(payload, place)
    known = [order.name for order in RECORDED_ORDERS]
    if values.get("order") not in known:
        raise InvalidFile(f"order of {place}", values.get("order"), "one of " + ", ".join(known))
    order = Order[values["order"]]
    if order is Order.PINCH:
        if not isinstance(values.get("on"), bool):
            raise InvalidFile(f"switch of {place}", values.get("on"), "true or false")
        return Command(order, values["on"])
    if order is not Order.SWITCH:
        return Command(order)
    off, preset, options = values.get("off"), values.get("preset"), values.get("options")
    names = _names(off, f"effects of {place}")
    if not isinstance(preset, str) or not isinstance(options, dict):
        raise InvalidFile(f"settings of {place}", (preset, options), "the name of a preset and an object of options")
    return Command(order, Switch(names, preset, options))


def _names(value: object, thing: str) -> tuple[str, ...]:
    """Check a list of names of effects."""
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise InvalidFile(thing, value, "a list of names")
    return tuple(value)

