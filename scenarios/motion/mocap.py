"""Recorded human motion: reader of DeepMimic clips, and their retiming to one step per rendered frame.

A clip is JSON, {"Loop": "wrap" or "none", "Frames": [[44 numbers], ...]}. Its world has y up and x forward; here
z is up, so a vector (x, y, z) becomes (x, -z, y) and a quaternion (w, x, y, z) becomes (w, x, -z, y).
Hinge angles keep their sign, because the hinge axes of the humanoid turn along.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.errors import InvalidFile, InvalidInput, UnknownName
from avatarsim.files import read_json
from avatarsim.spatial import rotation
from scenarios.data_folder import data_file, pybullet_data
from scenarios.scenario import RENDERED

Array = NDArray[np.float64]

LAYOUT = (
    ("root", 4), ("chest", 4), ("neck", 4),
    ("right_hip", 4), ("right_knee", 1), ("right_ankle", 4), ("right_shoulder", 4), ("right_elbow", 1),
    ("left_hip", 4), ("left_knee", 1), ("left_ankle", 4), ("left_shoulder", 4), ("left_elbow", 1),
)
"""Link and width of what follows the step [s] and the root's position [m]: a quaternion or a hinge angle [rad]."""
COLUMNS = 1 + 3 + sum(width for _, width in LAYOUT)
"""Numbers per frame: 44."""
SHORTEST, LONGEST = 0.5, 1.25
"""Lengths between which a stored quaternion is taken as a rotation. Eight of the clips hold some that are off 1, as a blend
of quaternions leaves them: from 0.58 (kick) to 1.12 (backflip). Further out is a shifted column."""


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


def z_up(vector: ArrayLike) -> Array:
    """(x, y, z) with y up, shape (..., 3), in our axes: x forward, y left, z up."""
    v = np.asarray(vector, dtype=np.float64)
    return np.stack([v[..., 0], -v[..., 2], v[..., 1]], axis=-1)


def z_up_rotation(quaternion: ArrayLike) -> Array:
    """The same turn, (w, x, y, z) with y up, shape (..., 4), in our axes."""
    q = np.asarray(quaternion, dtype=np.float64)
    return np.concatenate([q[..., :1], z_up(q[..., 1:])], axis=-1)


def clip_names() -> tuple[str, ...]:
    """Names of the human clips that come with pybullet_data, sorted."""
    prefix = "humanoid3d_"
    files = (pybullet_data() / "data" / "motions").glob(f"{prefix}*.txt")
    return tuple(sorted(file.stem.removeprefix(prefix) for file in files))


def load_clip(name: str) -> Clip:
    """The clip called `name`, such as "walk". UnknownName lists those that exist."""
    if name not in clip_names():
        raise UnknownName("clip", name, clip_names())
    return read_clip(data_file(f"data/motions/humanoid3d_{name}.txt"))


def read_clip(path: Path) -> Clip:
    """Read one clip file; InvalidFile names the file, what is wrong with it and what is valid."""
    frames, wraps = _frames(path)
    steps, rows = frames[:, 0], {}
    column = 4
    for link, width in LAYOUT:
        rows[link] = frames[:, column : column + width]
        column += width
    rotations = {}
    for link, width in LAYOUT:
        if width == 4:
            lengths = np.linalg.norm(rows[link], axis=1)
            for k in np.flatnonzero(~((lengths >= SHORTEST) & (lengths <= LONGEST))):
                thing = f"length of the {link} quaternion in frame {k} of {path.name}"
                raise InvalidFile(thing, float(lengths[k]), f"{SHORTEST:g} to {LONGEST:g}, before it is made 1")
            rotations[link] = rotation.normalised(z_up_rotation(rows[link]))
    return Clip(
        name=path.stem.removeprefix("humanoid3d_"),
        wraps=wraps,
        # a frame's step says how long it stands until the next one
        times=np.concatenate([[0.0], np.cumsum(steps[:-1])]),
        root_positions=z_up(frames[:, 1:4]),
        rotations=rotations,
        angles={link: rows[link][:, 0].copy() for link, width in LAYOUT if width == 1},
    )


