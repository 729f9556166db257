"""Strict parsing of tracker samples: JSON (RFC 8259) or packed little-endian numbers, and poses written the same two ways.

A message is a posture of all links, or goals for some of them. Everything else is refused for one stated reason (`Refusal`):
valid input is described exactly, nothing is guessed (language-theoretic security; Sassaman and others 2013). docs/live_ports.md
has the formats.
"""

import json
import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NoReturn, Self

import numpy as np
from numpy.typing import NDArray

from avatarsim.files import shallow
from avatarsim.live.messages import State
from avatarsim.live.ports.refusals import Refusal, Refused
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample

Array = NDArray[np.float64]

SAMPLE, POSES, VERSION = b"AVTS", b"AVPO", 1
"""First bytes of a packed sample and of packed poses, and the version of both."""
HEAD = struct.Struct("<4sHHII")
"""Head of a packed sample: magic, version, bytes of a number (4 or 8), links, hinges."""
POSES_HEAD = struct.Struct("<4sHHIIQd")
"""Head of packed poses: magic, version, bytes of a number, bodies, hinges, frame, time [s]."""
WIDTHS = {4: "<f4", 8: "<f8"}
"""Formats of numbers by their bytes."""

MOST_METRES = 1e3
"""Largest coordinate [m] of a tracker: no tracked space is that wide, and millimetres taken for metres are far beyond it."""
MOST_RADIANS = 1e3
"""Largest angle [rad] of a hinge: 159 turns; a cap cannot detect degrees taken for radians."""
UNIT = 1e-3
"""Largest deviation of the length of a quaternion from 1: four printed digits are within it; it is then normalised."""

DEEPEST = 4
"""Levels of the deepest message: an object of goals by name, each of which is an object with lists."""
NUMBER_BYTES = 32
"""Bytes of a number in JSON: sign, 17 digits, point and exponent take 24, comma, blank and its share of brackets the rest."""
KEY_BYTES = 128
"""Bytes of the keys and brackets of one goal in addition to the link's name, and of a message in addition to its rows."""
QUOTED = 60
"""Bytes of a message that a refusal quotes."""


@dataclass(frozen=True)
class Shape:
    """Shape of messages.

    links    names of the links of a sample in the scene's order, `avatar/link`, or the avatar's name where it has one link
    links    names of the links of a sample in the scene's order, `avatar/link`, or the avatar's name if it has one link
    bodies   names of all bodies and links in the order of poses
    handles  names that goals may have: these links, and moving bodies, whose poses are not in a sample
    """

    links: tuple[str, ...]
    hinges: int
    bodies: tuple[str, ...]
    handles: tuple[str, ...]

    @classmethod
    def of(cls, scene: Scene) -> Self:
        """Return the shape for a scene."""
        handles = scene.names[len(scene.bodies) :]
        moves = [avatar.moves for avatar in scene.avatars for _ in avatar.links]
        links = tuple(name for name, its in zip(handles, moves, strict=True) if not its)
        hinges = sum(avatar.hinge_count for avatar in scene.avatars if not avatar.moves)
        return cls(links, hinges, scene.names, handles)

    @cached_property
    def canonical(self) -> Mapping[str, str]:
        """Canonical name of each name that a goal may have: that one, or a link's own if no other link has it."""
        names: dict[str, list[str]] = {}
        for link in self.handles:
            names.setdefault(link.rpartition("/")[2], []).append(link)
        short = {name: found[0] for name, found in names.items() if len(found) == 1}
        return {**short, **{link: link for link in self.handles}}

    @cached_property
    def most_bytes(self) -> int:
        """Bytes of the longest message that is read: all numbers or all links with goals as JSON, at generous lengths."""
        names = sum(len(json.dumps(link)) for link in self.handles)
        return KEY_BYTES * (len(self.handles) + 1) + names + NUMBER_BYTES * (7 * len(self.handles) + self.hinges)


@dataclass(frozen=True, eq=False)
class Goal:
    """Goal of a link: `position` (3,) [m] and `orientation` (4,), of unit length, in the world; None leaves it free."""

    position: Array
    orientation: Array | None = None


@dataclass(frozen=True, eq=False)
class Goals:
    """Goals of single links by canonical name. They replace all of the message before: a link that is not named is released."""

    links: Mapping[str, Goal]


