"""Acclaim skeleton files (ASF): bones with a direction, a length, a frame of their own and the turns of the joint they begin at.

As in Lander, *Working with Motion Capture File Formats* (Game Developer, 1998). A bone's turn is C M inverse(C), with C the frame
that `axis` states and M the turns of `dof`, the first letter of the order applied first. Bones begin where their parent ends.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets import caps
from avatarsim.assets.models.skeleton import Bone, Skeleton
from avatarsim.assets.motions import euler
from avatarsim.assets.motions.recording import Axes
from avatarsim.assets.motions.text import lines_of, number, numbered, numbers_in, quoted, readable, vector
from avatarsim.errors import InvalidFile
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

DEGREE = float(np.pi / 180.0)
INCH = 0.0254
"""Metres of an inch, the unit of ASF files once their numbers are divided by the `length` that they state."""

USUAL_LENGTH = 0.45
"""The `length` of nearly every file, and the default."""

ROOT = "root"

DOFS = {
    "rx": ("turn", 0), "ry": ("turn", 1), "rz": ("turn", 2),
    "tx": ("way", 0), "ty": ("way", 1), "tz": ("way", 2), "l": ("way", 3),
}
"""Kinds of a bone's numbers in AMC, in small letters: turns about an axis, translations along one, and along the bone."""


@dataclass
class AsfBone:
    """A bone as written in the file, in its units; of the root `length` is 0 and `position` where it begins.

    axis    angles of its frame, and `order` in which letters these and its turns are applied
    dof     its numbers in AMC, in that order, of DOFS
    limits  of each number"""

    name: str
    line: int
    direction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    length: float = 0.0
    axis: tuple[float, float, float] = (0.0, 0.0, 0.0)
    order: str = "xyz"
    dof: tuple[str, ...] = ()
    limits: list[tuple[float, float]] = field(default_factory=list)
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def turns(self) -> list[tuple[int, int]]:
        """Return (index among its numbers, axis) of each turn, the outermost first: the last letter of the order."""
        found = [(k, DOFS[dof][1]) for k, dof in enumerate(self.dof) if DOFS[dof][0] == "turn"]
        return sorted(found, key=lambda turn: -self.order.index("xyz"[turn[1]]))

    def frame(self, angle: float) -> Array:
        """Return C, the bone's frame at rest, in the file's axes; `angle` is its unit of angle [rad]."""
        axes = tuple("xyz".index(letter) for letter in reversed(self.order))
        return euler.quaternion(axes, np.array([self.axis["xyz".index(letter)] for letter in reversed(self.order)]) * angle)


@dataclass(frozen=True, eq=False)
class Asf:
    """A skeleton file: its bones, the root first and parents before children, the `parents` of each, and its units."""

    name: str
    bones: tuple[AsfBone, ...]
    parents: tuple[int, ...]
    length: float | None
    angle: float

    @property
    def unit(self) -> float:
        """Metres of a unit of length, as the file states it."""
        return INCH / (self.length or USUAL_LENGTH)

    def skeleton(self, axes: Axes) -> Skeleton:
        """Return the tree of bones in metres and with z up."""
        leaves = set(range(len(self.bones))) - set(self.parents)
        ends = [vector(axes.scale * axes.vectors(bone.length * np.array(bone.direction))) for bone in self.bones]
        found = []
        for k, (bone, parent) in enumerate(zip(self.bones, self.parents, strict=True)):
            turns, frame = bone.turns(), bone.frame(self.angle)
            found.append(Bone(
                readable(bone.name), parent, ends[parent] if parent >= 0 else (0.0, 0.0, 0.0),
                axes=tuple(vector(axes.vectors(rotation.rotate(frame, np.eye(3)[axis]))) for _, axis in turns),
                turns=tuple(bone.dof[place] for place, _ in turns), tips=(ends[k],) if k in leaves else (),
                limits=self._limits(bone, turns),
            ))
        return Skeleton(Path(self.name).stem, tuple(found))

    def _limits(self, bone: AsfBone, turns: list[tuple[int, int]]) -> tuple[tuple[float, float], ...]:
        """Return the file's limits [rad] of each turn; none where it states none."""
        if not bone.limits:
            return ()
        return tuple((bone.limits[place][0] * self.angle, bone.limits[place][1] * self.angle) for place, _ in turns)


