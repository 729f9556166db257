"""What is asked: cells (two kinds of shape, a regime) and, in each, a number of pairs in a number of frames."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations_with_replacement
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from avatarsim.scene.shape import Box, Capsule, ConvexHull, Shape, Sphere, ellipsoid_hull
from reference.narrow_phase.ours import Pairs

Array = NDArray[np.float64]
Mode = Literal["cold", "coherent"]

KINDS = ("sphere", "capsule", "box", "ellipsoid", "hull")
"""Kinds of shape. `ellipsoid` is the hull of 52 points spread over one (100 triangles), as the avatar's links are; `hull` has
20 to 60 vertices, all of them corners."""

REGIMES = ("apart", "shallow", "deep")
MODES: tuple[Mode, ...] = ("cold", "coherent")

SEED = 20_03
"""Seed of every draw; another one gives other shapes and poses, and the same conclusions."""

GAPS = (0.02, 0.30)
"""Gaps [m] of pairs that are apart: near enough for a broad phase to hand them over."""

DEPTHS = {"shallow": (0.01, 0.10), "deep": (0.40, 0.95)}
"""Depths of pairs that overlap, as shares of the depth at which the two centres coincide."""

RATE, TURNING = 1.0 / 60.0, 0.5
"""Coherent frames follow each other at 60 Hz [s], and the first shape turns at 0.5 rad/s, as a hand on an object does."""

DRIFT = 1.5
"""How fast the gap or depth of a coherent pair wanders to and fro within its regime [rad/s]: less than a cycle in 100 frames."""

HALVINGS = 20
"""Bisection steps that place a pair: a micrometre, so that coherent motion has no steps of its own."""


class Cell(NamedTuple):
    """Two kinds of shape and a regime."""

    shape_a: str
    shape_b: str
    regime: str

    @property
    def name(self) -> str:
        """As tables name it."""
        return f"{self.shape_a}-{self.shape_b} {self.regime}"


@dataclass(frozen=True, eq=False)
class Sequence:
    """What a contender is given: `shapes` (2 n) of n pairs, two in a row, and where they are in every frame.

    turns (frames, 2 n, 3, 3); at (frames, 2 n, 3) [m]. In mode cold the frames have nothing to do with each other.
    """

    cell: Cell
    mode: Mode
    shapes: tuple[Shape, ...]
    turns: Array
    at: Array

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self.at)

    @property
    def pairs(self) -> int:
        """Number of pairs."""
        return len(self.shapes) // 2


def cells() -> Iterator[Cell]:
    """Every cell, kinds in their order, regimes from apart to deep."""
    for a, b in combinations_with_replacement(KINDS, 2):
        for regime in REGIMES:
            yield Cell(a, b, regime)


def drawn(kind: str, rng: np.random.Generator) -> Shape:
    """A shape of the kind, about 1 m across."""
    if kind == "sphere":
        return Sphere(float(rng.uniform(0.25, 0.5)))
    if kind == "capsule":
        return Capsule(float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.4, 0.9)))
    if kind == "box":
        x, y, z = rng.uniform(0.4, 1.0, 3).tolist()
        return Box((x, y, z))
    if kind == "ellipsoid":
        x, y, z = rng.uniform(0.2, 0.5, 3).tolist()
        return ellipsoid_hull((x, y, z))
    # points on an ellipsoid, so that every one of them is a corner
    points = rng.normal(size=(int(rng.integers(20, 61)), 3))
    return ConvexHull(points / np.linalg.norm(points, axis=1)[:, None] * rng.uniform(0.2, 0.5, 3))


@lru_cache(maxsize=1)
def shapes_of(shape_a: str, shape_b: str, pairs: int) -> tuple[Shape, ...]:
    """The shapes of all regimes and modes of two kinds: two in a row are a pair. The same objects while the kinds stay."""
    rng = np.random.default_rng([SEED, KINDS.index(shape_a), KINDS.index(shape_b)])
    return tuple(drawn(kind, rng) for _ in range(pairs) for kind in (shape_a, shape_b))


def sequence(cell: Cell, mode: Mode, pairs: int, frames: int) -> Sequence:
    """The pairs of a cell through all frames. Each is moved along one direction to the gap or depth that its regime wants."""
    shapes = shapes_of(cell.shape_a, cell.shape_b, pairs)
    rng = np.random.default_rng([SEED, *(k.index(v) for k, v in zip((KINDS, KINDS, REGIMES), cell, strict=True)), len(mode)])
    if mode == "cold":
        turns = Rotation.random(frames * 2 * pairs, rng=rng).as_matrix().reshape(frames, 2 * pairs, 3, 3)
        along = _unit(rng.normal(size=(frames, pairs, 3)))
        share = rng.uniform(size=(frames, pairs))
    else:
        turns = np.tile(Rotation.random(2 * pairs, rng=rng).as_matrix(), (frames, 1, 1, 1))
        along = np.tile(_unit(rng.normal(size=(pairs, 3))), (frames, 1, 1))
        times = RATE * np.arange(frames)[:, None]
        share = 0.5 + 0.5 * np.sin(DRIFT * times + rng.uniform(0.0, 2.0 * np.pi, pairs))
        spin = (TURNING * times[..., None] * _unit(rng.normal(size=(pairs, 3)))).reshape(-1, 3)
        turns[:, ::2] = Rotation.from_rotvec(spin).as_matrix().reshape(frames, pairs, 3, 3) @ turns[:, ::2]
    at = np.zeros((frames, 2 * pairs, 3))
    measured = Pairs(shapes)
    for frame in range(frames):
        at[frame, ::2] = _placed(measured, turns[frame], along[frame], cell.regime, share[frame])
    return Sequence(cell, mode, shapes, turns, at)


def _unit(rows: Array) -> Array:
    return np.asarray(rows / np.linalg.norm(rows, axis=-1, keepdims=True))


def _placed(pairs: Pairs, turns: Array, along: Array, regime: str, share: Array) -> Array:
    """Positions (n, 3) [m] of the first shapes, on rays from the second ones, where the gap is the one wanted.

    Along a ray the signed distance of convex shapes is convex: beyond the centre there is one such place. Our own query
    finds it; what is true there is decided afterwards by others.
    """
    def gaps(distance: Array) -> Array:
        at = np.zeros((2 * len(distance), 3))
        at[::2] = distance[:, None] * along
        pairs.place(turns, at)
        return pairs.cold()

    low, high = np.zeros(len(share)), np.full(len(share), pairs.reach)
    if regime == "apart":
        wanted = GAPS[0] + share * (GAPS[1] - GAPS[0])
    else:
        least, most = DEPTHS[regime]
        wanted = (least + share * (most - least)) * gaps(low)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        beyond = gaps(middle) > wanted
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return high[:, None] * along
