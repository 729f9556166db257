"""Triangles of convex pieces, for pictures only: corners of flat faces are not shared, those of round ones are."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Triangles = NDArray[np.int64]
Mesh = tuple[Array, Triangles]
"""Corners (v, 3) [m] and triangles (t, 3), counter-clockwise from outside."""

RINGS, SECTORS = 10, 18
"""Fineness of round surfaces: twice as many are not told apart on a screen and make a page of 200 balls twice as large."""
CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def box(size: Sequence[float]) -> Mesh:
    """Twelve triangles of a box with full edges `size` [m]."""
    corners = np.concatenate([CUBE[list(side)] for side in SIDES]) * np.array(size)
    return corners, np.array([[4 * k, 4 * k + i, 4 * k + i + 1] for k in range(6) for i in (1, 2)])


def ball(radii: Sequence[float], stretch: float = 0.0) -> Mesh:
    """An ellipsoid with semi-axes `radii` [m], its halves moved apart along z by `stretch` [m]: a capsule when it is round."""
    heights = np.linspace(0.5 * np.pi, -0.5 * np.pi, RINGS + 1)
    rings = np.concatenate([heights[: RINGS // 2 + 1], heights[RINGS // 2 :]]) if stretch else heights
    turns = np.linspace(0.0, 2.0 * np.pi, SECTORS, endpoint=False)
    shift = np.where(np.arange(len(rings)) <= RINGS // 2, 0.5, -0.5) * stretch
    across = np.cos(rings)[:, None]
    points = np.stack(
        [
            radii[0] * across * np.cos(turns),
            radii[1] * across * np.sin(turns),
            np.broadcast_to((radii[2] * np.sin(rings) + shift)[:, None], (len(rings), SECTORS)),
        ],
        axis=-1,
    )
    row, column = np.meshgrid(np.arange(len(rings) - 1), np.arange(SECTORS), indexing="ij")
    near, far = row * SECTORS + column, row * SECTORS + (column + 1) % SECTORS
    below, beyond = near + SECTORS, far + SECTORS
    faces = np.concatenate([np.stack([near, below, far], -1).reshape(-1, 3), np.stack([far, below, beyond], -1).reshape(-1, 3)])
    return points.reshape(-1, 3), faces


def hull(vertices: Sequence[Sequence[float]]) -> Mesh:
    """The triangles of a convex hull of vertices (n, 3) [m]."""
    points = np.array(vertices, dtype=np.float64)
    found = ConvexHull(points)
    corners = points[found.simplices]
    out = np.einsum("ij,ij->i", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), found.equations[:, :3])
    corners[out < 0.0] = corners[out < 0.0][:, ::-1]
    return corners.reshape(-1, 3), np.arange(corners.shape[0] * 3).reshape(-1, 3)


MADE: Mapping[str, Callable[[Mapping[str, Any]], Mesh]] = {
    "sphere": lambda piece: ball([float(piece["radius"])] * 3),
    "capsule": lambda piece: ball([float(piece["radius"])] * 3, float(piece["length"])),
    "box": lambda piece: box(piece["size"]),
    "ellipsoid": lambda piece: ball(piece["radii"]),
    "hull": lambda piece: hull(piece["vertices"]),
}
"""From a piece of a scene's file, by its kind, to its triangles in the piece's own frame."""


def body(pieces: Sequence[Mapping[str, Any]]) -> Mesh:
    """All pieces of a body in the body's frame; without pieces, nothing."""
    corners, faces, count = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0
    for piece in pieces:
        points, own = MADE[str(piece["kind"])](piece)
        turned = rotation.rotate(np.array(piece["orientation"], dtype=np.float64), points)
        corners.append(turned + np.array(piece["position"], dtype=np.float64))
        faces.append(own + count)
        count += len(points)
    return np.concatenate(corners), np.concatenate(faces)
