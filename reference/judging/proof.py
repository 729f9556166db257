"""Checks a claimed signed distance against the bounds that any direction proves.

Along a unit axis, the gap between two shadows never exceeds the signed distance of the bodies. So the axis that comes
with a claim proves that the bodies are at least that far apart (or at most that deep), and any other axis with a larger
gap refutes it. The check does not find a depth claimed too large whose true axis is no face's normal.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from avatarsim.spatial import rotation
from reference.judging.geometry import Outline

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

PROVEN = 1e-8
"""Metres by which a claim may differ from its proof: the accuracy that the judge promises. Below 1e-9, the tolerance of
the iterations themselves, sound claims would be refuted."""

AT_ONCE = 1_000_000
"""Numbers computed in one go; more would fill memory and not be faster."""

SMALLEST = 1e-300
"""Length that no cross product of two edges has but 0; keeps a division by 0 out."""


def separations(a: Outline, turn_a: Array, b: Outline, turn_b: Array, from_b_to_a: Array, axes: Array) -> Array:
    """Return the gap (k,) [m] between the shadows of a and b on unit world `axes` (k, 3) that point out of b into a.

    turn (3, 3) are the placements' rotations and `from_b_to_a` (3,) [m] the difference of their origins.
    """
    return axes @ from_b_to_a - a.reach(-axes @ turn_a) - b.reach(axes @ turn_b)


def largest_over_faces(a: Outline, turns_a: Array, b: Outline, turns_b: Array, from_b_to_a: Array) -> Array:
    """Return (k,) largest separation [m] over the face normals of a and b; -inf without faces. Same arguments, k of each."""
    best = np.full(len(from_b_to_a), -np.inf)
    if len(a.faces):
        out_of_a = a.faces @ turns_a.swapaxes(1, 2)
        gaps = -_along(out_of_a, from_b_to_a) - a.offsets - b.reach(-out_of_a @ turns_b)
        best = gaps.max(axis=1)
    if len(b.faces):
        out_of_b = b.faces @ turns_b.swapaxes(1, 2)
        gaps = _along(out_of_b, from_b_to_a) - b.offsets - a.reach(-out_of_b @ turns_a)
        best = np.maximum(best, gaps.max(axis=1))
    return np.asarray(best)


def _along(axes: Array, from_b_to_a: Array) -> Array:
    """Return (k, m) components of each offset (k, 3) [m] along each of its axes (k, m, 3)."""
    return np.asarray((axes @ from_b_to_a[:, :, None])[:, :, 0])


def largest_over_axes(a: Outline, turns_a: Array, b: Outline, turns_b: Array, from_b_to_a: Array) -> Array:
    """Return signed distances (k,) [m] of two polytopes where negative, else a lower bound, by the separating axis test.

    The facets of a difference of polytopes are their faces, and those spanned by one edge of each: where they overlap, the depth
    is that of the nearest of these. Any other axis is harmless, so that edges need no distinction from the diagonals of faces.
    """
    crossed = rotation.cross((a.edges @ turns_a.swapaxes(1, 2))[:, :, None], (b.edges @ turns_b.swapaxes(1, 2))[:, None])
    crossed = crossed.reshape(len(from_b_to_a), -1, 3)
    lengths = np.linalg.norm(crossed, axis=2, keepdims=True)
    # parallel edges span no facet: any axis takes their place
    crossed = np.where(lengths > 0.0, crossed / np.maximum(lengths, SMALLEST), (0.0, 0.0, 1.0))
    axes = np.concatenate([crossed, -crossed], axis=1)
    gaps = _along(axes, from_b_to_a) - a.reach(-axes @ turns_a) - b.reach(axes @ turns_b)
    return np.asarray(np.maximum(gaps.max(axis=1), largest_over_faces(a, turns_a, b, turns_b, from_b_to_a)))


def hold(claims: Array, normals: Array, a: Outline, turns_a: Array, b: Outline, turns_b: Array, from_b_to_a: Array) -> Flags:
    """Return (k,) True where a claim [m] is proven by its normal (k, 3), out of b into a, and not refuted by any face of a or b.

    turns (k, 3, 3) and from_b_to_a (k, 3) [m] are those of k placements.
    """
    reach_a = a.reach(-np.einsum("ki,kij->kj", normals, turns_a))
    reach_b = b.reach(np.einsum("ki,kij->kj", normals, turns_b))
    gaps = (normals * from_b_to_a).sum(axis=1) - reach_a - reach_b
    # a claim that is no number is not proven
    proven = np.abs(gaps - claims) <= PROVEN
    deep = np.flatnonzero(proven & (claims < 0.0))
    for some in in_parts(deep, len(a.faces) * len(b.points) + len(b.faces) * len(a.points)):
        faces = largest_over_faces(a, turns_a[some], b, turns_b[some], from_b_to_a[some])
        proven[some] = faces <= claims[some] + PROVEN
    return np.asarray(proven)


def in_parts(rows: Indices, size: int) -> list[Indices]:
    """Return `rows` in runs of which each, at `size` numbers a row, stays below AT_ONCE."""
    step = max(1, AT_ONCE // max(1, size))
    return [rows[start : start + step] for start in range(0, len(rows), step)]


def by_directions(a: Outline, turn_a: Array, b: Outline, turn_b: Array, from_b_to_a: Array) -> float:
    """Return the signed distance [m] as the largest separation over all directions, by brute force: for smooth shapes.

    Along great circles across each edge the separation has ridges, where no search in two dimensions converges: these
    are searched in one. Never too shallow by mistake: the returned value is a separation.
    """
    def value(axes: Array) -> Array:
        return separations(a, turn_a, b, turn_b, from_b_to_a, axes.reshape(-1, 3)).reshape(axes.shape[:-1])

    faces = largest_over_faces(a, turn_a[None], b, turn_b[None], from_b_to_a[None])
    largest = max(float(faces[0]), float(_on_the_sphere(value)))
    edges = np.concatenate([a.edges @ turn_a.T, b.edges @ turn_b.T])
    return max(largest, float(_across(edges, value))) if len(edges) else largest


def _on_the_sphere(value: Callable[[Array], Array]) -> float:
    """Return the largest `value` over all directions: a spread, and from the best rings that shrink when none is better."""
    k = np.arange(SPREAD) + 0.5
    height, turn = 1.0 - 2.0 * k / SPREAD, np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - height * height)
    axes = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=-1)
    best, radius = axes[np.argsort(-value(axes))[:SEEDS]], np.full(SEEDS, 0.1)
    there = np.zeros((SEEDS, 1))
    for step in range(STEPS):
        angles = np.arange(12) * (np.pi / 6.0) + 2.4 * step
        side, other = _frame(best)
        steps = np.cos(angles)[:, None] * side[:, None] + np.sin(angles)[:, None] * other[:, None]
        tried = np.concatenate([best[:, None], best[:, None] + radius[:, None, None] * steps], axis=1)
        tried /= np.linalg.norm(tried, axis=-1, keepdims=True)
        there = value(tried)
        choice = there.argmax(axis=1)
        best = tried[np.arange(SEEDS), choice]
        radius = np.where(choice == 0, 0.7 * radius, radius)
    return float(there.max())


def _across(edges: Array, value: Callable[[Array], Array]) -> float:
    """Return the largest `value` over the directions at right angles to any of the unit `edges` (e, 3): the best of a round of
    angles on each circle, and from there an interval that is cut into ten again and again."""
    side, other = _frame(edges)
    angles = np.tile(np.arange(AROUND) * (2.0 * np.pi / AROUND), (len(edges), 1))
    spacing, there = 2.0 * np.pi / AROUND, np.zeros((1, 1))
    for _ in range(10):
        axes = np.cos(angles)[..., None] * side[:, None] + np.sin(angles)[..., None] * other[:, None]
        there = value(axes)
        best = angles[np.arange(len(edges)), there.argmax(axis=1)]
        angles = best[:, None] + spacing * np.linspace(-1.0, 1.0, 21)
        spacing *= 0.1
    return float(there.max())


def _frame(axes: Array) -> tuple[Array, Array]:
    """Return two unit vectors (k, 3) each that complete unit `axes` (k, 3) to a frame."""
    side = rotation.cross(axes, np.eye(3)[np.argmin(np.abs(axes), axis=1)])
    side /= np.linalg.norm(side, axis=1)[:, None]
    return side, rotation.cross(axes, side)


SPREAD = 2000
"""Directions tried first, about 4 degrees apart; fewer may miss the basin of the least depth of a flat ellipsoid."""

SEEDS = 24
"""Number of directions that are refined; with fewer, all may lie in one basin that is not the deepest."""

STEPS = 120
"""Rings per refinement; half as many end before the rings are small enough for 1e-9 m."""

AROUND = 360
"""Angles tried first on each circle across an edge; fewer may miss a narrow hill."""
