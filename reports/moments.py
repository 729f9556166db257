"""When does each engine look worst in a scene? The states that its buttons on the page lead to, and what is wrong in each."""

from dataclasses import dataclass

import numpy as np

from reports.kept import Array, Shown
from reports.wording import quantity
from scenarios.measure.smoothness import SHAKES, reversals, shaking

LEAST = 1e-6
"""Overlap, or distance from the tracker [m], that is worth a button: the bound on what may be shown."""


@dataclass(frozen=True)
class Moment:
    """A state of a run, counted from 0, and what is wrong with it in words."""

    state: int
    said: str


def moments(one: Shown, depth: Array | None) -> tuple[Moment, ...]:
    """The first state that is no number, or else what there is of: the deepest overlap, by the judge's `depth` (F+1,) [m] or by
    the pairs; the state farthest from the raw tracker; the one that shakes most; the largest jump of a link beyond its user's."""
    broken = ~(np.isfinite(one.positions).all(axis=(1, 2)) & np.isfinite(one.orientations).all(axis=(1, 2)))
    if broken.any():
        return (Moment(int(np.argmax(broken)), "a pose is no number"),)
    found = (_overlap(one, depth), *(_moments_of_links(one) if one.raw_positions.shape[1] else ()))
    return tuple(moment for moment in found if moment is not None)


def _overlap(one: Shown, depth: Array | None) -> Moment | None:
    depths = np.zeros(len(one.times)) if depth is None or depth.size != len(one.times) else np.nan_to_num(depth, nan=0.0)
    for frame, _, _, deep in one.pairs:
        if 0 <= frame < len(depths):
            depths[frame] = max(depths[frame], deep)
    state = int(np.argmax(depths))
    return Moment(state, f"overlap of {quantity(float(depths[state]), 'm')}") if depths[state] > LEAST else None


def _moments_of_links(one: Shown) -> tuple[Moment | None, ...]:
    """Farthest from the user, shakes most, jumps most."""
    links, dt = one.positions[:, -one.raw_positions.shape[1] :], float(one.times[1] - one.times[0]) if len(one.times) > 1 else 1.0
    apart = np.nan_to_num(np.linalg.norm(links - one.raw_positions, axis=2)).max(axis=1)
    back = np.nan_to_num(reversals(links, one.raw_positions))
    back = np.where(shaking(back, dt)[:, None], back, 0.0).max(axis=1, initial=0.0)
    steps = [np.linalg.norm(np.diff(places, axis=0), axis=2) for places in (links, one.raw_positions)]
    beyond = np.nan_to_num(steps[0] - steps[1]).max(axis=1, initial=0.0)
    told = ((apart, 0, LEAST, "{} from its user"), (back, 1, LEAST, "shakes by {}"),
            (beyond, 1, SHAKES * dt, "jumps {} beyond its user in a frame"))
    found = []
    for figures, first, least, words in told:
        state = int(np.argmax(figures)) if figures.size else 0
        enough = figures.size and figures[state] > least
        found.append(Moment(state + first, words.format(quantity(float(figures[state]), "m"))) if enough else None)
    return tuple(found)
