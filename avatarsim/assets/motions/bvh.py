"""Biovision hierarchies (BVH): a tree of joints with offsets and channels, then a line of numbers a frame.

As in Meredith and Maddock, *Motion Capture File Formats Explained* (2001): turns of a joint are multiplied in the order of its
channels. A position channel replaces the offset along its axis, as in Blender and MotionBuilder; of a joint below the root only
if any of its channels is not zero throughout.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets import caps
from avatarsim.assets.models.anthropometry import BODY_MASS
from avatarsim.assets.models.model import Model
from avatarsim.assets.models.skeleton import Bone, Skeleton
from avatarsim.assets.motions.home import STILL, StatedHome
from avatarsim.assets.motions.measures import guessed
from avatarsim.assets.motions.recorded_file import RecordedFile
from avatarsim.assets.motions.recording import Axes, Recording, Track
from avatarsim.assets.motions.text import in_bytes, lines_of, number, numbered, numbers_in, quoted, readable, vector
from avatarsim.errors import InvalidFile
from avatarsim.scene.motion import Motion

Array = NDArray[np.float64]

DEGREE = float(np.pi / 180.0)

CHANNELS = {f"{axis}{kind}".lower(): (kind, k) for kind in ("position", "rotation") for k, axis in enumerate("XYZ")}
"""Names of channels, in small letters: their kind and axis."""

LONGEST_STEP = 10.0
"""Most seconds of a frame: slower ones are pictures, not a motion."""

END = -1
"""Marks an end site in place of a joint's number."""

BEARERS = ("root", "reference", "armature", "world", "origin", "skeleton", "scene")
"""Names of joints that only carry the hips."""


@dataclass
class _Joint:
    """A joint as written in the file: `channels` (kind, axis), and the index of its `first` column."""

    name: str
    parent: int
    line: int
    offset: tuple[float, float, float] | None = None
    channels: tuple[tuple[str, int], ...] | None = None
    first: int = 0
    tips: list[tuple[float, float, float]] = field(default_factory=list)
    children: int = 0

    def columns(self, kind: str) -> list[tuple[int, int]]:
        """Return (column, axis) of the channels of a kind, in their order."""
        return [(self.first + k, axis) for k, (of, axis) in enumerate(self.channels or ()) if of == kind]


@dataclass(frozen=True, eq=False, kw_only=True)
class BvhFile(RecordedFile):
    """A BVH file read whole.

    head       its text down to the line MOTION
    newline    its line ending
    step_text  its frame time as written"""

    head: str
    newline: str
    step_text: str
    format: str = "bvh"

    def written(self, motion: Motion, model: Model) -> bytes:
        """Return the file with this motion: hierarchy and channels as they were, numbers with all their digits.

        Joints that the motion does not change keep their numbers. Raises InvalidFile unless `model` has the file's joints,
        and InvalidInput for steps that differ from each other."""
        self.require_own(model)
        values, step = self.recording.rows(motion)
        step_text = self.step_text if step == self.recording.step else repr(step)
        lines = [self.head, f"Frames: {len(values)}", f"Frame Time: {step_text}"]
        lines += [" ".join(map(repr, row)) for row in values.tolist()]
        return in_bytes(self.newline.join(lines) + self.newline)


