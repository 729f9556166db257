"""DeepMimic clips (Peng et al. 2018): JSON with 44 numbers a frame, for a humanoid of 13 links that move.

A clip is {"Loop": "wrap" or "none", "Frames": [[44 numbers], ...]}: the duration of the frame [s], the root's place [m] and
quaternion (w first), then a quaternion a ball joint and an angle [rad] a hinge, in the order of LAYOUT. Its world has y up and x
forward; here z is up, so a vector (x, y, z) becomes (x, -z, y) and a quaternion (w, x, y, z) becomes (w, x, -z, y). Hinge angles
keep their sign, because the hinge axes of the humanoid turn along.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from avatarsim.assets import caps
from avatarsim.assets.models.coordinates import Coordinates, Slot
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions import matching
from avatarsim.assets.motions.frame_times import HIGHEST, LOWEST
from avatarsim.assets.motions.motion_file import Notes
from avatarsim.assets.motions.recording import Axes
from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import MANY_TURNS
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import link_poses, rest
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array

LAYOUT = (
    ("root", 4), ("chest", 4), ("neck", 4),
    ("right_hip", 4), ("right_knee", 1), ("right_ankle", 4), ("right_shoulder", 4), ("right_elbow", 1),
    ("left_hip", 4), ("left_knee", 1), ("left_ankle", 4), ("left_shoulder", 4), ("left_elbow", 1),
)
"""Link and width of the values after the step [s] and the root's position [m]: a quaternion or a hinge angle [rad]."""

COLUMNS = 1 + 3 + sum(width for _, width in LAYOUT)
"""Numbers per frame: 44."""

SHORTEST, LONGEST = 0.5, 1.25
"""Lengths between which a stored quaternion is taken as a rotation. Eight of pybullet's clips have some that are off 1, as a
blend of quaternions leaves them: from 0.58 (kick) to 1.12 (backflip). Further out is a shifted column."""

LEGS = 0.83
"""Length [m] of thigh and shank of the body of the clips. The model that pybullet ships is four times as large."""

Y_UP = Axes(1.0, 1.0, "y")
"""Axes of the files' numbers."""

UPRIGHT = (float(np.sqrt(0.5)), float(np.sqrt(0.5)), 0.0, 0.0)
"""Rotation of the file's axes (y up) to those used here (z up): a quarter turn about x."""


@dataclass(frozen=True, eq=False)
class Clip:
    """F postures of the humanoid at `times` (F,) [s], z up.

    root_positions (F, 3) [m]; rotations: link -> (F, 4), the root's in the world, a ball's against its parent;
    angles: link -> (F,) [rad]; `wraps`: the last frame joins the first, so the clip may be repeated.
    """

    name: str
    wraps: bool
    times: Array
    root_positions: Array
    rotations: Mapping[str, Array]
    angles: Mapping[str, Array]


def read_clip(path: Path) -> Clip:
    """Read one clip file; InvalidFile names the file, its error and the valid values."""
    return read_deepmimic(path).clip


def read_deepmimic(path: str | Path) -> "DeepMimic":
    """Read the whole clip file. Raises InvalidFile."""
    path = Path(path)
    frames, content = _frames(path)
    rows = {}
    column = 4
    for link, width in LAYOUT:
        rows[link] = frames[:, column : column + width]
        column += width
    rotations = {}
    for link, width in LAYOUT:
        if width == 4:
            # values that are far too long stay so, and their squares are finite
            lengths = np.linalg.norm(np.clip(rows[link], -1e100, 1e100), axis=1)
            for k in np.flatnonzero(~((lengths >= SHORTEST) & (lengths <= LONGEST))):
                thing = f"length of the {link} quaternion in frame {k} of {path.name}"
                raise InvalidFile(thing, float(lengths[k]), f"{SHORTEST:g} to {LONGEST:g}, before it is made 1")
            rotations[link] = rotation.normalised(Y_UP.turned(rows[link]))
    _require_plausible(path.name, frames, rows)
    clip = Clip(
        name=path.stem.removeprefix("humanoid3d_"),
        wraps=content.get("Loop") == "wrap",
        # a frame's step is its duration until the next one
        times=np.concatenate([[0.0], np.cumsum(frames[:-1, 0])]),
        root_positions=Y_UP.vectors(frames[:, 1:4]),
        rotations=rotations,
        angles={link: rows[link][:, 0].copy() for link, width in LAYOUT if width == 1},
    )
    return DeepMimic(path.name, clip, frames, content)


