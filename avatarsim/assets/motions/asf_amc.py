"""Acclaim motion files (AMC): frame by frame the numbers of every bone of a skeleton file (ASF) in the folder."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets import caps
from avatarsim.assets.models.anthropometry import BODY_MASS
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.asf import DOFS, Asf, angle_unit, read_asf
from avatarsim.assets.motions.home import STILL, StatedHome
from avatarsim.assets.motions.measures import SHORTEST, TALLEST, guessed, standing
from avatarsim.assets.motions.recorded_file import RecordedFile
from avatarsim.assets.motions.recording import Axes, Recording, Track
from avatarsim.assets.motions.text import in_bytes, lines_of, numbered, numbers_in, quoted
from avatarsim.errors import InvalidFile
from avatarsim.scene.motion import Motion

Array = NDArray[np.float64]

USUAL_RATE = 120.0
"""Frames a second of CMU's recordings, and of most others in this format, which cannot state them."""

FASTEST_RATE = 10_000.0
"""Most frames a second: no camera that sees a whole human takes more."""

NOTICED = 1e-4
"""Degrees beyond a limit from which they count: files state six digits."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AmcFile(RecordedFile):
    """An AMC file read whole, on its skeleton.

    head   its lines before the first frame
    first  the number of that frame
    order  the bones, as each frame lists them, and their columns"""

    head: str
    first: int
    order: tuple[tuple[str, slice], ...]
    newline: str
    format: str = "amc"

    def written(self, motion: Motion, model: Model) -> bytes:
        """Return the file with this motion: header and order of bones as they were, numbers with all their digits.

        Bones that the motion does not change keep their numbers. The format cannot state a rate, which the reader of a
        resampled motion must know. Raises InvalidFile unless `model` has the file's joints, and InvalidInput for steps that
        differ."""
        self.require_own(model)
        values, _ = self.recording.rows(motion)
        lines = [self.head] if self.head else []
        for frame, row in enumerate(values.tolist(), self.first):
            lines.append(str(frame))
            lines += [" ".join([bone, *map(repr, row[columns])]) for bone, columns in self.order]
        return in_bytes(self.newline.join(lines) + self.newline)


def read_amc(
    path: str | Path, *, skeleton: str | Path | None = None, rate: float | None = None, scale: float | None = None,
    up: str | None = None, mass: float = BODY_MASS, limits: bool = True, home: int | str | Path | None = None,
) -> AmcFile:
    """Read the AMC file at `path` on its skeleton.

    skeleton  the ASF file; by default the one next to it of that name, or of the name up to the first underscore
    rate      frames a second; by default 120
    scale     metres of a unit of length; by default as the ASF file states it, if a human of that size exists, else guessed
    up        "y" or "z"; by default guessed of the postures
    mass      of the avatar [kg]
    limits    whether its joints have their range of motion
    home      the frame, from 0, or another clip of the same skeleton ("walk.amc:12") that it is measured from, as of BVH files

    Raises InvalidFile for a file that is invalid or does not fit the skeleton, and names its line."""
    path = Path(path)
    asf_path = skeleton_next_to(path) if skeleton is None else Path(skeleton)
    if asf_path is None:
        wanted = " or ".join(f"{stem}.asf" for stem in _stems(path))
        raise InvalidFile(f"skeleton of {path.name}", None, f"{wanted} beside it, or skeleton= with the ASF file")
    asf = read_asf(asf_path)
    notes = [] if skeleton is not None else [f"skeleton of {path.name}: {asf_path.name} beside it; skeleton= names another"]
    if rate is None:
        rate = USUAL_RATE
        notes.append(f"rate of {path.name}: {rate:g} frames a second, as CMU's; the format does not state it, rate= does")
    if not (isinstance(rate, (int, float)) and 0.0 < rate <= FASTEST_RATE):
        raise InvalidFile(f"rate of {path.name} [1/s]", rate, f"above 0, up to {FASTEST_RATE:g}")
    lines, newline = lines_of(path, "an AMC file")
    head, angle = _header(path.name, lines, asf)
    first, order, values = _frames(path.name, lines, head, asf)
    tracks = _tracks(asf, dict(order))

    def made(axes: Axes) -> Recording:
        return Recording(path.name, asf.skeleton(axes), tracks, values, 1.0 / rate, axes)

    stated = StatedHome.of(path.name, home, len(values))
    other = None
    if stated.file is not None:
        other = read_amc(stated.file, skeleton=asf_path, rate=rate, scale=scale, up=up, home=stated.frame)
        scale, up = other.recording.axes.scale, other.recording.axes.up
    axes, guesses = _axes(path.name, asf, lambda axes: stated.measured(made(axes)), angle, scale, up)
    _require_fixed(path.name, asf, dict(order), values, axes.scale)
    guesses += _beyond_stated(path.name, asf, dict(order), values, angle)
    recording, at_home, home_notes = stated.applied(made(axes), (other.recording, other.home) if other else None)
    return AmcFile(
        name=path.name, recording=recording, home=at_home, notes=(*notes, *guesses, *home_notes), mass=mass, limits=limits,
        head=newline.join(lines[:head]), first=first, order=tuple(order), newline=newline,
    )


def skeleton_next_to(path: Path) -> Path | None:
    """Return the skeleton file that belongs to a motion file by their names: 02_01.asf or 02.asf next to 02_01.amc."""
    places = (path.with_name(stem + suffix) for stem in _stems(path) for suffix in (".asf", ".ASF"))
    return next((place for place in places if place.is_file()), None)


def _stems(path: Path) -> list[str]:
    return list(dict.fromkeys((path.stem, path.stem.partition("_")[0])))


def _header(name: str, lines: list[str], asf: Asf) -> tuple[int, float]:
    """Return the count of lines before the first frame, and the unit of angle [rad]: the file's own, else its skeleton's."""
    angle = asf.angle
    for line, text in numbered(name, lines):
        header = quoted(text.strip()).lower()
        if header.startswith(":") and header[1:4] in ("deg", "rad"):
            angle = angle_unit(f"line {line} of {name}", header[1:])
        elif not header.startswith((":", "#")):
            return line - 1, angle
    raise InvalidFile(f"end of {name}", "before the first frame", "a line with the number of a frame")


def _frames(name: str, lines: list[str], head: int, asf: Asf) -> tuple[int, list[tuple[str, slice]], Array]:
    """Return the first frame's number, the columns of each bone, and the numbers (F, columns). Raises InvalidFile."""
    bones = {bone.name: bone for bone in asf.bones}
    order = dict[str, slice]()
    rows: list[Array] = []
    values: Array | None = None
    seen: set[str] = set()
    first = 0
    for line, text in numbered(name, lines, head):
        if text.startswith("#"):
            continue
        at, words = f"line {line} of {name}", text.split()
        if len(words) == 1 and words[0].isdecimal():
            _require_complete(name, order, seen, len(rows), line)
            first = _frame_number(at, words[0], len(rows), first)
            values = np.empty(sum(columns.stop - columns.start for columns in order.values()))
            rows.append(values)
            seen = set()
            continue
        bone = bones.get(words[0])
        if values is None or bone is None or words[0] in seen:
            valid = f"the number of a frame, or a bone of {asf.name}, once a frame"
            raise InvalidFile(f"first word of {at}", quoted(words[0]), valid)
        seen.add(words[0])
        numbers = numbers_in(at, words[1:], len(bone.dof), f"{len(bone.dof)}: {' '.join(bone.dof)}", f"numbers of {bone.name}")
        if len(rows) == 1:
            order[words[0]] = slice(len(values), len(values) + len(numbers))
            values = rows[0] = np.concatenate([values, numbers])
        elif words[0] not in order:
            raise InvalidFile(f"bone in {at}", words[0], "one that the first frame has numbers for")
        else:
            values[order[words[0]]] = numbers
    _require_complete(name, order, seen, len(rows), len(lines))
    missing = [bone.name for bone in asf.bones if bone.dof and bone.name not in order]
    if missing:
        raise InvalidFile(f"bones of {asf.name} without numbers in {name}", missing[:20], "none: fully specified frames")
    return first, list(order.items()), np.array(rows)


