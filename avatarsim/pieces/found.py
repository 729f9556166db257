"""Result of a convex decomposition: convex pieces for a body, with bounds of their distance from the mesh."""

from dataclasses import dataclass

from avatarsim.scene.shape import ConvexHull, Piece


@dataclass(frozen=True)
class Pieces:
    """Convex pieces of one mesh, for `Body(..., pieces=found.pieces, ...)`.

    pieces      hulls in the mesh's own frame [m], scaled and turned as asked
    source      "convex groups" or "convex mesh" (vertices as authored), "hull" (one hull was asked for), "decomposed"
    uncovered   [m] no point of the mesh's surface is farther than this from the nearest piece
    added       [m] no point of a piece is farther than this from the mesh, its inside included
    size        [m] diagonal of the box around the mesh, in its own axes
    reached     [m] some point is this far: at most `hausdorff`, and how sharp that bound is
    repairs     one sentence for everything that was changed before pieces were made
    from_cache  True when nothing had to be computed
    cache_note  where the answer was kept, or why it was not
    seconds     [s] that the call took

    Bounds hold up to rounding. A mesh with holes has its inside where it fills more than half of the view.
    """

    pieces: tuple[Piece, ...]
    source: str
    uncovered: float
    added: float
    reached: float
    size: float
    repairs: tuple[str, ...]
    from_cache: bool
    cache_note: str
    seconds: float

    @property
    def hausdorff(self) -> float:
        """[m] bound of the Hausdorff distance: nothing of the surface or of the pieces is farther from the other."""
        return max(self.uncovered, self.added)

    @property
    def vertices(self) -> tuple[int, ...]:
        """Number of vertices of every piece."""
        return tuple(len(piece.shape.vertices) for piece in self.pieces if isinstance(piece.shape, ConvexHull))
