"""One-sided Hausdorff distance from pieces to a mesh, filled cavities included: an upper bound by branch and bound over boxes."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from avatarsim.pieces.hulls import Hull
from avatarsim.pieces.mesh import Array, Indices
from avatarsim.pieces.nearest import Surface, finer

MOST_BOXES = 60_000
"""Boxes at once beyond which refinement stops; the bound then is looser, never wrong. More: seconds."""

SHARP = 0.05
"""Share of the farthest distance by which the bound may exceed it. Smaller: hulls that stick out far take seconds longer."""

SEED_SPACING = 2.0
"""Spacing of the first points tried, in radii of the surface's triangles. Wider: a worse start, more boxes."""

Inside = Callable[[Array], NDArray[np.bool_]]


def added(hulls: list[Hull], surface: Surface, inside: Inside, tolerance: float) -> tuple[float, float]:
    """(above, below): no point of the hulls is farther than `above` from the mesh, and one is at least `below` away.

    Each hull is cut into boxes. With the middle of a box at distance d from the surface and its corners r away, nothing in
    it is farther than d + r from the mesh, and than r - d if the middle lies inside: that much of the way is left when it
    comes out. A box is settled when it lies outside the hull, or when nothing in it can be farther than the farthest
    point found, but for `tolerance` or a share SHARP of it.
    """
    boxes = _Boxes(hulls)
    best = _on_hulls(hulls, surface, inside)
    above, found = 0.0, 0.0 if best is None else surface.exact(best)
    while len(boxes.owner):
        boxes.keep(boxes.touch_hull())
        enough = found + max(tolerance, SHARP * found)
        reach = np.linalg.norm(boxes.half, axis=1)
        far, near = surface.distances(boxes.middle, np.maximum(reach, found))
        asked = ~boxes.free & (far + reach > enough)
        within = np.zeros(len(far), dtype=bool)
        within[asked] = inside(boxes.middle[asked])
        boxes.free |= asked & ~within & (near > reach)
        out = np.where((boxes.free | (asked & ~within)) & boxes.middle_in_hull(), far, 0.0)
        if out.max(initial=0.0) > found:
            best = boxes.middle[int(out.argmax())]
            found = float(out.max())
        bound = np.where(within, np.maximum(reach - near, 0.0), far + reach)
        settled = bound <= enough
        if len(far) - int(settled.sum()) > MOST_BOXES:
            settled[:] = True
        above = max(above, float(bound[settled].max(initial=0.0)))
        boxes.keep(~settled)
        boxes.halve()
    below = 0.0 if best is None else surface.exact(best)
    return max(above, below), below


def _on_hulls(hulls: list[Hull], surface: Surface, inside: Inside) -> Array | None:
    """A point (3,) on a hull far outside the mesh, if any: a start that settles most boxes at once."""
    points = np.concatenate([finer(hull.facets, SEED_SPACING * surface.radius).mean(axis=1) for hull in hulls])
    candidates = points[np.argsort(-surface.distances(points)[0])]
    for first in range(0, len(candidates), 1000):
        free = np.flatnonzero(~inside(candidates[first : first + 1000]))
        if len(free):
            return np.asarray(candidates[first + free[0]])
    return None


class _Boxes:
    """Boxes with a middle and half edges; `owner` is the hull that a box is part of, `free` ones lie outside the mesh."""

    def __init__(self, hulls: list[Hull]) -> None:
        self.hulls = hulls
        low = np.array([hull.points[hull.used].min(axis=0) for hull in hulls])
        high = np.array([hull.points[hull.used].max(axis=0) for hull in hulls])
        self.middle, self.half = 0.5 * (low + high), 0.5 * (high - low)
        self.owner: Indices = np.arange(len(hulls))
        self.free = np.zeros(len(hulls), dtype=bool)

    def keep(self, chosen: NDArray[np.bool_]) -> None:
        self.middle, self.half = self.middle[chosen], self.half[chosen]
        self.owner, self.free = self.owner[chosen], self.free[chosen]

    def halve(self) -> None:
        """Cut each box across its longest edge."""
        rows, axis = np.arange(len(self.owner)), self.half.argmax(axis=1) if len(self.owner) else np.zeros(0, dtype=np.int64)
        half = self.half.copy()
        half[rows, axis] *= 0.5
        shift = np.zeros_like(half)
        shift[rows, axis] = half[rows, axis]
        self.middle = np.concatenate([self.middle - shift, self.middle + shift])
        self.half = np.concatenate([half, half])
        self.owner, self.free = np.tile(self.owner, 2), np.tile(self.free, 2)

    def touch_hull(self) -> NDArray[np.bool_]:
        """Boxes that no face of their hull cuts off."""
        return self._heights(np.abs, self.half) <= 0.0

    def middle_in_hull(self) -> NDArray[np.bool_]:
        return self._heights(np.abs, 0.0 * self.half) <= 0.0

    def _heights(self, size: Callable[[Array], Array], half: Array) -> Array:
        """Largest signed height over the hull's planes of the lowest corner of each box."""
        found = np.zeros(len(self.owner))
        for k in np.unique(self.owner):
            own = np.flatnonzero(self.owner == k)
            planes = self.hulls[k].planes
            lowest = self.middle[own] @ planes[:, :3].T + planes[:, 3] - half[own] @ size(planes[:, :3]).T
            found[own] = lowest.max(axis=1)
        return found
