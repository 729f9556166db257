"""All convex pieces of a world as flat arrays: what the collision kernels read."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

POINTS = 0
"""Kind: the convex hull of points, swept by a ball. Sphere: 1 point, capsule: 2, box: 8, hull: n."""

ELLIPSOID = 1
"""Kind: exactly 4 rows, the centre and the three semi-axes as vectors (directions scaled by lengths), not
points."""


class Shapes(NamedTuple):
    """The convex pieces of a world. Vertex rows are given apart, in world coordinates, at every call.

    All arrays are C-contiguous and writeable: numba compiles every kernel again for a read-only array.
    """

    kind: NDArray[np.int64]
    """(ns,) POINTS or ELLIPSOID."""
    start: NDArray[np.int64]
    """(ns + 1,) shape s owns vertex rows start[s] .. start[s + 1]."""
    radius: NDArray[np.float64]
    """(ns,) rounding radius [m] around the points; 0 for box, hull and ellipsoid."""
    size: NDArray[np.float64]
    """(ns,) largest extent [m], the length to which all tolerances are relative."""