def read_bvh(
    path: str | Path, *, scale: float | None = None, up: str | None = None, offsets: str = "refuse", mass: float = BODY_MASS,
    limits: bool = True, home: int | str | Path | None = None,
) -> BvhFile:
    """Read the BVH file at `path`.

    scale    metres of a unit of length; by default guessed from the height of the skeleton
    up       "y" or "z"; by default guessed from the postures
    offsets  "mean" takes the mean of places of joints on their parents that vary; by default they are refused
    mass     of the avatar [kg]
    limits   whether its joints of known name get their range of motion
    home     the frame, from 0, or a clip of the same skeleton ("walk.bvh", "walk.bvh:12"), that stature, ranges of motion and
             pairs at rest are measured from; by default the skeleton at rest, or the most upright frame where it is folded

    Raises InvalidFile for an invalid BVH file, by line, and for a unit that cannot be guessed."""
    path = Path(path)
    name = path.name
    lines, newline = lines_of(path, "a BVH file")
    if offsets not in ("refuse", "mean"):
        raise InvalidFile(f"offsets of {name}", offsets, '"refuse" or "mean"')
    joints, motion_at = _hierarchy(name, lines)
    values, step_text = _frames(name, lines, motion_at, joints)
    stated = StatedHome.of(name, home, len(values))
    other = None
    if stated.file is not None:
        other = read_bvh(stated.file, scale=scale, up=up, offsets=offsets, home=stated.frame)
        scale, up = other.recording.axes.scale, other.recording.axes.up
    # a short excerpt does not show how the root moves
    root = min(len(other.recording.above), len(joints) - 1) if other else _carried(joints, values)

    def made(axes: Axes) -> Recording:
        return _recording(name, joints, root, values, float(step_text), axes)

    axes, notes = guessed(name, lambda axes: stated.measured(made(axes)), DEGREE, scale, up)
    notes += _on_parents(name, joints, root, values, axes.scale, offsets)
    recording, at_home, home_notes = stated.applied(made(axes), (other.recording, other.home) if other else None)
    notes += home_notes
    if root:
        notes.append(f"{joints[root].name} is the avatar's root: {joints[0].name} above it only carries it about")
    return BvhFile(
        name=name, recording=recording, home=at_home, notes=tuple(notes), mass=mass, limits=limits,
        head=newline.join(lines[:motion_at]), newline=newline, step_text=step_text,
    )


def _statements(name: str, lines: list[str]) -> Iterator[tuple[int, str]]:
    """Yield (line, statement) of a hierarchy, braces by themselves; lines count from 1."""
    for line, text in numbered(name, lines):
        for piece in re.split(r"([{}])", text):
            if piece.strip():
                yield line, piece.strip()


def _hierarchy(name: str, lines: list[str]) -> tuple[list[_Joint], int]:
    """Return the joints, parents first, and the count of lines before the frames. Raises InvalidFile."""
    joints: list[_Joint] = []
    stack: list[int] = []
    awaited: int | None = None
    begun = False
    for line, text in _statements(name, lines):
        words = text.split(None, 7)
        word = words[0].lower()
        at = f"line {line} of {name}"
        if not begun:
            if text.lower() != "hierarchy":
                raise InvalidFile(at, quoted(text), "HIERARCHY, with which a BVH file begins")
            begun = True
        elif awaited is not None:
            if text != "{":
                raise InvalidFile(at, quoted(text), "{ after the name of a joint")
            stack.append(awaited)
            awaited = None
        elif word == "motion" and not stack:
            return _number_columns(name, joints), line
        elif word in ("root", "joint"):
            awaited = _open(at, name, text, word, joints, stack, line)
        elif word == "end" and len(words) > 1 and words[1].lower() == "site":
            if not stack or stack[-1] < 0:
                raise InvalidFile(at, text, "an end site within a joint")
            awaited = END
        elif text == "}":
            if not stack:
                raise InvalidFile(at, text, "a } for a { only")
            stack.pop()
        elif word == "offset" and stack:
            _offset(at, words, joints, stack)
        elif word == "channels" and stack and stack[-1] >= 0:
            _channels(at, text, joints, joints[stack[-1]])
        else:
            raise InvalidFile(at, quoted(text), "ROOT, JOINT, End Site, OFFSET, CHANNELS, a brace, or MOTION after the last one")
    open_joint = f", with {joints[stack[-1]].name} of line {joints[stack[-1]].line} open" if stack and stack[-1] >= 0 else ""
    raise InvalidFile(f"end of {name}", f"in the hierarchy{open_joint}", "a line MOTION and frames after it")


def _open(at: str, name: str, text: str, word: str, joints: list[_Joint], stack: list[int], line: int) -> int:
    """Begin a joint and return its number."""
    joint_name = readable(text[len(word) :].strip())
    if not joint_name or len(joint_name) > caps.NAME:
        raise InvalidFile(f"name of a joint in {at}", quoted(joint_name), f"1 to {caps.NAME} characters")
    if (word == "root") != (not joints):
        raise InvalidFile(at, quoted(text), "one ROOT, before every JOINT")
    if word == "joint" and (not stack or stack[-1] == END):
        raise InvalidFile(at, quoted(text), "a JOINT within the braces of another")
    if len(joints) >= caps.LINKS:
        raise InvalidFile(f"joints of {name}", f"more than {caps.LINKS} in line {line}", f"up to {caps.LINKS}")
    same = [joint.line for joint in joints if joint.name == joint_name]
    if same:
        raise InvalidFile(f"name of a joint in {at}", joint_name, f"another than that of line {same[0]}")
    joints.append(_Joint(joint_name, stack[-1] if stack else -1, line))
    if stack:
        joints[stack[-1]].children += 1
    return len(joints) - 1


