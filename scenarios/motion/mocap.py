"""Recorded human motion: the clips of pybullet_data, repeated, placed, layered, and retimed to one step per rendered frame."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from avatarsim.assets.motions.deepmimic import Clip, read_clip
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array
from scenarios.data_folder import data_file, pybullet_data
from scenarios.scenario import RENDERED

UPPER = ("chest", "neck", "right_shoulder", "right_elbow", "left_shoulder", "left_elbow")
"""Links of an upper body. The root belongs to the legs, which carry it."""
Change = Callable[[Array], Array]


def clip_names() -> tuple[str, ...]:
    """Return names of the human clips that come with pybullet_data, sorted."""
    prefix = "humanoid3d_"
    files = (pybullet_data() / "data" / "motions").glob(f"{prefix}*.txt")
    return tuple(sorted(file.stem.removeprefix(prefix) for file in files))


def load_clip(name: str) -> Clip:
    """Return the clip called `name`, such as "walk". UnknownName lists those that exist."""
    if name not in clip_names():
        raise UnknownName("clip", name, clip_names())
    return read_clip(data_file(f"data/motions/humanoid3d_{name}.txt"))


def with_frames(clip: Clip, times: Array, positions: Change, rotations: Change | None = None) -> Clip:
    """Return the clip at `times` [s], its arrays changed along their first axis, rotations perhaps in another way."""
    return replace(
        clip, times=times, root_positions=positions(clip.root_positions),
        rotations={link: (rotations or positions)(values) for link, values in clip.rotations.items()},
        angles={link: positions(values) for link, values in clip.angles.items()},
    )


def repeated(clip: Clip, times: int) -> Clip:
    """Return a clip that wraps, `times` over: each round starts where the last ended, its first frame being the join."""
    if not clip.wraps:
        raise InvalidInput(f"Loop of clip {clip.name}", "none", "wrap, for a clip that is repeated")
    rounds = np.arange(times)[:, None]
    stride = (clip.root_positions[-1] - clip.root_positions[0]) * np.array([1.0, 1.0, 0.0])

    def joined(values: Array) -> Array:
        return np.concatenate([np.tile(values[:-1], (times,) + (1,) * (values.ndim - 1)), values[-1:]])

    starts = (rounds * clip.times[-1] + clip.times[None, :-1]).ravel()
    places = (rounds[..., None] * stride + clip.root_positions[None, :-1]).reshape(-1, 3)
    return replace(
        with_frames(clip, np.append(starts, times * clip.times[-1]), joined),
        root_positions=np.vstack([places, (times - 1) * stride + clip.root_positions[-1]]),
    )


def placed(clip: Clip, x: float, y: float, heading: float) -> Clip:
    """Return the clip begun at (x, y) [m] on the floor and turned by `heading` [rad] about the vertical through there."""
    turn = np.tile(rotation.from_axis_angle((0.0, 0.0, 1.0), heading), (len(clip.times), 1))
    from_start = clip.root_positions - clip.root_positions[0] * np.array([1.0, 1.0, 0.0])
    return replace(
        clip, root_positions=rotation.rotate(turn, from_start) + np.array([x, y, 0.0]),
        rotations={**clip.rotations, "root": rotation.multiply(turn, clip.rotations["root"])},
    )


def retimed(clip: Clip, step: float = RENDERED) -> Clip:
    """Return the clip at equal steps [s]: rotations on the great circle between their neighbours, the rest on a line."""
    # 1e-9 of a step keeps a clip whose length is a whole number of steps from losing its last one to rounding
    count = int(clip.times[-1] / step + 1e-9) + 1
    times = np.arange(count, dtype=np.float64) * step
    after = np.clip(np.searchsorted(clip.times, times, side="right"), 1, len(clip.times) - 1)
    before = after - 1
    fraction = np.clip((times - clip.times[before]) / (clip.times[after] - clip.times[before]), 0.0, 1.0)

    def on_line(values: Array) -> Array:
        u = fraction.reshape(-1, *(1,) * (values.ndim - 1))
        return values[before] + u * (values[after] - values[before])

    def on_circle(values: Array) -> Array:
        return rotation.normalised(rotation.slerp(values[before], values[after], fraction))

    return with_frames(clip, times, on_line, on_circle)


def upper_body_of(above: Clip, start: float, below: Clip) -> Clip:
    """Return `below` with chest, neck and arms as in `above` from `start` [s] on; both retimed to the same steps.

    Raises InvalidInput when `above` ends before `below` does.
    """
    first = int(np.searchsorted(above.times, start - 1e-9))
    span = slice(first, first + len(below.times))
    if len(above.times[span]) < len(below.times):
        latest = above.times[-1] - below.times[-1]
        raise InvalidInput(f"start of clip {above.name} over clip {below.name} [s]", start, f"at most {latest:g}")
    return replace(
        below,
        name=f"{below.name} under {above.name}",
        rotations={link: (above.rotations[link][span] if link in UPPER else own) for link, own in below.rotations.items()},
        angles={link: (above.angles[link][span] if link in UPPER else own) for link, own in below.angles.items()},
    )