def _frames(path: Path) -> tuple[Array, bool]:
    """The (F, 44) numbers of a clip file and whether it wraps, everything checked but the quaternions."""
    valid = f"JSON with Loop and at least 2 Frames of {COLUMNS} finite numbers each, steps above 0"
    content: Any = read_json(path, f"clip {path.name}", valid)
    rows = content.get("Frames") if isinstance(content, dict) else None
    if not isinstance(rows, list) or len(rows) < 2:
        count = len(rows) if isinstance(rows, list) else None
        raise InvalidFile(f"number of frames of clip {path.name}", count, valid)
    for k, row in enumerate(rows):
        if not isinstance(row, list) or len(row) != COLUMNS:
            columns = len(row) if isinstance(row, list) else type(row).__name__
            raise InvalidFile(f"number of columns of frame {k} of clip {path.name}", columns, valid)
    try:
        frames = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidFile(f"numbers of clip {path.name}", str(error), valid) from error
    bad = ~np.isfinite(frames).all(axis=1) | ~(frames[:, 0] > 0.0)
    # the last step leads nowhere, and some writers put 0 there
    bad[-1] = not np.isfinite(frames[-1]).all()
    if bad.any():
        k = int(np.argmax(bad))
        raise InvalidFile(f"frame {k} of clip {path.name}", rows[k], valid)
    return frames, content.get("Loop") == "wrap"


def repeated(clip: Clip, times: int) -> Clip:
    """A clip that wraps, `times` over: each round starts where the last ended, its first frame being the join."""
    if not clip.wraps:
        raise InvalidInput(f"Loop of clip {clip.name}", "none", "wrap, for a clip that is repeated")
    rounds = np.arange(times)[:, None]
    stride = (clip.root_positions[-1] - clip.root_positions[0]) * np.array([1.0, 1.0, 0.0])

    def joined(values: Array) -> Array:
        return np.concatenate([np.tile(values[:-1], (times,) + (1,) * (values.ndim - 1)), values[-1:]])

    starts = (rounds * clip.times[-1] + clip.times[None, :-1]).ravel()
    places = (rounds[..., None] * stride + clip.root_positions[None, :-1]).reshape(-1, 3)
    return Clip(
        name=clip.name,
        wraps=True,
        times=np.append(starts, times * clip.times[-1]),
        root_positions=np.vstack([places, (times - 1) * stride + clip.root_positions[-1]]),
        rotations={link: joined(values) for link, values in clip.rotations.items()},
        angles={link: joined(values) for link, values in clip.angles.items()},
    )


def placed(clip: Clip, x: float, y: float, heading: float) -> Clip:
    """The clip begun at (x, y) [m] on the floor and turned by `heading` [rad] about the vertical through there."""
    turn = rotation.from_axis_angle((0.0, 0.0, 1.0), heading)
    from_start = clip.root_positions - clip.root_positions[0] * np.array([1.0, 1.0, 0.0])
    frames = len(clip.times)
    return replace(
        clip,
        root_positions=rotation.rotate(np.tile(turn, (frames, 1)), from_start) + np.array([x, y, 0.0]),
        rotations={**clip.rotations, "root": rotation.multiply(np.tile(turn, (frames, 1)), clip.rotations["root"])},
    )


def retimed(clip: Clip, step: float = RENDERED) -> Clip:
    """The clip at equal steps [s]: rotations on the great circle between their neighbours, the rest on a line."""
    # 1e-9 of a step keeps a clip whose length is a whole number of steps from losing its last one to rounding
    count = int(clip.times[-1] / step + 1e-9) + 1
    times = np.arange(count, dtype=np.float64) * step
    after = np.clip(np.searchsorted(clip.times, times, side="right"), 1, len(clip.times) - 1)
    before = after - 1
    fraction = np.clip((times - clip.times[before]) / (clip.times[after] - clip.times[before]), 0.0, 1.0)

    def on_line(values: Array) -> Array:
        u = fraction.reshape(-1, *(1,) * (values.ndim - 1))
        return values[before] + u * (values[after] - values[before])

    return Clip(
        name=clip.name,
        wraps=clip.wraps,
        times=times,
        root_positions=on_line(clip.root_positions),
        rotations={
            link: rotation.normalised(rotation.slerp(values[before], values[after], fraction))
            for link, values in clip.rotations.items()
        },
        angles={link: on_line(values) for link, values in clip.angles.items()},
    )
