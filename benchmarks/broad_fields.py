"""Objects of the broad phase: as dense for any number of them, and with the same few near pairs."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from avatarsim.model.geometry import OPEN, PairFilter, pair_filter

Array = NDArray[np.float64]

LAYOUTS: Final = ("cube", "plane", "line", "mixed")
"""Objects in a cube, on a floor plane, on a line; in a cube with sizes over two decades, a floor, a wall and three slabs."""
MOTIONS: Final = {"all slow": (1.0, 0.005), "1 % slow": (0.01, 0.005), "none": (0.0, 0.0), "all fast": (1.0, 0.17)}
"""Share of the objects that moves, and radians per frame of its swing to and fro: at most 3 cm/s and 1 m/s at 60 Hz."""
NEAR: Final = 5
"""Pairs that are near each other, at any number of objects."""
SWING: Final = 0.1
"""Amplitude of the motion [m]. Places are 1 m apart and objects at most 0.3 m long, so that no other pair ever meets."""
HUGE: Final = 5
"""The first objects of layout `mixed`: floor, wall and slabs, as long as everything together."""


@dataclass(frozen=True)
class Field:
    """boxes (n, 6) at rest [m]; the numbers of those that move (m), ascending; their speeds at first (m, 3) [m per frame]."""

    boxes: Array
    moving: NDArray[np.int64]
    speed: Array
    swing: float
    wanted: PairFilter

    @property
    def period(self) -> int:
        """Frames of one swing to and fro; 1 if nothing moves."""
        return round(2.0 * np.pi / self.swing) if self.swing > 0.0 else 1


def field(layout: str, motion: str, count: int, seed: int = 0) -> Field:
    """Return `count` objects, numbered at random: neighbours in space are not neighbours in memory."""
    rng = np.random.default_rng(seed)
    extra = HUGE if layout == "mixed" else 0
    small = count - extra
    places = _places(layout, small - NEAR)
    at = np.concatenate([places, places[:NEAR]]) + rng.uniform(-0.2, 0.2, (small, 3))
    size = 0.3 * 10.0 ** rng.uniform(-2.0, 0.0, (small, 1)) * np.ones(3) if extra else rng.uniform(0.1, 0.3, (small, 3))
    # the near ones overlap by half
    at[-NEAR:], size[-NEAR:] = at[:NEAR] + 0.5 * size[:NEAR], size[:NEAR]
    boxes = np.hstack([at - 0.5 * size, at + 0.5 * size])
    if extra:
        boxes = np.vstack([_huge(np.ceil(small ** (1 / 3))), boxes])
    share, swing = MOTIONS[motion]
    way = rng.normal(size=(count, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    moves = rng.random(count) < share
    # near pairs move alike; floor and wall are fixed
    way[-NEAR:], moves[-NEAR:] = way[extra : extra + NEAR], moves[extra : extra + NEAR]
    moves[: min(extra, 2)] = False
    family = np.full(count, OPEN)
    family[: min(extra, 2)] = 0
    order = rng.permutation(count)
    moving = np.flatnonzero(moves[order])
    return Field(boxes[order], moving, SWING * swing * way[order][moving], swing, pair_filter(family[order]))


def _places(layout: str, count: int) -> Array:
    """Return the first `count` places of a lattice of 1 m."""
    axes = {"cube": 3, "mixed": 3, "plane": 2, "line": 1}[layout]
    edge = int(np.ceil(count ** (1.0 / axes) - 1e-9))
    lattice = np.stack(np.meshgrid(*[np.arange(edge)] * axes, indexing="ij"), axis=-1).reshape(-1, axes)[:count]
    return np.hstack([lattice, np.zeros((count, 3 - axes))]).astype(np.float64)


def _huge(edge: float) -> Array:
    """Return floor and wall 1 m from the nearest place, and three slabs over everything, one above the other."""
    floor, wall = [-1.0, -1.0, -2.0, edge, edge, -1.0], [-2.0, -1.0, 0.0, -1.0, edge, edge]
    return np.array([floor, wall, *[[0.0, 0.0, edge + k, edge, edge, edge + k + 0.5] for k in (1.0, 2.0, 3.0)]])
