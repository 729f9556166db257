"""Approximate convex decomposition of meshes: `pieces_of_mesh`."""

from avatarsim.assets.meshes.convex_pieces import Pieces, pieces_of_mesh

__all__ = ["Pieces", "pieces_of_mesh"]
