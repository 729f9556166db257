"""The pairs of shapes that are queried: cells (two kinds of shape and a regime), and the poses of pairs in every frame."""

from collections.abc import Iterator
from functools import lru_cache
from itertools import combinations_with_replacement

import numpy as np
from scipy.spatial.transform import Rotation

from avatarsim.scene.shape import Box, Capsule, ConvexHull, Shape, Sphere, ellipsoid_hull
from benchmarks.narrow_phase.contender import Array, Cell, Mode, Trial
from benchmarks.narrow_phase.in_avatarsim import CompiledPairs
from reference.judging.geometry import rounded_points
from reference.judging.minkowski import signed_distance

KINDS = ("sphere", "capsule", "box", "ellipsoid", "hull")
"""Kinds of shape. `ellipsoid` is the hull of 52 points spread over one (100 triangles), as the avatar's links are; `hull` has
20 to 60 vertices, all of them corners."""
REGIMES = ("apart", "shallow", "deep")
MODES: tuple[Mode, ...] = ("cold", "coherent")
SEED = 20_03
"""Seed of every draw; another one gives other shapes and poses, and the same conclusions."""
GAPS = (0.02, 0.30)
"""Gaps [m] of pairs that are apart: near enough to pass a broad phase."""
DEPTHS = {"shallow": (0.01, 0.10), "deep": (0.40, 0.95)}
"""Depths of pairs that overlap, as shares of the depth at which the two centres coincide."""
RATE, TURNING = 1.0 / 60.0, 0.5
"""Coherent frames follow each other at 60 Hz [s], and the first shape turns at 0.5 rad/s, as a hand on an object does."""
DRIFT = 1.5
"""Rate at which the gap or depth of a coherent pair varies within its regime [rad/s]: less than a cycle in 100 frames."""
HALVINGS = 20
"""Bisection steps that place a pair: to a micrometre, so that coherent motion has no steps of its own."""


def cells() -> Iterator[Cell]:
    """Yield every cell, kinds in their order, regimes from apart to deep."""
    for a, b in combinations_with_replacement(KINDS, 2):
        for regime in REGIMES:
            yield Cell(a, b, regime)


def random_shape(kind: str, rng: np.random.Generator) -> Shape:
    """Return a shape of the kind, about 1 m across."""
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
    return ConvexHull(_unit(points) * rng.uniform(0.2, 0.5, 3))


@lru_cache(maxsize=1)
def shapes_of(shape_a: str, shape_b: str, pairs: int) -> tuple[Shape, ...]:
    """Return the shapes of all regimes and modes of two kinds: two in a row are a pair."""
    rng = np.random.default_rng([SEED, KINDS.index(shape_a), KINDS.index(shape_b)])
    return tuple(random_shape(kind, rng) for _ in range(pairs) for kind in (shape_a, shape_b))


def make_trial(cell: Cell, mode: Mode, pairs: int, frames: int) -> Trial:
    """Return the pairs of a cell through all frames, each moved along one direction to a gap or depth of its regime."""
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
    compiled = CompiledPairs(shapes)
    for frame in range(frames):
        at[frame, ::2] = _placed(compiled, turns[frame], along[frame], cell.regime, share[frame])
    return Trial(cell, mode, shapes, turns, at)


def truths(trial: Trial, frames: range) -> Array:
    """Return signed distances (len(frames), pairs) [m] by the hull of all differences of vertices (qhull), exact to rounding."""
    points = [rounded_points(shape) for shape in trial.shapes]
    distances = np.zeros((len(frames), trial.pairs))
    for row, frame in enumerate(frames):
        placed = [core @ turn.T + at for (core, _), turn, at in zip(points, trial.turns[frame], trial.at[frame], strict=True)]
        for k, (a, b) in enumerate(zip(range(0, len(points), 2), range(1, len(points), 2), strict=True)):
            distances[row, k] = signed_distance(placed[a], points[a][1], placed[b], points[b][1])
    return distances


def _unit(rows: Array) -> Array:
    return np.asarray(rows / np.linalg.norm(rows, axis=-1, keepdims=True))


def _placed(pairs: CompiledPairs, turns: Array, along: Array, regime: str, share: Array) -> Array:
    """Return positions (n, 3) [m] of the first shapes, on rays from the second ones, at the wanted gaps.

    Along a ray the signed distance of convex shapes is convex: beyond the centre there is one such place. The engine's query
    finds it; `truths` are computed afterwards, without the engine.
    """
    def gaps(distance: Array) -> Array:
        at = np.zeros((2 * len(distance), 3))
        at[::2] = distance[:, None] * along
        pairs.place(turns, at)
        return pairs.cold()

    low, high = np.zeros(len(share)), np.full(len(share), pairs.reach)
    least, most = GAPS if regime == "apart" else DEPTHS[regime]
    wanted = (least + share * (most - least)) * (1.0 if regime == "apart" else gaps(low))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        beyond = gaps(middle) > wanted
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return high[:, None] * along
