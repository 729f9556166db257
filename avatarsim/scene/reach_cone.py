"""Reach cones: the directions that a limb may take, as a spherical polygon (Wilhelms and Van Gelder)."""

from dataclasses import dataclass

import numpy as np

from avatarsim.errors import InvalidScene
from avatarsim.scene.checks import Vector, finite_array, unit_vector

SHORTEST_EDGE, LOWEST_SIGHT = 1e-6, 1e-6
"""A reach cone's edges and the heights from which they are seen, as sines: below, rounding decides which side is inside."""


def angle(a: np.typing.NDArray[np.float64], b: np.typing.NDArray[np.float64]) -> float:
    """Angle [rad] of two unit vectors (3,)."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


@dataclass(frozen=True, eq=False)
class ReachCone:
    """Directions that a limb may take, as a spherical polygon of unit `vertices` (n, 3) in the parent frame,
    counter-clockwise seen from outside, with a point inside that sees every edge (Wilhelms and Van Gelder)."""

    vertices: np.typing.NDArray[np.float64]
    visible_point: Vector

    def __post_init__(self) -> None:
        vertices = finite_array("reach cone vertices", self.vertices, (-1, 3))
        lengths = np.linalg.norm(vertices, axis=1)
        if len(vertices) < 3 or not (lengths > 1e-12).all():
            raise InvalidScene("reach cone vertices", vertices.tolist(), "at least 3 directions of non-zero length")
        vertices /= lengths[:, None]
        vertices.flags.writeable = False
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "visible_point", unit_vector("visible point of the reach cone", self.visible_point))
        self._require_sight()

    def _require_sight(self) -> None:
        """Every edge seen from its inner side, and once around: else the triangles of point and edges are not the polygon."""
        seen, ends = np.array(self.visible_point), np.roll(self.vertices, -1, axis=0)
        normals = np.cross(self.vertices, ends)
        lengths = np.linalg.norm(normals, axis=1)
        if not (lengths > SHORTEST_EDGE).all():
            raise InvalidScene("edge of the reach cone: sine of its length", float(lengths.min()), f"above {SHORTEST_EDGE:g}")
        sines = normals @ seen / lengths
        if not (sines > LOWEST_SIGHT).all():
            thing = "visible point of the reach cone: sine of its height above an edge"
            raise InvalidScene(thing, float(sines.min()), f"above {LOWEST_SIGHT:g}, with corners counter-clockwise from outside")
        flat = self.vertices - np.outer(self.vertices @ seen, seen)
        turns = np.arctan2(np.cross(flat, np.roll(flat, -1, axis=0)) @ seen, (flat * np.roll(flat, -1, axis=0)).sum(axis=1))
        if not abs(turns.sum() - 2.0 * np.pi) < 1e-6:
            once = float(turns.sum() / (2.0 * np.pi))
            raise InvalidScene("turns of the reach cone's corners around its visible point", once, "1")
