"""Working memory of the convex queries: made once, passed to every call, holds nothing between calls.

One structured record and no tuple of arrays: numba passes a record as one pointer, an array as seven words or more. With a tuple
of these fifteen arrays the calls within the narrow phase copied more than 1 kB each.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.record import known_by_pointer

POINTS_CAP = 768
"""Vertices of the growing polytope. Two hulls of 60 vertices need under 100, of 300 under 200. Nearly round ellipsoids about
one centre need most of it to show that no other way out is shorter; smaller: more of them end OUT_OF_ITERATIONS."""

FACES_CAP = 2 * POINTS_CAP
"""A closed triangulated polytope of v vertices has 2 v - 4 faces."""

PIECES_CAP = 256
"""Overlapping piece pairs of two bodies in eq. 1; more is reported as OUT_OF_ROOM, never dropped."""


class Scratch(np.record):  # type: ignore[misc]  # numpy calls it final, and its manual derives from it
    """Points of A - B, faces of the polytope they span, and the piece pairs of eq. 1."""

    w: NDArray[np.float64]
    """(POINTS_CAP, 3) points of A - B [m]; the simplex of `gjk` is in the first rows."""
    on_a: NDArray[np.float64]
    """(POINTS_CAP, 3) the point of A that made w."""
    on_b: NDArray[np.float64]
    """(POINTS_CAP, 3) the point of B that made w."""
    rows: NDArray[np.int64]
    """(POINTS_CAP, 2) vertex rows of on_a and on_b."""
    share: NDArray[np.float64]
    """(4,) barycentric coordinates of the closest point in the simplex."""
    corner: NDArray[np.uint32]
    """(FACES_CAP, 3) points of a face, counter-clockwise from outside. Unsigned, so that numba does not test every index for a
    negative value."""
    across: NDArray[np.uint32]
    """(FACES_CAP, 3) the face beyond edge i (from corner i to corner i + 1)."""
    normal: NDArray[np.float64]
    """(FACES_CAP, 3) outward unit normal."""
    height: NDArray[np.float64]
    """(FACES_CAP,) signed distance [m] of the face's plane from the origin; inf where a slot in use holds no face."""
    alive: NDArray[np.int64]
    """(FACES_CAP,) 1 if the slot holds a face, 0 if free, 2 while the face is being removed."""
    settled: NDArray[np.int64]
    """(FACES_CAP,) 1 if no direction that the face hides can be the shortest way out, see `smooth_depth`."""
    stack: NDArray[np.uint32]
    """(FACES_CAP,) faces that a new point is above."""
    horizon: NDArray[np.uint32]
    """(FACES_CAP, 3) edge from, edge to, face that stays."""
    spoke: NDArray[np.int64]
    """(POINTS_CAP,) the new face that begins at this horizon point."""
    depth: NDArray[np.float64]
    """(PIECES_CAP,) pd_i of eq. 1 [m]."""
    direction: NDArray[np.float64]
    """(PIECES_CAP, 3) n_i of eq. 1."""


SCRATCH = np.dtype(
    (
        Scratch,
        np.dtype(
            [
                ("w", np.float64, (POINTS_CAP, 3)),
                ("on_a", np.float64, (POINTS_CAP, 3)),
                ("on_b", np.float64, (POINTS_CAP, 3)),
                ("rows", np.int64, (POINTS_CAP, 2)),
                ("share", np.float64, (4,)),
                ("corner", np.uint32, (FACES_CAP, 3)),
                ("across", np.uint32, (FACES_CAP, 3)),
                ("normal", np.float64, (FACES_CAP, 3)),
                ("height", np.float64, (FACES_CAP,)),
                ("alive", np.int64, (FACES_CAP,)),
                ("settled", np.int64, (FACES_CAP,)),
                ("stack", np.uint32, (FACES_CAP,)),
                ("horizon", np.uint32, (FACES_CAP, 3)),
                ("spoke", np.int64, (POINTS_CAP,)),
                ("depth", np.float64, (PIECES_CAP,)),
                ("direction", np.float64, (PIECES_CAP, 3)),
            ],
            align=True,
        ),
    )
)
"""The record's layout; aligned, or the compiler may not load two numbers at once."""

known_by_pointer(Scratch, SCRATCH)


def make_scratch() -> Scratch:
    """Allocate the working memory; one per thread."""
    scratch: Scratch = np.zeros(1, SCRATCH)[0]
    return scratch


@kernel
def number(stored: np.uint32) -> int:
    """Return the number of a face or point as any other integer; the compiler still knows that it is not negative."""
    return np.int64(stored)  # type: ignore[return-value]  # to Python it is one
