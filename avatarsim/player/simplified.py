"""Meshes of files with fewer triangles, for drawing: vertex clustering, and edges that stay sharp."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from avatarsim.assets.meshes.mesh import areas
from avatarsim.assets.meshes.repairs import edges_of
from avatarsim.assets.models.pieces_of_geoms import Visual
from avatarsim.player.surfaces import Array, Indices, Surface, surface
from avatarsim.scene.shape import Piece

TRIANGLES = 70_000
"""Triangles of an avatar's meshes together: 1.2 MB of a page. More: pages of short clips pass 3 MB together with their motions;
fewer: thin fingers lose their shape."""
ROOM_TRIANGLES = 30_000
"""Triangles of a room's meshes together, which are larger and farther away."""
FIRST_CELL = 1.0
"""Size of the first cells, over the side of a square with each triangle's share of the whole area."""
PULL = 0.03
"""Weight of a cell's mean vertex against the planes of its triangles. Less: vertices slide along flat surfaces; more: edges and
corners are rounded."""
CREASE = 0.75
"""Cosine of the angle between two triangles beyond which their common edge is drawn as one: 41 degrees."""


def drawn(visuals: Mapping[str, Sequence[Visual]], names: Iterable[str], most: int = TRIANGLES) -> dict[str, Surface]:
    """Return the surfaces of those visuals that ``names`` have, with meshes of at most ``most`` triangles together."""
    chosen = {name: visuals[name] for name in names if name in visuals}
    parts = [part for own in chosen.values() for part in own]
    thinned = iter(simplified([part for part in parts if not isinstance(part, Piece)], most))
    return {
        name: surface([part if isinstance(part, Piece) else creased(next(thinned)) for part in own])
        for name, own in chosen.items()
    }


def simplified(meshes: Sequence[Surface], most: int) -> list[Surface]:
    """Return meshes with at most ``most`` triangles together.

    The vertices in each cell of a grid become one (Rossignac and Borrel 1993), nearest to the planes of its triangles (Lindstrom
    2000)."""
    found, count = list(meshes), sum(len(triangles) for _, triangles in meshes)
    if count <= most:
        return found
    cell = FIRST_CELL * float(np.sqrt(sum(areas(points[triangles]).sum() for points, triangles in meshes) / most))
    cell = max(cell, 1e-6 * max(float(np.ptp(points, axis=0).max(initial=0.0)) for points, _ in meshes))
    while count > most:
        found = [_clustered(points, triangles, cell) for points, triangles in meshes]
        count = sum(len(triangles) for _, triangles in found)
        # triangles go with the area of the cells
        cell *= max(1.05, float(np.sqrt(count / most)))
    return found


def _clustered(points: Array, triangles: Indices, cell: float) -> Surface:
    """Return a mesh with one vertex in each cell of a grid."""
    places = np.floor((points - points.min(axis=0)) / cell).astype(np.int64)
    _, place = np.unique(places @ np.array([1 << 42, 1 << 21, 1]), return_inverse=True)
    count = int(place.max()) + 1

    def summed(owners: Indices, values: Array) -> Array:
        columns = [np.bincount(owners, column, count) for column in values.reshape(len(values), -1).T]
        return np.stack(columns, axis=-1).astype(np.float64).reshape(count, *values.shape[1:])

    mean = summed(place, points) / summed(place, np.ones((len(points), 1)))
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals, owners = np.cross(b - a, c - a), place[triangles].ravel()
    each = np.repeat(normals, 3, axis=0)
    planes = summed(owners, each[:, :, None] * each[:, None, :])
    offsets = np.repeat(np.einsum("ij,ij->i", normals, a), 3) - np.einsum("ij,ij->i", each, mean[owners])
    weight = PULL * np.trace(planes, axis1=1, axis2=2) + 1e-300
    step = np.linalg.solve(planes + weight[:, None, None] * np.eye(3), summed(owners, each * offsets[:, None])[..., None])
    whole = np.sort(place[triangles], axis=1)
    _, first = np.unique(whole, axis=0, return_index=True)
    kept = np.sort(first[(np.diff(whole[first], axis=1) > 0).all(axis=1)])
    return mean + np.clip(step[..., 0], -cell, cell), place[triangles[kept]]


def creased(mesh: Surface) -> Surface:
    """Return a mesh whose triangles share vertices only across edges that are to look round."""
    points, triangles = mesh
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    pairs = edges_of(triangles).pairs
    one, two = pairs[np.einsum("ij,ij->i", normals[pairs[:, 0]], normals[pairs[:, 1]]) > CREASE].T
    alike = [(3 * one + i, 3 * two + j, triangles[one, i] == triangles[two, j]) for i in range(3) for j in range(3)]
    rows, columns = (np.concatenate([both[k][both[2]] for both in alike]) for k in (0, 1))
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(triangles.size, triangles.size))
    labels = connected_components(graph, directed=False)[1]
    _, first = np.unique(labels, return_index=True)
    return points[triangles.ravel()[first]], labels.reshape(-1, 3).astype(np.int64)
