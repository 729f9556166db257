"""Hausdorff distance between pieces and a mesh: an upper bound, and a lower one that some point reaches.

One-sided Hausdorff distance from pieces to a mesh, filled cavities included: an upper bound by branch and bound over boxes.

One-sided Hausdorff distance from a mesh to its pieces: an upper bound by branch and bound over triangles.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.meshes.hulls import Hull
from avatarsim.assets.meshes.mesh import Array, Indices, areas
from avatarsim.assets.meshes.mesh_queries import Surface, finer, halves, inside_closed, inside_open

MOST_BOXES = 60_000
"""Boxes at once beyond which refinement stops; the bound then is looser, never wrong. More: seconds."""

SHARP = 0.05
"""Share of the farthest distance by which the bound may exceed it. Smaller: hulls that stick out far take seconds longer."""

SEED_SPACING = 2.0
"""Spacing of the first points tried, in radii of the surface's triangles. Wider: a worse start, more boxes."""

Inside = Callable[[Array], NDArray[np.bool_]]


def added(hulls: list[Hull], surface: Surface, inside: Inside, tolerance: float) -> tuple[float, float]:
    """Return (above, below): all points of the hulls are within `above` of the mesh, and one is at least `below` away.

    Each hull is cut into boxes. With the middle of a box at distance d from the surface and its corners r away, no point in
    it is farther than d + r from the mesh, and than r - d if the middle lies inside: that much of the path is left when it
    comes out. A box is settled when it lies outside the hull, or when nothing in it can be farther than the farthest
    point found, but for `tolerance` or a share SHARP of it.
    """
    boxes = _Boxes(hulls)
    best = _on_hulls(hulls, surface, inside)
    above, found = 0.0, 0.0 if best is None else surface.exact(best)
    while len(boxes.owner):
        boxes.select(boxes.touch_hull())
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
        boxes.select(~settled)
        boxes.halve()
    below = 0.0 if best is None else surface.exact(best)
    return max(above, below), below


def _on_hulls(hulls: list[Hull], surface: Surface, inside: Inside) -> Array | None:
    """Return a point (3,) on a hull far outside the mesh, if any: a start that settles most boxes at once."""
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

    def select(self, chosen: NDArray[np.bool_]) -> None:
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
        """Return the boxes that no face of their hull cuts off."""
        return self._heights(self.half) <= 0.0

    def middle_in_hull(self) -> NDArray[np.bool_]:
        return self._heights(0.0 * self.half) <= 0.0

    def _heights(self, half: Array) -> Array:
        """Return the largest signed height over the hull's planes of the lowest corner of each box."""
        found = np.zeros(len(self.owner))
        for k in np.unique(self.owner):
            own = np.flatnonzero(self.owner == k)
            planes = self.hulls[k].planes
            lowest = self.middle[own] @ planes[:, :3].T + planes[:, 3] - half[own] @ np.abs(planes[:, :3]).T
            found[own] = lowest.max(axis=1)
        return found


MOST_TRIANGLES = 200_000
"""Triangles at once beyond which refinement stops; the bound then is looser, never wrong. More: memory and seconds."""


def uncovered(hulls: list[Hull], corners: Array, tolerance: float) -> tuple[float, float]:
    """Return (above, below): all points of the surface (t, 3, 3) are within `above` of a hull, and one is `below` away.

    The distance from one convex hull, over a triangle, is largest at a corner. So a triangle is settled by the hull
    whose worst corner is nearest. A triangle that exceeds the farthest corner found by more than `tolerance`, or a share SHARP
    of it, is halved.
    """
    above = below = 0.0
    while len(corners):
        enough = below + max(tolerance, SHARP * below)
        worst, attained = _by_corners(hulls, corners, enough)
        below = max(below, attained)
        settled = worst <= enough
        if len(corners) > MOST_TRIANGLES:
            settled[:] = True
        above = max(above, float(worst[settled].max(initial=0.0)))
        corners = halves(corners[~settled])
    return max(above, below), below


def _by_corners(hulls: list[Hull], corners: Array, enough: float) -> tuple[Array, float]:
    """Return a bound (t,) of each triangle's distance from the hulls, and the distance of some corner that lies outside all."""
    points = corners.reshape(-1, 3)
    heights = np.stack([hull.heights(points) for hull in hulls])
    nearest = _corner_distances(hulls, points, heights)
    worst = np.full(len(corners), np.inf)
    for hull, height in zip(hulls, heights, strict=True):
        by_corner = height.reshape(-1, 3)
        # a height never exceeds the distance: a triangle with a higher corner cannot be settled by this hull
        hopeful = (by_corner <= enough).all(axis=1)
        inside = hopeful & (by_corner <= 0.0).all(axis=1)
        worst[inside] = 0.0
        rest = np.flatnonzero(hopeful & ~inside & (worst > enough))
        if len(rest):
            far = hull.distances(corners[rest].reshape(-1, 3)).reshape(-1, 3).max(axis=1)
            worst[rest] = np.minimum(worst[rest], far)
    # for the few left over by refinement: no point is farther from a corner than the longest edge
    edge = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    return np.minimum(worst, nearest.reshape(-1, 3).min(axis=1) + edge), float(nearest.max())


def _corner_distances(hulls: list[Hull], points: Array, heights: Array) -> Array:
    """Return the distance (n,) of points (n, 3) from the nearest hull; `heights` (hulls, n) bound it from below."""
    lowest = heights.min(axis=0)
    found = np.where(lowest <= 0.0, 0.0, np.inf)
    outside = np.flatnonzero(lowest > 0.0)
    order = np.argsort(heights[:, outside], axis=0)
    for row in order:
        pending = heights[row, outside] < found[outside]
        if not pending.any():
            break
        for k in np.unique(row[pending]):
            chosen = outside[pending & (row == k)]
            found[chosen] = np.minimum(found[chosen], hulls[k].distances(points[chosen]))
    return found


RESOLUTION = 4e-3
"""Share of the mesh's size by which the bound may always exceed the distance that is reached. A tenth of it costs a hundred
times the boxes."""


@dataclass(frozen=True)
class Deviation:
    """Distances between pieces and mesh, in the mesh's unit.

    uncovered  no point of the mesh's surface is farther than this from the nearest piece
    added      no point of a piece is farther than this from the mesh, its inside included
    reached    some point is at least this far: how sharp the two bounds are
    """

    uncovered: float
    added: float
    reached: float

    @property
    def hausdorff(self) -> float:
        """Bound of the distance in both directions."""
        return max(self.uncovered, self.added)


def deviation(hulls: list[Hull], corners: Array, closed: bool) -> Deviation:
    """Measure hulls against a surface (t, 3, 3); of one with holes, `inside` is where it fills over half the view."""
    solid = corners[areas(corners) > 0.0]
    size = float(np.linalg.norm(np.ptp(solid.reshape(-1, 3), axis=0)))
    out, out_reached = uncovered(hulls, solid, RESOLUTION * size)
    inside = partial(inside_closed if closed else inside_open, corners=corners)
    over, over_reached = added(hulls, Surface(solid), inside, RESOLUTION * size)
    return Deviation(out, over, max(out_reached, over_reached))