def parse(data: bytes | str, shape: Shape) -> TrackerSample | Goals:
    """Parse a tracker message: packed numbers if it begins with their magic, else JSON. A sample's time is 0 and is ignored.
    Raises Refused, and nothing else, if it is no valid message or does not fit `shape`."""
    if len(data) > shape.most_bytes:
        raise Refused(Refusal.TOO_LONG, "length of a message [bytes]", len(data), f"at most {shape.most_bytes} for this scene")
    if isinstance(data, bytes):
        if data[:4] == SAMPLE:
            return _packed(data, shape)
        if data.lstrip(b" \t\r\n")[:1] != b"{":
            raise Refused(Refusal.WRONG_MAGIC, "first bytes of a message", data[:4], f"{SAMPLE!r}, or {{ of a JSON object")
        try:
            data = data.decode("utf-8")
        except UnicodeDecodeError as error:
            raise Refused(Refusal.NOT_TEXT, "a message", data[:QUOTED], f"UTF-8 (wrong at byte {error.start})") from None
    message = _json(data)
    if not isinstance(message, dict):
        raise Refused(Refusal.WRONG_TYPE, "a message", _short(message), "a JSON object")
    return _goals(message, shape) if "links" in message else _sample(message, shape)


def _short(value: object) -> str:
    """Return the part of a value that a refusal quotes; its depth and length may be anything."""
    if isinstance(value, str):
        return value[:QUOTED]
    return type(value).__name__ if isinstance(value, dict | list) else repr(value)[:QUOTED]


def _json(text: str) -> object:
    """Parse JSON with all numbers as floats. Python's own reader accepts NaN and duplicate keys, which are refused here."""
    try:
        value: object = shallow(json.loads(text, object_pairs_hook=_object, parse_constant=_constant, parse_int=float), DEEPEST)
    except RecursionError:
        raise Refused(Refusal.TOO_DEEP, "nesting of a message", text[:QUOTED], f"at most {DEEPEST} levels") from None
    except ValueError as error:
        reason = error.msg if isinstance(error, json.JSONDecodeError) else type(error).__name__
        raise Refused(Refusal.NOT_JSON, "a message", text[:QUOTED], f"JSON ({reason})") from None
    return value


def _object(pairs: list[tuple[str, object]]) -> dict[str, object]:
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise Refused(Refusal.DUPLICATE, "key of a message", twice[:QUOTED], "each key once")
    return found


def _constant(word: str) -> NoReturn:
    raise Refused(Refusal.NOT_FINITE, "number of a message", word, "a finite number")


def _keys(thing: str, keys: Mapping[str, object], needed: Sequence[str], allowed: Sequence[str]) -> None:
    """Refuse missing and unknown keys."""
    valid = f"the keys {', '.join(allowed)}"
    for name in keys:
        if name not in allowed:
            raise Refused(Refusal.UNKNOWN_KEY, f"key of {thing}", name[:QUOTED], valid)
    for name in needed:
        if name not in keys:
            raise Refused(Refusal.MISSING_KEY, f"keys of {thing}", sorted(keys), valid)


def _sample(message: Mapping[str, object], shape: Shape) -> TrackerSample:
    allowed = ("positions", "rotations", "angles")
    _keys("a message", message, allowed if shape.hinges else allowed[:2], (*allowed, "links"))
    positions, rotations = (
        np.array(_rows(name, message[name], len(shape.links), width), dtype=np.float64).reshape(-1, width)
        for name, width in (("positions", 3), ("rotations", 4))
    )
    angles = np.array(_numbers("angles", message.get("angles", []), shape.hinges), dtype=np.float64)
    return _capped(positions, rotations, angles)


def _rows(thing: str, value: object, count: int, width: int) -> list[list[float]]:
    rows = _list(thing, value, count, "rows")
    return [_numbers(f"row of {thing}", row, width) for row in rows]


def _numbers(thing: str, value: object, count: int) -> list[float]:
    """Return a list of `count` numbers; caps are checked elsewhere. True and false are no numbers."""
    found = []
    for number in _list(thing, value, count, "numbers"):
        # the reader makes every number of a message a float
        if not isinstance(number, float):
            raise Refused(Refusal.WRONG_TYPE, f"number of {thing}", _short(number), "a number")
        found.append(number)
    return found


def _list(thing: str, value: object, count: int, what: str) -> list[object]:
    if not isinstance(value, list):
        raise Refused(Refusal.WRONG_TYPE, thing, _short(value), f"a list of {count} {what}")
    if len(value) != count:
        raise Refused(Refusal.WRONG_LENGTH, f"length of {thing}", len(value), f"{count} {what} in this scene")
    return value


