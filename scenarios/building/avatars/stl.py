"""Binary STL files as convex hulls of few vertices."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.files import read_bytes
from avatarsim.scene.shape import ConvexHull, ellipsoid_hull

Array = NDArray[np.float64]

HEADER, RECORD = 84, 50
"""Bytes before the first triangle, and per triangle: normal and corners in single precision, two bytes of colour."""


def corners(path: Path) -> Array:
    """Return (3 t, 3) corners of all triangles, in the file's unit. InvalidFile when it is not a whole binary STL file."""
    valid = "a binary STL file: 84 bytes, then 50 per triangle, finite numbers"
    content = read_bytes(path, f"mesh {path.name}", valid)
    count = int.from_bytes(content[HEADER - 4 : HEADER], "little") if len(content) >= HEADER else 0
    if count == 0 or len(content) != HEADER + RECORD * count:
        raise InvalidFile(f"length of {path.name}", len(content), valid)
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
    triangles = np.frombuffer(content, triangle, count, HEADER)["corners"].reshape(-1, 3).astype(np.float64)
    if not np.isfinite(triangles).all():
        raise InvalidFile(f"numbers of {path.name}", "not all finite", valid)
    return triangles


def hull_of(path: Path, scale: Array, directions: int) -> ConvexHull:
    """Return the hull of the mesh's farthest points in `directions` even directions, `scale` (3,) metres per unit.

    It lies inside the whole hull, by a fraction of a millimetre for a finger, and costs a tenth.
    """
    points = corners(path) * scale
    sphere = ellipsoid_hull((1.0, 1.0, 1.0), directions).vertices
    chosen = np.unique(np.argmax(points @ sphere.T, axis=0))
    return ConvexHull(np.unique(points[chosen], axis=0))
