"""Corners and triangles of convex pieces, for pictures: round pieces are polyhedra of a few hundred triangles."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Mesh = tuple[Array, Indices]
"""Corners (v, 3) [m] and triangles (t, 3), counter-clockwise from outside."""

RINGS, SECTORS = 10, 18
"""Fineness of round surfaces: twice as many are not told apart on a screen and make a page of 200 balls twice as large."""
CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def _ball() -> Array:
    """Return the corners (v, 3) of a ball of radius 1 with its axis along z."""
    height, turn = np.meshgrid(np.linspace(-0.5, 0.5, RINGS + 1)[1:-1] * np.pi, np.arange(SECTORS) * (2.0 * np.pi / SECTORS))
    rings = np.stack([np.cos(height) * np.cos(turn), np.cos(height) * np.sin(turn), np.sin(height)], axis=-1).reshape(-1, 3)
    return np.concatenate([rings, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])


BALL = _ball()


def is_round(piece: Mapping[str, Any]) -> bool:
    """Return whether a piece of a scene's file has a curved surface."""
    return str(piece["kind"]) in ("sphere", "capsule", "ellipsoid")


def corners(piece: Mapping[str, Any]) -> Array:
    """Return the corners (v, 3) [m] of a piece of a scene's file, in the frame of its body."""
    kind = str(piece["kind"])
    if kind == "box":
        own = CUBE * np.array(piece["size"], dtype=np.float64)
    elif kind == "hull":
        own = np.array(piece["vertices"], dtype=np.float64)
    else:
        own = BALL * np.array(piece["radii"] if kind == "ellipsoid" else [piece["radius"]] * 3, dtype=np.float64)
    if kind == "capsule":
        half = np.array([0.0, 0.0, 0.5 * float(piece["length"])])
        own = np.concatenate([own[BALL[:, 2] > -1e-9] + half, own[BALL[:, 2] < 1e-9] - half])
    turned = rotation.rotate(np.array(piece["orientation"], dtype=np.float64), own)
    return np.asarray(turned + np.array(piece["position"], dtype=np.float64))


@lru_cache(maxsize=512)
def _hull(shape: bytes) -> tuple[Indices, Array]:
    """Return triangles (t, 3) and outward planes (t, 4) of the hull of corners (v, 3), given as bytes."""
    points = np.frombuffer(shape).reshape(-1, 3)
    try:
        found = ConvexHull(points)
    except QhullError as error:
        raise ValueError("a piece without a volume") from error
    a, b, c = (points[found.simplices[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), found.equations[:, :3]) < 0.0
    return np.where(inwards[:, None], found.simplices[:, ::-1], found.simplices).astype(np.int64), found.equations


def hull(points: Array) -> tuple[Indices, Array]:
    """Return triangles (t, 3) and outward planes (t, 4) of the hull of points (v, 3). Raises ValueError for flat ones."""
    return _hull(np.ascontiguousarray(points, dtype=np.float64).tobytes())


def body(pieces: Sequence[Mapping[str, Any]]) -> Mesh:
    """Return the triangles of a body; corners of flat faces are not shared, so that their edges are sharp."""
    places, faces, count = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0
    for piece in pieces:
        points = corners(piece)
        triangles, _ = hull(points)
        if not is_round(piece):
            points, triangles = points[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3)
        places.append(points)
        faces.append(triangles + count)
        count += len(points)
    return np.concatenate(places), np.concatenate(faces)
