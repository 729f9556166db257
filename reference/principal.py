"""Principal axes of an inertia, as engines take it: three moments and the turn of their axes."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.spatial import rotation

Array = NDArray[np.float64]

ROUNDING = 1e-15
"""Share of the largest moment below which off-diagonal entries are zero."""


def principal_axes(inertia: Array) -> tuple[Array, Array]:
    """Return moments (3,) [kg m^2] and the frame (w, x, y, z) of their axes; the given one where `inertia` (3, 3) is diagonal."""
    moments = np.diag(inertia).copy()
    if np.abs(inertia - np.diag(moments)).max() <= ROUNDING * moments.max():
        return moments, np.array(rotation.IDENTITY)
    moments, axes = np.linalg.eigh(inertia)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    return moments, rotation.from_matrix(axes)