def _require_plausible(name: str, frames: Array, rows: Mapping[str, Array]) -> None:
    """Raise InvalidFile for steps, places and angles that no recording has."""
    matching.require_within(name, "step", frames[:-1, 0], 1.0 / HIGHEST, 1.0 / LOWEST, "s")
    matching.require_within(name, "place of the root", np.abs(frames[:, 1:4]).max(axis=1), 0.0, matching.FARTHEST, "m")
    for link, width in LAYOUT:
        if width == 1:
            matching.require_within(name, f"angle of {link}", np.abs(rows[link][:, 0]), 0.0, MANY_TURNS, "rad")


def _frames(path: Path) -> tuple[Array, dict[str, Any]]:
    """Return the (F, 44) numbers of a clip file and its whole content, all checked but the quaternions."""
    valid = f"JSON with Loop and at least 2 Frames of {COLUMNS} finite numbers each, steps above 0"
    content: Any = read_json(path, f"clip {path.name}", valid, caps.JSON_BYTES)
    rows = content.get("Frames") if isinstance(content, dict) else None
    if not isinstance(rows, list) or len(rows) < 2:
        count = len(rows) if isinstance(rows, list) else None
        raise InvalidFile(f"number of frames of clip {path.name}", count, valid)
    caps.require_frames(path.name, len(rows))
    for k, row in enumerate(rows):
        if not isinstance(row, list) or len(row) != COLUMNS:
            columns = len(row) if isinstance(row, list) else type(row).__name__
            raise InvalidFile(f"number of columns of frame {k} of clip {path.name}", columns, valid)
    try:
        frames = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidFile(f"numbers of clip {path.name}", str(error), valid) from error
    bad = ~np.isfinite(frames).all(axis=1) | ~(frames[:, 0] > 0.0)
    # the last step is unused, and some writers put 0 there
    bad[-1] = not np.isfinite(frames[-1]).all()
    if bad.any():
        k = int(np.argmax(bad))
        raise InvalidFile(f"frame {k} of clip {path.name}", rows[k], valid)
    return frames, content