def _offset(at: str, words: list[str], joints: list[_Joint], stack: list[int]) -> None:
    """Parse an OFFSET line: of a joint, or of the end site within one."""
    top = stack[-1]
    place = vector(numbers_in(at, words[1:], 3, "3", "numbers after OFFSET"))
    if top == END:
        joints[stack[-2]].tips.append(place)
    elif joints[top].offset is not None:
        raise InvalidFile(at, " ".join(words), f"one OFFSET for {joints[top].name}")
    else:
        joints[top].offset = place


def _channels(at: str, text: str, joints: list[_Joint], joint: _Joint) -> None:
    """Parse a CHANNELS line."""
    words = text.split(None, 9)
    count = words[1] if len(words) > 1 else ""
    if not re.fullmatch(r"[0-6]", count):
        raise InvalidFile(f"number of channels in {at}", quoted(count), "0 to 6")
    names = [word.lower() for word in words[2:]]
    if len(names) != int(count):
        raise InvalidFile(f"channels listed in {at}", len(names), f"{count}, as it says")
    for k, channel in enumerate(names):
        if channel not in CHANNELS or channel in names[:k]:
            valid = "Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation, each once at most"
            raise InvalidFile(f"channel in {at}", quoted(words[2 + k]), valid)
    if joint.channels is not None:
        raise InvalidFile(at, quoted(text), f"one CHANNELS for {joint.name}")
    joint.channels = tuple(CHANNELS[channel] for channel in names)


def _number_columns(name: str, joints: list[_Joint]) -> list[_Joint]:
    """Return the joints with their columns counted; InvalidFile for none, and for one that lacks a line."""
    if not joints:
        raise InvalidFile(f"joints of {name}", 0, "a ROOT at least")
    first = 0
    for joint in joints:
        for line, found in (("OFFSET", joint.offset), ("CHANNELS", joint.channels)):
            if found is None:
                thing = f"{line} of {joint.name}, line {joint.line} of {name}"
                raise InvalidFile(thing, None, f"a line {line} within its braces")
        joint.first = first
        first += len(joint.channels or ())
    return joints


def _frames(name: str, lines: list[str], first: int, joints: list[_Joint]) -> tuple[Array, str]:
    """Return the numbers (F, columns) and the frame time as written. Raises InvalidFile."""
    rest = list(numbered(name, lines, first))
    count, at_count = _match_line(name, rest, 0, r"frames\s*:?\s*(\S+)", "Frames: and how many there are")
    step, at_step = _match_line(name, rest, 1, r"frame\s*time\s*:?\s*(\S+)", "Frame Time: and the seconds of a frame")
    if not (re.fullmatch(r"\+?\d{1,12}", count) and 1 <= int(count) <= caps.FRAMES):
        raise InvalidFile(f"number of frames in {at_count}", quoted(count), f"1 to {caps.FRAMES}")
    rows = rest[2:]
    if len(rows) != int(count):
        raise InvalidFile(f"lines of frames in {name}", len(rows), f"{int(count)}, as {at_count} says")
    seconds = number(at_step, step)
    if not (0.0 < seconds <= LONGEST_STEP or (seconds == 0.0 and len(rows) == 1)):
        raise InvalidFile(f"frame time in {at_step} [s]", quoted(step), f"above 0, up to {LONGEST_STEP:g}")
    columns = sum(len(joint.channels or ()) for joint in joints)
    values, valid = np.empty((len(rows), columns)), f"{columns}, as many as there are channels"
    for k, (line, text) in enumerate(rows):
        values[k] = numbers_in(f"line {line} of {name}", text.split(), columns, valid)
    return values, step


