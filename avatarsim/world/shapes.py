"""All convex pieces of a world as flat arrays, which the collision kernels read."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.record import known_as_table

POINTS = 0
"""Kind: the convex hull of points, swept by a ball. Sphere: 1 point, capsule: 2, box: 8, hull: n."""

ELLIPSOID = 1
"""Kind: exactly 4 rows, the centre and the three semi-axes as vectors (directions scaled by lengths), not
points."""


SHAPE = np.dtype([("kind", "i8"), ("start", "i8"), ("radius", "f8"), ("extent", "f8")], align=True)
"""One row of Shapes; whole words, as arenas require."""


class Shapes(np.recarray[Any, np.dtype[Any]]):
    """The convex pieces of a world: ns rows, and one more of which only ``start`` means anything.

    Vertex rows are passed separately, in world coordinates, at every call. One array of records and no tuple of arrays: it is
    passed from kernel to kernel as seven words, and all fields of a shape lie in one line of the processor's cache.
    """

    kind: NDArray[np.int64]
    """POINTS or ELLIPSOID."""
    start: NDArray[np.int64]
    """Shape s owns vertex rows start[s] .. start[s + 1]."""
    radius: NDArray[np.float64]
    """Rounding radius [m] around the points; 0 for box, hull and ellipsoid."""
    extent: NDArray[np.float64]
    """Largest extent [m], the length to which all tolerances are relative."""


def make_shapes(
    kind: Sequence[int] | NDArray[np.int64], start: Sequence[int] | NDArray[np.int64],
    radius: Sequence[float] | NDArray[np.float64], extent: Sequence[float] | NDArray[np.float64],
) -> Shapes:
    """Shapes of ns kinds, ns + 1 starts, ns radii and ns extents."""
    ns = len(kind)
    made = np.zeros(ns + 1, SHAPE)
    made["start"] = start
    made["kind"][:ns], made["radius"][:ns], made["extent"][:ns] = kind, radius, extent
    return made.view(Shapes)


known_as_table(Shapes, SHAPE)