def read_asf(path: str | Path) -> Asf:
    """Read the ASF file at `path`. Raises InvalidFile, by file and line."""
    path = Path(path)
    name = path.name
    sections = dict[str, list[tuple[int, str]]]()
    current: list[tuple[int, str]] | None = None
    for line, text in _lines(name, lines_of(path, "an ASF file")[0]):
        if text.startswith(":"):
            word, _, rest = text[1:].partition(" ")
            if word.lower() in sections:
                raise InvalidFile(f"section of line {line} of {name}", quoted(word), "each section once")
            current = sections[word.lower()] = [(line, rest.strip())] if rest.strip() else []
        elif current is None:
            raise InvalidFile(f"line {line} of {name}", quoted(text), "a section, such as :version, before all else")
        else:
            current.append((line, text))
    for wanted in ("root", "bonedata", "hierarchy"):
        if wanted not in sections:
            raise InvalidFile(f"sections of {name}", sorted(sections)[:20], f":{wanted} among them")
    length, angle = _units(name, sections.get("units", []))
    bones = [_root(name, sections["root"]), *_bones(name, sections["bonedata"])]
    ordered, parents = _tree(name, bones, sections["hierarchy"])
    return Asf(name, tuple(ordered), tuple(parents), length, angle)


def _lines(name: str, lines: list[str]) -> Iterator[tuple[int, str]]:
    """Yield (line, text) without comments and blank lines; lines count from 1."""
    stripped = ((line, text.partition("#")[0].strip()) for line, text in numbered(name, lines))
    return ((line, text) for line, text in stripped if text)


def _units(name: str, lines: list[tuple[int, str]]) -> tuple[float | None, float]:
    """Return the `length` that the section states, None if it states none, and the unit of angle [rad]."""
    length, angle = None, DEGREE
    for line, text in lines:
        at = f"line {line} of {name}"
        words = text.lower().split(None, 2)
        if words[0] == "length" and len(words) > 1:
            length = number(at, words[1])
            if not length > 0.0:
                raise InvalidFile(f"length in {at}", length, "above 0")
        elif words[0] == "angle" and len(words) > 1:
            angle = angle_unit(at, words[1])
        elif words[0] == "mass" and len(words) > 1 and not number(at, words[1]) > 0.0:
            raise InvalidFile(f"mass in {at}", quoted(words[1]), "above 0")
    return length, angle


def angle_unit(at: str, word: str) -> float:
    """Return the unit of angle [rad] that a word names."""
    if word.startswith("deg"):
        return DEGREE
    if word.startswith("rad"):
        return 1.0
    raise InvalidFile(f"unit of angle in {at}", quoted(word), "deg or rad")


def _triple(at: str, words: list[str]) -> tuple[float, float, float]:
    return vector(numbers_in(at, words[:3], 3, "3"))


def _order(at: str, word: str) -> str:
    if sorted(word.lower()) != ["x", "y", "z"]:
        raise InvalidFile(f"order of axes in {at}", quoted(word), "x, y and z in some order, as XYZ")
    return word.lower()


def _dof(at: str, words: list[str]) -> tuple[str, ...]:
    found = tuple(word.lower() for word in words)
    for k, word in enumerate(found):
        if word not in DOFS or word in found[:k]:
            raise InvalidFile(f"degree of freedom in {at}", quoted(word), f"one of {', '.join(DOFS)}, each once at most")
    return found


def _root(name: str, lines: list[tuple[int, str]]) -> AsfBone:
    root = AsfBone(ROOT, lines[0][0] if lines else 0)
    for line, text in lines:
        at = f"line {line} of {name}"
        word, *words = text.split(None, 9)
        if word.lower() == "order":
            root.dof = _dof(at, words)
        elif word.lower() == "axis":
            root.order = _order(at, words[0] if words else "")
        elif word.lower() == "position":
            root.position = _triple(at, words)
        elif word.lower() == "orientation":
            if any(_triple(at, words)):
                raise InvalidFile(f"orientation of root in {at}", quoted(text), "0 0 0: readers differ in what others mean")
    return root


def _bones(name: str, lines: list[tuple[int, str]]) -> list[AsfBone]:
    """Return the bones between `begin` and `end`, in the file's order."""
    found: list[AsfBone] = []
    bone: AsfBone | None = None
    for line, text in lines:
        at = f"line {line} of {name}"
        word, *words = text.split(None, 9)
        if word.lower() == "begin":
            if bone is not None:
                raise InvalidFile(at, quoted(text), "an end of the bone before")
            bone = AsfBone("", line)
        elif bone is None:
            raise InvalidFile(at, quoted(text), "begin")
        elif word.lower() == "end":
            found.append(_require_complete(name, bone, found))
            bone = None
        else:
            _parse_bone_line(at, text, word.lower(), words, bone)
    if bone is not None:
        raise InvalidFile(f"end of {name}", f"in the bone of line {bone.line}", "end after each begin")
    return found


