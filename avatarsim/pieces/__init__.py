"""Approximate convex decomposition of meshes: `pieces_of_mesh`."""

from avatarsim.pieces.found import Pieces
from avatarsim.pieces.from_mesh import pieces_of_mesh

__all__ = ["Pieces", "pieces_of_mesh"]