def _capped(positions: Array, rotations: Array, angles: Array) -> TrackerSample:
    """Return a sample whose numbers are finite and within their caps, with rotations of length 1."""
    for thing, numbers, cap in (
        ("positions [m]", positions, MOST_METRES), ("rotations", rotations, 1.0 + UNIT), ("angles [rad]", angles, MOST_RADIANS)
    ):
        if np.isnan(numbers).any():
            raise Refused(Refusal.NOT_FINITE, f"number of {thing}", math.nan, "a finite number")
        worst = float(np.abs(numbers).max(initial=0.0))
        if not worst <= cap:
            # a number of too many digits is read as infinity, which packed numbers can also contain
            reason = Refusal.NOT_A_ROTATION if thing == "rotations" and worst < math.inf else Refusal.TOO_LARGE
            raise Refused(reason, f"largest of {thing}", worst, f"from {-cap:g} to {cap:g}")
    lengths = np.sqrt(np.einsum("ij,ij->i", rotations, rotations))
    if not (np.abs(lengths - 1.0) <= UNIT).all():
        worst_row = rotations[int(np.argmax(np.abs(lengths - 1.0)))].tolist()
        valid = f"a quaternion (w, x, y, z) of length 1, within {UNIT:g}"
        raise Refused(Refusal.NOT_A_ROTATION, "row of rotations", worst_row, valid)
    return TrackerSample(0.0, positions, rotations / lengths[:, None], angles)


def _goals(message: Mapping[str, object], shape: Shape) -> Goals:
    _keys("a message of goals", message, ("links",), ("links",))
    links = message["links"]
    if not isinstance(links, dict):
        raise Refused(Refusal.WRONG_TYPE, "links", _short(links), "an object of goals by the names of links")
    goals: dict[str, Goal] = {}
    for name, goal in links.items():
        link = shape.canonical.get(name)
        if link is None:
            known = ", ".join(shape.links[:8]) + (" and others" if len(shape.links) > 8 else "")
            raise Refused(Refusal.UNKNOWN_LINK, "name of a link", name[:QUOTED], f"one of {known}")
        if link in goals:
            raise Refused(Refusal.DUPLICATE, "link with a goal", link, "each link once, by its short or its whole name")
        goals[link] = _goal(f"goal of {link}", goal)
    return Goals(goals)


def _goal(thing: str, value: object) -> Goal:
    if not isinstance(value, dict):
        raise Refused(Refusal.WRONG_TYPE, thing, _short(value), "an object with a position")
    _keys(thing, value, ("position",), ("position", "rotation"))
    place = np.array([_numbers(f"position in the {thing}", value["position"], 3)])
    turned = value.get("rotation")
    row = [1.0, 0.0, 0.0, 0.0] if turned is None else _numbers(f"rotation in the {thing}", turned, 4)
    sample = _capped(place, np.array([row]), np.zeros(0))
    return Goal(sample.positions[0], None if turned is None else sample.rotations[0])


def _packed(data: bytes, shape: Shape) -> TrackerSample:
    if len(data) < HEAD.size:
        raise Refused(Refusal.WRONG_LENGTH, "length of a packed sample [bytes]", len(data), f"at least its head's {HEAD.size}")
    _, version, width, links, hinges = HEAD.unpack_from(data)
    if version != VERSION or width not in WIDTHS:
        raise Refused(Refusal.WRONG_VERSION, "version and width of a packed sample", (version, width), f"{VERSION}, and 4 or 8")
    if (links, hinges) != (len(shape.links), shape.hinges):
        wanted = (len(shape.links), shape.hinges)
        raise Refused(Refusal.WRONG_LENGTH, "links and hinges of a packed sample", (links, hinges), f"{wanted} in this scene")
    count = 7 * links + hinges
    if len(data) != HEAD.size + width * count:
        valid = f"{HEAD.size + width * count} bytes for {links} links and {hinges} hinges"
        raise Refused(Refusal.WRONG_LENGTH, "length of a packed sample [bytes]", len(data), valid)
    # a signalling NaN of single precision is no error of the conversion
    with np.errstate(invalid="ignore"):
        numbers = np.frombuffer(data, WIDTHS[width], count, HEAD.size).astype(np.float64)
    if not np.isfinite(numbers).all():
        raise Refused(Refusal.NOT_FINITE, "number of a packed sample", "nan or infinity", "a finite number")
    positions, rotations, angles = np.split(numbers, (3 * links, 7 * links))
    return _capped(positions.reshape(links, 3), rotations.reshape(links, 4), angles)


@lru_cache(maxsize=1)
def packed_poses(state: State) -> bytes:
    """Return a state as packed numbers of 4 bytes, once for all clients: head, positions (n, 3), orientations (n, 4), angles."""
    head = POSES_HEAD.pack(POSES, VERSION, 4, len(state.positions), len(state.angles), state.frame, state.time)
    return head + b"".join(array.astype("<f4").tobytes() for array in (state.positions, state.orientations, state.angles))


@lru_cache(maxsize=1)
def json_poses(state: State) -> str:
    """Return a state as JSON, once for all clients: frame, time [s], positions (n, 3) [m], orientations (n, 4), angles."""
    return json.dumps({
        "frame": state.frame, "time": state.time, "positions": state.positions.tolist(),
        "orientations": state.orientations.tolist(), "angles": state.angles.tolist(),
    })
