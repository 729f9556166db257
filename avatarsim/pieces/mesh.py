"""A triangle mesh as it was read: vertices, triangles, and which group of the file each triangle belongs to."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Mesh:
    """`vertices` (n, 3) in the file's unit, `triangles` (t, 3) of vertex numbers, `groups` (t,) of group numbers.

    `name` is what errors call it; `welded` says whether its format shares vertices between triangles at all.
    """

    name: str
    vertices: Array
    triangles: Indices
    groups: Indices
    welded: bool = True

    @property
    def corners(self) -> Array:
        """Corners (t, 3, 3) of every triangle."""
        return self.vertices[self.triangles]

    @property
    def size(self) -> float:
        """Diagonal of the box around all vertices in use; 0 when there is none."""
        used = self.vertices[np.unique(self.triangles)]
        return float(np.linalg.norm(np.ptp(used, axis=0))) if len(used) else 0.0

    def part(self, chosen: NDArray[np.bool_]) -> "Mesh":
        """The chosen (t,) triangles, with the vertices that they use, in the order of the file."""
        used, local = np.unique(self.triangles[chosen], return_inverse=True)
        triangles = local.reshape(-1, 3).astype(np.int64)
        return Mesh(self.name, self.vertices[used], triangles, self.groups[chosen], self.welded)


def areas(corners: Array) -> Array:
    """Area (t,) of triangles with corners (t, 3, 3)."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * np.asarray(np.linalg.norm(across, axis=1))


def signed_volume(corners: Array) -> float:
    """Volume inside a closed surface with corners (t, 3, 3); negative when its triangles face inwards."""
    if not len(corners):
        return 0.0
    about = corners - corners.mean(axis=(0, 1))
    return float(np.einsum("ti,ti->", about[:, 0], np.cross(about[:, 1], about[:, 2]))) / 6.0
