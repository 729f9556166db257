"""Recorded human motion: the clips of pybullet_data, repeated, placed, and retimed to one step per rendered frame."""

from dataclasses import replace

import numpy as np

from avatarsim.assets.motions.deepmimic import Clip, read_clip
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array
from scenarios.data_folder import data_file, pybullet_data
from scenarios.scenario import RENDERED


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