def _require_complete(name: str, order: dict[str, slice], seen: set[str], frames: int, line: int) -> None:
    """Raise InvalidFile if the frame that ends at a line lacks a bone that the first one has."""
    missing = [bone for bone in order if bone not in seen]
    if frames and missing:
        raise InvalidFile(f"bones that frame {frames} of {name} lacks, at line {line}", missing[:20], "none")


def _frame_number(at: str, word: str, frames: int, first: int) -> int:
    """Return the number of the first frame; InvalidFile unless this frame follows the one before, and for too many."""
    if len(word) > 12 or frames >= caps.FRAMES:
        raise InvalidFile(f"number of a frame in {at}", quoted(word), f"at most {caps.FRAMES} frames")
    if frames and int(word) != first + frames:
        raise InvalidFile(f"number of a frame in {at}", int(word), f"{first + frames}, after the one before")
    return first if frames else int(word)


def _tracks(asf: Asf, order: dict[str, slice]) -> tuple[Track, ...]:
    """Return the columns of every bone."""
    found = []
    for k, bone in enumerate(asf.bones):
        first = order[bone.name].start if bone.dof else 0
        places = [-1, -1, -1]
        for place, dof in enumerate(bone.dof):
            kind, axis = DOFS[dof]
            if k == 0 and kind == "way" and axis < 3:
                places[axis] = first + place
        turns = tuple((first + place, axis) for place, axis in bone.turns())
        w, x, y, z = (float(v) for v in bone.frame(asf.angle))
        found.append(Track((places[0], places[1], places[2]), bone.position, turns, (w, x, y, z)))
    return tuple(found)