def _match_line(name: str, rest: list[tuple[int, str]], k: int, pattern: str, valid: str) -> tuple[str, str]:
    """Match line k after MOTION with a pattern; return the value, and the line's name in errors."""
    if k >= len(rest):
        raise InvalidFile(f"end of {name}", "after MOTION", valid)
    line, text = rest[k]
    found = re.fullmatch(pattern, quoted(text.strip()), re.IGNORECASE)
    if not found:
        raise InvalidFile(f"line {line} of {name}", text.strip()[:80], valid)
    return found[1], f"line {line} of {name}"


def _carried(joints: list[_Joint], values: Array) -> int:
    """Return the joint that is the avatar's root: the file's, or one below it that is carried by joints of no other use."""
    root = k = 0
    while joints[k].children == 1 and not joints[k].tips:
        k = next(child for child, joint in enumerate(joints) if joint.parent == k)
        columns = [column for column, _ in joints[k].columns("position")]
        if not columns:
            continue
        bearer = joints[joints[k].parent].name.lower().rpartition(":")[2] in BEARERS
        if bearer or np.ptp(values[:, columns], axis=0).max() > STILL:
            root = k
    return root


def _place(joint: _Joint, values: Array, replaces: bool) -> tuple[tuple[int, int, int], tuple[float, float, float]]:
    """Return columns of a joint's place, -1 where there is none, and its start (`Track`): the offset, but 0 along the axes whose
    channels replace it. They do where ``replaces``, and where one of them is ever not zero."""
    assert joint.offset is not None
    columns, start = [-1, -1, -1], list(joint.offset)
    channels = joint.columns("position")
    added = not replaces and all(not values[:, column].any() for column, _ in channels)
    if not added:
        for column, axis in channels:
            columns[axis], start[axis] = column, 0.0
    return (columns[0], columns[1], columns[2]), (start[0], start[1], start[2])


def _recording(name: str, joints: list[_Joint], root: int, values: Array, step: float, axes: Axes) -> Recording:
    """Return the clip on its skeleton, in metres and with z up by `axes`; places of joints below the root are their means."""
    bones, tracks = [], []
    for k, joint in enumerate(joints[root:], root):
        columns, start = _place(joint, values, k == root)
        turns = tuple(joint.columns("rotation"))
        tracks.append(Track(columns, start, turns))
        mean = np.array([values[:, c].mean() if c >= 0 else 0.0 for c in columns]) + np.array(start)
        unit = np.eye(3)
        bones.append(Bone(
            joint.name, joint.parent - root if k > root else -1, _metres(axes, mean),
            axes=tuple(vector(axes.vectors(unit[axis])) for _, axis in turns),
            turns=tuple(f"{'XYZ'[axis]}rotation" for _, axis in turns),
            tips=tuple(_metres(axes, np.array(tip)) for tip in joint.tips),
        ))
    carriers = tuple(Track(*_place(joints[k], values, True), tuple(joints[k].columns("rotation"))) for k in range(root))
    return Recording(name, Skeleton(Path(name).stem, tuple(bones)), tuple(tracks), values, step, axes, carriers)


def _metres(axes: Axes, array: Array) -> tuple[float, float, float]:
    return vector(axes.scale * axes.vectors(array))


def _on_parents(name: str, joints: list[_Joint], root: int, values: Array, scale: float, offsets: str) -> list[str]:
    """Return sentences on the places of joints below the root; InvalidFile for one that varies, unless its mean is requested."""
    notes, added, meant = [], [], []
    for joint in joints[root + 1 :]:
        channels = joint.columns("position")
        if not channels:
            continue
        columns = [column for column, _ in channels]
        ways = scale * np.ptp(values[:, columns], axis=0)
        if not values[:, columns].any():
            added.append(joint.name)
        elif not (ways <= STILL).all():
            if offsets != "mean":
                thing = f"way of {joint.name} on its parent in {name} [m]"
                raise InvalidFile(thing, float(ways.max()), f'up to {STILL:g}, or offsets="mean" for the mean of its places')
            mean = values[:, columns].mean(axis=0)
            off = scale * float(np.linalg.norm(values[:, columns] - mean, axis=1).max())
            meant.append(f"{joint.name} (up to {1e3 * off:.3g} mm off)")
    if added:
        notes.append(f"places of joints that are zero throughout are taken as added to their offsets: {', '.join(added)}")
    if meant:
        notes.append(f"joints that move on their parents sit at the mean of their places: {', '.join(meant)}")
    return notes
