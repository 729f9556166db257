"""Hausdorff distance between pieces and a mesh: an upper bound, and a lower one that some point reaches."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from avatarsim.pieces.added import added
from avatarsim.pieces.hulls import Hull
from avatarsim.pieces.inside import inside_closed, inside_open
from avatarsim.pieces.mesh import Array, areas
from avatarsim.pieces.nearest import Surface
from avatarsim.pieces.uncovered import uncovered

RESOLUTION = 4e-3
"""Share of the mesh's size by which the bound may always exceed the distance that is reached. A tenth of it costs a hundred
times the boxes."""


@dataclass(frozen=True)
class Deviation:
    """How far pieces and mesh are apart, in the mesh's unit.

    uncovered  no point of the mesh's surface is farther than this from the nearest piece
    added      no point of a piece is farther than this from the mesh, its inside included
    reached    some point is at least this far: how sharp the two bounds are
    """

    uncovered: float
    added: float
    reached: float

    @property
    def hausdorff(self) -> float:
        """Bound of the distance in both directions."""
        return max(self.uncovered, self.added)


def deviation(hulls: list[Hull], corners: Array, closed: bool) -> Deviation:
    """Measure hulls against a surface (t, 3, 3); of one with holes, `inside` is where it fills over half the view."""
    solid = corners[areas(corners) > 0.0]
    size = float(np.linalg.norm(np.ptp(solid.reshape(-1, 3), axis=0)))
    out, out_reached = uncovered(hulls, solid, RESOLUTION * size)
    inside = partial(inside_closed if closed else inside_open, corners=corners)
    over, over_reached = added(hulls, Surface(solid), inside, RESOLUTION * size)
    return Deviation(out, over, max(out_reached, over_reached))
