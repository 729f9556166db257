"""When does each engine look worst in a scene? The state that its button on the page leads to, and why that one."""

from dataclasses import dataclass

import numpy as np

from reports.kept import Array, Shown
from reports.wording import quantity

LEAST = 1e-6
"""Overlap, or distance from the tracker [m], that is worth a button: the bound on what may be shown."""


@dataclass(frozen=True)
class Moment:
    """The worst state of a run, counted from 0, and what is wrong with it in words."""

    state: int
    said: str


def worst(one: Shown, depth: Array | None) -> Moment | None:
    """The first state that is no number; else the deepest overlap, by the judge's `depth` (F+1,) [m] or by the pairs; else the
    state farthest from the raw tracker; None where a run has none of these."""
    broken = ~(np.isfinite(one.positions).all(axis=(1, 2)) & np.isfinite(one.orientations).all(axis=(1, 2)))
    if broken.any():
        return Moment(int(np.argmax(broken)), "a pose is no number")
    depths = np.zeros(len(one.times)) if depth is None or depth.size != len(one.times) else np.nan_to_num(depth, nan=0.0)
    for frame, _, _, deep in one.pairs:
        if 0 <= frame < len(depths):
            depths[frame] = max(depths[frame], deep)
    state = int(np.argmax(depths))
    if depths[state] > LEAST:
        return Moment(state, f"overlap of {quantity(float(depths[state]), 'm')}")
    links = one.raw_positions.shape[1]
    if links:
        apart = np.linalg.norm(one.positions[:, -links:] - one.raw_positions, axis=2)
        farthest = np.where(np.isfinite(apart), apart, 0.0).max(axis=1)
        state = int(np.argmax(farthest))
        if farthest[state] > LEAST:
            return Moment(state, f"{quantity(float(farthest[state]), 'm')} from its user")
    return None
