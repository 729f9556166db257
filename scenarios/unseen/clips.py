"""Motion editing of recorded clips: mirror images, time warps, layers, cuts, and cross-fades that keep the root continuous."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.motions.deepmimic import Clip
from avatarsim.spatial import rotation
from scenarios.motion.keyframes import minimum_jerk
from scenarios.motion.mocap import placed, retimed, upper_body_of, with_frames
from scenarios.scenario import RENDERED

Array = NDArray[np.float64]

SIDES = {"left": "right", "right": "left"}
"""Prefix of a link's name and that of its mirror image."""
MIRROR_ROTATION = np.array([1.0, -1.0, 1.0, -1.0])
"""A turn (w, x, y, z) seen in the mirror y -> -y: the axis is reflected and the sense of the turn reversed."""
MIRROR_PLACE = np.array([1.0, -1.0, 1.0])
"""A point [m] in that mirror."""
SLOWEST, FASTEST = 0.7, 1.4
"""Least and largest rate of a time warp: slower is another gait, faster is no gait of a human."""
RATE_LASTS = 0.8
"""Time [s] after which a warp has reached its next rate; shorter, and the change of rate is itself a jerk."""


def mirrored(clip: Clip) -> Clip:
    """Return the clip seen in the mirror y -> -y: left and right swapped. Hinge angles stay, since all hinges turn about y."""

    def other(link: str) -> str:
        side, _, rest = link.partition("_")
        return f"{SIDES[side]}_{rest}" if side in SIDES else link

    return replace(
        clip, name=f"{clip.name} mirrored", root_positions=clip.root_positions * MIRROR_PLACE,
        rotations={other(link): values * MIRROR_ROTATION for link, values in clip.rotations.items()},
        angles={other(link): values for link, values in clip.angles.items()},
    )


def warped(clip: Clip, random: np.random.Generator) -> Clip:
    """Return the clip at a rate that changes smoothly between SLOWEST and FASTEST, at the steps of a rendered frame again."""
    knots = np.log([SLOWEST, FASTEST])
    levels = random.uniform(knots[0], knots[1], int(clip.times[-1] / RATE_LASTS) + 2)
    along = clip.times[1:] / RATE_LASTS
    k = np.minimum(along.astype(np.int64), len(levels) - 2)
    rate = np.exp(levels[k] + minimum_jerk(along - k) * (levels[k + 1] - levels[k]))
    return retimed(replace(clip, times=np.concatenate([[0.0], np.cumsum(np.diff(clip.times) / rate)])))


def cut(clip: Clip, first: int, count: int) -> Clip:
    """Return `count` postures from `first` on, or as many as there are; the time begins anew."""
    part = slice(first, first + count)
    return replace(with_frames(clip, clip.times[part] - clip.times[first], lambda values: values[part]), wraps=False)


def layered(above: Clip, below: Clip) -> Clip:
    """Return the legs of `below` under the upper body of `above`, both from their first postures on, as long as both last."""
    count = min(len(above.times), len(below.times))
    return upper_body_of(cut(above, 0, count), 0.0, cut(below, 0, count))


def heading(clip: Clip, frame: int) -> float:
    """Return the turn [rad] of the root about the vertical, its twist, in one posture."""
    w, _, _, z = clip.rotations["root"][frame]
    return 2.0 * float(np.arctan2(z, w))


def faded(before: Clip, after: Clip, frames: int, turn: float = 0.0) -> Clip:
    """Return `before`, then `after` begun `frames` before the end of `before`, turned to its heading and by `turn` [rad] more.

    Over these frames both play and one becomes the other: rotations on the great circle between them, the rest on a line. At
    most half of either clip is faded; both are at the steps of a rendered frame."""
    frames = min(frames, len(before.times) // 2, len(after.times) // 2)
    begins = len(before.times) - frames
    x, y, _ = before.root_positions[begins]
    onward = placed(after, float(x), float(y), heading(before, begins) - heading(after, 0) + turn)
    # neither end is reached within: a posture that counts twice would be a halt
    share = minimum_jerk(np.arange(1, frames + 1) / (frames + 1.0))

    def on_line(one: Array, other: Array) -> Array:
        u = share.reshape(-1, *(1,) * (one.ndim - 1))
        return np.concatenate([one[:begins], one[begins:] + u * (other[:frames] - one[begins:]), other[frames:]])

    def on_circle(one: Array, other: Array) -> Array:
        turned = rotation.normalised(rotation.slerp(one[begins:], other[:frames], share))
        return np.concatenate([one[:begins], turned, other[frames:]])

    joined = on_line(before.root_positions, onward.root_positions)
    return Clip(
        name=f"{before.name}, {after.name}", wraps=False, times=np.arange(len(joined), dtype=np.float64) * RENDERED,
        root_positions=joined,
        rotations={link: on_circle(values, onward.rotations[link]) for link, values in before.rotations.items()},
        angles={link: on_line(values, onward.angles[link]) for link, values in before.angles.items()},
    )