def _axes(
    name: str, asf: Asf, made: Callable[[Axes], Recording], angle: float, scale: float | None, up: str | None
) -> tuple[Axes, list[str]]:
    """Return the axes of the clip: the unit of length as the skeleton states it, if a human of that size exists."""
    axes, notes = guessed(name, made, angle, asf.unit if scale is None else scale, up)
    if scale is not None:
        return axes, notes
    tall = standing(made(axes))
    stated = "as it states" if asf.length else "the usual one, as it states none"
    if SHORTEST <= tall <= TALLEST:
        notes.append(f"unit of length of {asf.name}: {asf.unit:.6g} m, {stated}; the skeleton is then {tall:.2f} m tall")
        return axes, notes
    axes, guesses = guessed(name, made, angle, None, axes.up)
    left = f"{stated} ({asf.unit:.6g} m), with which the skeleton would stand {tall:.3g} m tall"
    notes.append(f"unit of length of {asf.name} is not {left}")
    return axes, notes + guesses


def _require_fixed(name: str, asf: Asf, order: dict[str, slice], values: Array, scale: float) -> None:
    """Raise InvalidFile for a bone below the root that is moved along its parent: an avatar's links sit in joints."""
    for bone in asf.bones[1:]:
        for place, dof in enumerate(bone.dof):
            way = values[:, order[bone.name].start + place] if DOFS[dof][0] == "way" else np.zeros(1)
            if not (scale * np.abs(way)).max() <= STILL:
                far = float(scale * np.abs(way).max())
                raise InvalidFile(f"way {dof} of {bone.name} on its parent in {name} [m]", far, f"up to {STILL:g}")


def _beyond_stated(name: str, asf: Asf, order: dict[str, slice], values: Array, angle: float) -> list[str]:
    """Return a sentence on turns beyond the limits that the clip's own skeleton states, which is frequent in recordings."""
    found = []
    for bone in asf.bones:
        for place, (dof, (low, high)) in enumerate(zip(bone.dof, bone.limits, strict=False)):
            turned = np.degrees(values[:, order[bone.name].start + place] * angle)
            excess = np.maximum(np.degrees(low * asf.angle) - turned, turned - np.degrees(high * asf.angle))
            if DOFS[dof][0] == "turn" and (excess > NOTICED).any():
                found.append(f"{bone.name} {dof} ({int((excess > NOTICED).sum())} frames, up to {excess.max():.1f} degrees)")
    beyond = f"{name} goes beyond the limits that {asf.name} states, in its {len(values)} frames"
    return [f"{beyond}: {', '.join(found)}"] if found else []
