"""Checks a claimed signed distance against what any direction proves about it.

Along a unit axis, the gap between two shadows never exceeds the signed distance of the bodies. So the axis that comes
with a claim proves that the bodies are at least that far apart (or at most that deep), and any other axis with a larger
gap refutes it. What the check cannot see is a depth claimed too large whose true axis is no face's normal.
"""

import numpy as np
from numpy.typing import NDArray

from reference.judge_geometry import Outline

Array = NDArray[np.float64]

PROVEN = 1e-8
"""Metres by which a claim may differ from its proof: the accuracy that the judge promises. Below 1e-9, the tolerance of
the iterations themselves, sound claims would be refuted."""


def separations(a: Outline, turn_a: Array, b: Outline, turn_b: Array, from_b_to_a: Array, axes: Array) -> Array:
    """Gap (k,) [m] between the shadows of a and b on unit world `axes` (k, 3) that point out of b into a.

    turn (3, 3) are the placements' rotations and `from_b_to_a` (3,) [m] the difference of their origins.
    """
    return axes @ from_b_to_a - a.reach(-axes @ turn_a) - b.reach(axes @ turn_b)


def largest_over_faces(a: Outline, turn_a: Array, b: Outline, turn_b: Array, from_b_to_a: Array) -> float:
    """Largest separation [m] over the face normals of a and b; -inf when neither has faces. Same arguments."""
    best = -np.inf
    if len(a.faces):
        out_of_a = a.faces @ turn_a.T
        best = float((-(out_of_a @ from_b_to_a) - a.offsets - b.reach(-out_of_a @ turn_b)).max())
    if len(b.faces):
        out_of_b = b.faces @ turn_b.T
        best = max(best, float((out_of_b @ from_b_to_a - b.offsets - a.reach(-out_of_b @ turn_a)).max()))
    return best


def holds(claim: float, normal: Array, a: Outline, turn_a: Array, b: Outline, turn_b: Array, from_b_to_a: Array) -> bool:
    """True when `claim` [m] is proven by its `normal` (out of b into a) and not refuted by any face of a or b."""
    proven = separations(a, turn_a, b, turn_b, from_b_to_a, normal[None])[0] >= claim - PROVEN
    if not proven or claim >= 0.0:
        return bool(proven)
    return largest_over_faces(a, turn_a, b, turn_b, from_b_to_a) <= claim + PROVEN


def by_directions(a: Outline, turn_a: Array, b: Outline, turn_b: Array, from_b_to_a: Array) -> float:
    """Signed distance [m] as the largest separation over all directions, by brute force: for smooth shapes.

    Two thousand directions spread over the sphere; from the best of them, a ring of trials that turns with every step,
    and shrinks when none of them is better. Never too shallow by mistake: what it returns is a separation.
    """
    k = np.arange(SPREAD) + 0.5
    height, turn = 1.0 - 2.0 * k / SPREAD, np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - height * height)
    axes = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=-1)
    found = separations(a, turn_a, b, turn_b, from_b_to_a, axes)
    best, radius = axes[np.argsort(-found)[:SEEDS]], np.full(SEEDS, 0.1)
    value = np.full(SEEDS, -np.inf)
    for step in range(STEPS):
        # a ring that stands still never finds the way along a ridge between two of its trials
        angles = np.arange(12) * (np.pi / 6.0) + 2.4 * step
        side = np.cross(best, np.eye(3)[np.argmin(np.abs(best), axis=1)])
        side /= np.linalg.norm(side, axis=1)[:, None]
        other = np.cross(best, side)
        steps = np.cos(angles)[:, None] * side[:, None] + np.sin(angles)[:, None] * other[:, None]
        tried = np.concatenate([best[:, None], best[:, None] + radius[:, None, None] * steps], axis=1)
        tried /= np.linalg.norm(tried, axis=-1, keepdims=True)
        there = separations(a, turn_a, b, turn_b, from_b_to_a, tried.reshape(-1, 3)).reshape(tried.shape[:2])
        choice = there.argmax(axis=1)
        best, value = tried[np.arange(SEEDS), choice], there.max(axis=1)
        radius = np.where(choice == 0, 0.7 * radius, radius)
    return float(value.max())


SPREAD = 2000
"""Directions tried first, about 4 degrees apart; fewer may miss the basin of the least depth of a flat ellipsoid."""

SEEDS = 24
"""How many of them are refined; with fewer, all may lie in one basin that is not the deepest."""

STEPS = 250
"""Rings per refinement. Half as many leave micrometres where a box's edge makes the separation a ridge."""