def _parse_bone_line(at: str, text: str, word: str, words: list[str], bone: AsfBone) -> None:
    """Parse one line of a bone."""
    if word == "name":
        bone.name = text[len(word) :].strip()
        if not bone.name or len(bone.name) > caps.NAME or bone.name.lower() == ROOT:
            raise InvalidFile(f"name of a bone in {at}", quoted(bone.name), f"1 to {caps.NAME} characters, not {ROOT}")
    elif word == "direction":
        bone.direction = _triple(at, words)
    elif word == "length":
        bone.length = number(at, words[0] if words else "")
    elif word == "axis":
        bone.axis = _triple(at, words)
        bone.order = _order(at, words[3] if len(words) > 3 else "XYZ")
    elif word == "dof":
        bone.dof = _dof(at, words)
    elif word == "limits" or word.startswith("("):
        pairs = re.findall(r"\(\s*([^\s()]+)\s+([^\s()]+)\s*\)", text)
        found = [(_limit(at, low), _limit(at, high)) for low, high in pairs]
        for low, high in found:
            if not low <= high:
                raise InvalidFile(f"limits (lower, upper) in {at}", (low, high), "lower at most upper")
        bone.limits += found
    elif word == "bodymass":
        if not number(at, words[0] if words else "") >= 0.0:
            raise InvalidFile(f"bodymass in {at}", quoted(text), "0 or more")
    elif word not in ("id", "cofmass", "bodycolor", "radius"):
        raise InvalidFile(at, quoted(text), "id, name, direction, length, axis, dof, limits or end")


def _limit(at: str, word: str) -> float:
    return float(word) if word.lower() in ("inf", "-inf") else number(at, word)


def _require_complete(name: str, bone: AsfBone, before: list[AsfBone]) -> AsfBone:
    """Return the bone if it has all required values."""
    at = f"the bone of line {bone.line} of {name}"
    if not bone.name:
        raise InvalidFile(f"name of {at}", None, "a line name within it")
    same = [other.line for other in before if other.name == bone.name]
    if same:
        raise InvalidFile(f"name of {at}", bone.name, f"another than that of line {same[0]}")
    if len(before) >= caps.LINKS - 1:
        raise InvalidFile(f"bones of {name}", f"more than {caps.LINKS - 1} in line {bone.line}", f"up to {caps.LINKS - 1}")
    if bone.length < 0.0:
        raise InvalidFile(f"length of {bone.name}, {at}", bone.length, "0 or more")
    if bone.length > 0.0 and not any(bone.direction):
        raise InvalidFile(f"direction of {bone.name}, {at}", bone.direction, "not 0 0 0 for a bone with a length")
    if bone.limits and len(bone.limits) != len(bone.dof):
        raise InvalidFile(f"limits of {bone.name}, {at}", len(bone.limits), f"{len(bone.dof)}, one for each of its dof")
    return bone


def _tree(name: str, bones: list[AsfBone], lines: list[tuple[int, str]]) -> tuple[list[AsfBone], list[int]]:
    """Return the bones with parents before children, and their parents' places; every bone has a path to the root, once."""
    by_name = {bone.name: bone for bone in bones}
    children = dict[str, list[str]]()
    carried: set[str] = set()
    for line, text in lines:
        if text.lower() in ("begin", "end"):
            continue
        words = text.split(None, caps.LINKS + 1)
        for word in words:
            if word not in by_name:
                raise InvalidFile(f"bone in line {line} of {name}", quoted(word), "root or a name of :bonedata")
        for child in words[1:]:
            if child in carried or child == ROOT:
                valid = "bones that hang on one other, and not the root"
                raise InvalidFile(f"bone in line {line} of {name}", quoted(child), valid)
            carried.add(child)
            children.setdefault(words[0], []).append(child)
    ordered, parents = [bones[0]], [-1]
    waiting = [(child, 0) for child in reversed(children.get(ROOT, []))]
    while waiting:
        child, parent = waiting.pop()
        ordered.append(by_name[child])
        parents.append(parent)
        waiting += [(below, len(ordered) - 1) for below in reversed(children.get(child, []))]
    lost = [bone.name for bone in bones if bone not in ordered]
    if lost:
        valid = "none: :hierarchy hangs every bone on another, in no circle"
        raise InvalidFile(f"bones of {name} that do not hang on the root", lost[:20], valid)
    return ordered, parents