@dataclass(frozen=True, eq=False)
class DeepMimic(Notes):
    """A clip file: a MotionFile. `frames` (F, 44) and `content` are the file's, `clip` its frames as rotations, z up."""

    name: str
    clip: Clip
    frames: Array
    content: Mapping[str, Any]
    format: str = "deepmimic"

    def motion(self, model: Model) -> Motion:
        """Return the motion for an avatar with joints or links named as in LAYOUT, drawn z up or y up.
        Its other joints stay at zero. Raises InvalidFile for an avatar that lacks one, or has it of another kind."""
        coordinates = matching.coordinates_of_model(self.name, model)
        assert model.avatar is not None
        caps.require_frames(self.name, len(self.clip.times), coordinates.links)
        slots = _slots(self.name, coordinates, model.avatar)
        others = [slot.name for slot in coordinates.slots if slot not in slots.values() and slot.kind != "fixed"]
        if others:
            self.note(f"{self.name}: no columns for these joints, which stay at zero: {matching.shortened(others)}")
        legs = sum(float(np.linalg.norm(model.avatar.links[slots[joint].link].anchor)) for joint in ("left_knee", "left_ankle"))
        if not (0.5 * LEGS <= legs <= 2.0 * LEGS):
            self.note(
                f"{self.name}: legs of the avatar are {legs:.2g} m long, those of the clip's body {LEGS:g} m, and the root goes "
                "where the clip says: an avatar of another scale fits it"
            )
        return self._motion(coordinates, slots, _is_y_up(model.avatar, slots))

    def _motion(self, coordinates: Coordinates, slots: Mapping[str, Slot], flat: bool) -> Motion:
        frames = len(self.clip.times)
        positions = np.zeros((frames, coordinates.links, 3))
        rotations = np.tile(np.array(rotation.IDENTITY), (frames, coordinates.links, 1))
        angles = np.zeros((frames, coordinates.hinges))
        for joint, slot in slots.items():
            if slot.kind == "hinge":
                angles[:, slot.hinge] = self.clip.angles[joint]
            else:
                turns = rotation.continuous(self.clip.rotations[joint])
                rotations[:, slot.link] = _of_axes(turns, joint == "root") if flat else turns
        positions[:, slots["root"].link] = self.clip.root_positions
        return Motion(self.clip.times, positions, rotations, angles)

    def written(self, motion: Motion, model: Model) -> bytes:
        """Return the clip with this motion; unchanged frames keep the file's numbers, the others their steps too."""
        coordinates = matching.coordinates_of_model(self.name, model)
        assert model.avatar is not None
        slots = _slots(self.name, coordinates, model.avatar)
        flat = _is_y_up(model.avatar, slots)
        before = self._motion(coordinates, slots, flat)
        same_times = len(motion) == len(before) and bool((motion.times == before.times).all())
        steps = self.frames[:, 0] if same_times else np.diff(motion.times, append=2.0 * motion.times[-1] - motion.times[-2])
        stayed = (coordinates.rows(motion) == coordinates.rows(before)).all(axis=1) if same_times else None
        columns = [steps[:, None], Y_UP.in_file(motion.positions[:, slots["root"].link])]
        first = 4
        for joint, width in LAYOUT:
            slot = slots[joint]
            first += width
            if width == 1:
                columns.append(motion.angles[:, slot.hinge, None])
            else:
                turns = motion.rotations[:, slot.link]
                own = _to_axes(turns, joint == "root") if flat else turns
                turns = Y_UP.turned_in_file(own)
                recorded = self.frames[:, first - 4 : first]
                signed = rotation.continuous(turns) if stayed is None else rotation.with_signs_of(turns, recorded, stayed)
                columns.append(signed)
        rows = np.concatenate(columns, axis=1).tolist()
        if stayed is not None:
            rows = [was if kept else now for was, now, kept in zip(self.content["Frames"], rows, stayed.tolist(), strict=True)]
        return json.dumps({**self.content, "Frames": rows}).encode("utf-8")


def _of_axes(turns: Array, root: bool) -> Array:
    """Return rotations of a clip, z up, for an avatar whose links are drawn with y up."""
    own = Y_UP.turned_in_file(turns)
    return rotation.multiply(np.array(UPRIGHT), own) if root else own


def _to_axes(turns: Array, root: bool) -> Array:
    """Apply the inverse of `_of_axes`."""
    own = rotation.multiply(rotation.conjugate(np.array(UPRIGHT)), turns) if root else turns
    return Y_UP.turned(own)


def _slots(name: str, coordinates: Coordinates, avatar: Avatar) -> dict[str, Slot]:
    """Return the avatar's joint for each of the clip's, by its own name or that of the link that it moves."""
    found: dict[str, Slot] = {}
    for slot in coordinates.slots:
        if slot.kind == "free":
            found.setdefault("root", slot)
        if slot.kind in ("free", "fixed"):
            continue
        for called in (slot.name, avatar.links[slot.link].name):
            if called in dict(LAYOUT) and called not in found:
                found[called] = slot
                break
    missing = [joint for joint, _ in LAYOUT if joint not in found]
    if missing:
        valid = f"an avatar with joints called {', '.join(joint for joint, _ in LAYOUT)}; missing: {', '.join(missing)}"
        raise InvalidFile(f"joints for {name}", matching.shortened(coordinates.names), valid)
    kinds = {joint: "free" if joint == "root" else "ball" if width == 4 else "hinge" for joint, width in LAYOUT}
    for joint, slot in found.items():
        if slot.kind != kinds[joint]:
            raise InvalidFile(f"joint {joint} for {name}", slot.kind, kinds[joint])
    return found


def _is_y_up(avatar: Avatar, slots: Mapping[str, Slot]) -> bool:
    """Return True if the neck of the avatar at rest is farther from its root along y than along z."""
    sample = rest((avatar,))
    places, _ = link_poses((avatar,), sample)
    stands = places[slots["neck"].link] - places[slots["root"].link]
    return bool(stands[1] > abs(stands[2]))
