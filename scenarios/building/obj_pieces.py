"""OBJ files whose groups are convex pieces, placed as the gallery's objects stand: one hull per group, taken as it is."""

from pathlib import Path

import numpy as np

from avatarsim.assets.meshes.mesh import groups
from avatarsim.scene.shape import ConvexHull, Piece

__all__ = ["convex_pieces", "groups"]


def convex_pieces(path: Path, scale: float, y_up: bool) -> tuple[Piece, ...]:
    """One hull per group, `scale` metres per unit; the body frame is below the middle of the object's box, z up.

    The groups are taken to be convex, as their author decomposed them: the hull of a group is the group. A test says so
    for every mesh of the gallery; `avatarsim.assets.meshes.pieces_of_mesh` tests it at every call.
    """
    hulls = []
    for vertices, _ in groups(path):
        points = scale * vertices
        hulls.append(np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=-1) if y_up else points)
    low, high = np.vstack(hulls).min(axis=0), np.vstack(hulls).max(axis=0)
    foot = np.array([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2]])
    return tuple(Piece(ConvexHull(points - foot)) for points in hulls)
