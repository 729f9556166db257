"""All convex pieces of a world as flat arrays: what the collision kernels read."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.record import table_of

POINTS = 0
"""Kind: the convex hull of points, swept by a ball. Sphere: 1 point, capsule: 2, box: 8, hull: n."""

ELLIPSOID = 1
"""Kind: exactly 4 rows, the centre and the three semi-axes as vectors (directions scaled by lengths), not
points."""


BOX_CORNERS = 8
"""Points of a box, in the order of three nested loops over low and high x, y, z: corner 0 is opposite to corner 7."""

BENT = 4e-15
"""Relative to the largest coordinate: how far eight points may be off a box and still count as one. Larger: the support of
a box is off by as much; smaller: boxes laid far from their frame's origin miss a short cut."""

SHAPE = np.dtype([("kind", "i8"), ("start", "i8"), ("radius", "f8"), ("extent", "f8"), ("box", "i8")], align=True)
"""One row of Shapes; whole words, as an arena wants them."""


class Shapes(np.recarray[Any, np.dtype[Any]]):
    """The convex pieces of a world: ns rows, and one more of which only ``start`` means anything.

    Vertex rows are given apart, in world coordinates, at every call. One array of records and no tuple of arrays: it is handed
    from kernel to kernel as seven words, and what a query wants to know of a shape lies in one line of the processor's cache.
    """

    kind: NDArray[np.int64]
    """POINTS or ELLIPSOID."""
    start: NDArray[np.int64]
    """Shape s owns vertex rows start[s] .. start[s + 1]."""
    radius: NDArray[np.float64]
    """Rounding radius [m] around the points; 0 for box, hull and ellipsoid."""
    extent: NDArray[np.float64]
    """Largest extent [m], the length to which all tolerances are relative."""
    box: NDArray[np.int64]
    """1 if the points are the corners of a box, or of any other parallelepiped, in the order of BOX_CORNERS."""


def make_shapes(
    kind: Sequence[int] | NDArray[np.int64], start: Sequence[int] | NDArray[np.int64],
    radius: Sequence[float] | NDArray[np.float64], extent: Sequence[float] | NDArray[np.float64], points: NDArray[np.float64],
) -> Shapes:
    """Shapes of ns kinds, ns + 1 starts, ns radii and extents. ``points`` (nv, 3) are their rows, in any frame: they say which
    is a box."""
    ns = len(kind)
    made = np.zeros(ns + 1, SHAPE)
    made["start"] = start
    made["kind"][:ns], made["radius"][:ns], made["extent"][:ns] = kind, radius, extent
    for s in range(ns):
        made["box"][s] = made["kind"][s] == POINTS and is_box(points[made["start"][s] : made["start"][s + 1]])
    return made.view(Shapes)


def is_box(points: NDArray[np.float64]) -> bool:
    """Whether points are the corners of a parallelepiped in the order of BOX_CORNERS, but for the rounding of coordinates."""
    if len(points) != BOX_CORNERS:
        return False
    low, x, y, z = points[0], points[4] - points[0], points[2] - points[0], points[1] - points[0]
    meant = low + np.array([i * x + j * y + k * z for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    return bool(np.abs(meant - points).max() <= BENT * np.abs(points).max())


shapes_in = table_of(Shapes, SHAPE)
"""The Shapes in these words, in a tuple of one."""
