"""Orthographic projection of convex pieces: outlines and faces in a plane, and the order in which they cover each other.

Balls, capsules and ellipsoids project exactly, to ellipses and to the hull of two discs; polyhedra face by face.
"""

import heapq
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from avatarsim.spatial import rotation
from reports.drawing.mesh import CUBE

Array = NDArray[np.float64]
Face = tuple[int, ...]

MOST_FACES = 12
"""Polyhedra with more faces are drawn as one outline: their faces are too small to be told apart in a picture of 150 px."""
ROUND = 24
"""Corners of the outline of a round piece."""
TOUCHING = 0.01
"""Depth, as a share of the picture's height, up to which two pieces that touch still count as separated by a face."""


class Piece(Protocol):
    """A convex piece in the world."""

    @property
    def centre(self) -> Array: ...

    def least(self, direction: Array) -> float:
        """The least coordinate [m] along `direction` (3,)."""

    def outline(self, axes: Array) -> Array:
        """Corners (k, 2) of its outline along `axes` (2, 3), in order."""

    def faces(self) -> Sequence[tuple[Array, Array]]:
        """(corners (k, 3), outward normal (3,)) of each flat face."""

    def radius(self) -> float:
        """Its radius [m] where it is a ball, else 0."""


@dataclass(frozen=True, eq=False)
class Rounded:
    """Discs swept: an ellipsoid of `spread` = R diag(r^2) R^T (3, 3), moved along the segment of `ends` (1 or 2, 3)."""

    ends: Array
    spread: Array

    @property
    def centre(self) -> Array:
        return np.asarray(self.ends.mean(axis=0))

    def least(self, direction: Array) -> float:
        return float((self.ends @ direction).min() - np.sqrt(direction @ self.spread @ direction))

    def outline(self, axes: Array) -> Array:
        flat = axes @ self.spread @ axes.T
        turns = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
        disc = np.stack([np.cos(turns), np.sin(turns)], axis=1) @ np.linalg.cholesky(flat + 1e-18 * np.eye(2)).T
        points = (self.ends @ axes.T)[:, None] + disc
        return points[0] if len(self.ends) == 1 else flat_hull(points.reshape(-1, 2))

    def faces(self) -> Sequence[tuple[Array, Array]]:
        return ()

    def radius(self) -> float:
        square = float(self.spread[0, 0])
        ball = len(self.ends) == 1 and np.allclose(self.spread, square * np.eye(3), rtol=1e-6, atol=1e-9 * square)
        return square**0.5 if ball else 0.0


@dataclass(frozen=True, eq=False)
class Polyhedron:
    """A convex polyhedron: corners (v, 3) and faces, each the indices of its corners in order, with its outward normal (3,)."""

    corners: Array
    sides: Sequence[tuple[Face, Array]]

    @property
    def centre(self) -> Array:
        return np.asarray(self.corners.mean(axis=0))

    def least(self, direction: Array) -> float:
        return float((self.corners @ direction).min())

    def outline(self, axes: Array) -> Array:
        return flat_hull(self.corners @ axes.T)

    def faces(self) -> Sequence[tuple[Array, Array]]:
        return [(self.corners[list(face)], normal) for face, normal in self.sides]

    def radius(self) -> float:
        return 0.0


def flat_hull(points: Array) -> Array:
    """Corners (k, 2) of the convex hull of points (n, 2), counter-clockwise; the points themselves where they span no area."""
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points


@lru_cache(maxsize=512)
def _sides(shape: bytes) -> tuple[tuple[Face, tuple[float, float, float]], ...]:
    """Flat faces of the hull of corners (v, 3), given as bytes: triangles of one plane are one face."""
    corners = np.frombuffer(shape).reshape(-1, 3)
    found = ConvexHull(corners)
    planes: dict[tuple[float, ...], set[int]] = {}
    for simplex, equation in zip(found.simplices, found.equations, strict=True):
        planes.setdefault(tuple(np.round(equation, 5) + 0.0), set()).update(int(k) for k in simplex)
    made = []
    for plane, members in planes.items():
        normal = np.array(plane[:3])
        across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
        own = sorted(members)
        middle = corners[own].mean(axis=0)
        along = (corners[own] - middle) @ np.stack([across, np.cross(normal, across)], axis=1)
        turn = np.argsort(np.arctan2(along[:, 1], along[:, 0]))
        made.append((tuple(own[k] for k in turn), (float(normal[0]), float(normal[1]), float(normal[2]))))
    return tuple(made)


def placed(piece: Mapping[str, Any], position: Array, orientation: Array) -> Piece:
    """A piece of a scene's file, in the world, on a body at `position` (3,) with `orientation` (4,)."""
    turn = rotation.multiply(orientation, np.array(piece["orientation"], dtype=np.float64))
    place = position + rotation.rotate(orientation, np.array(piece["position"], dtype=np.float64))
    kind = str(piece["kind"])
    if kind in ("sphere", "capsule", "ellipsoid"):
        radii = np.array(piece["radii"] if kind == "ellipsoid" else [piece["radius"]] * 3, dtype=np.float64)
        matrix = rotation.to_matrix(turn)
        half = 0.5 * float(piece["length"]) * matrix[:, 2] if kind == "capsule" else np.zeros(3)
        ends = np.stack([place - half, place + half]) if kind == "capsule" else place[None]
        return Rounded(ends, matrix @ np.diag(radii**2) @ matrix.T)
    corners = CUBE * np.array(piece["size"]) if kind == "box" else np.array(piece["vertices"], dtype=np.float64)
    sides = [(face, rotation.rotate(turn, np.array(normal))) for face, normal in _sides(np.ascontiguousarray(corners).tobytes())]
    return Polyhedron(place + rotation.rotate(turn, corners), sides)


def order(pieces: Sequence[Piece], outlines: Sequence[Array], towards: Array, size: float) -> list[int]:
    """Painter's order, what is covered first. A face of one piece that has the other on its outer side says which of the two
    is nearer to an eye in the direction `towards` (3,); of pieces that no face tells apart the nearer centre covers. `size`:
    height [m] of the picture."""
    low, high = (np.array([getattr(outline, end)(axis=0) for outline in outlines]) for end in ("min", "max"))
    centres = np.array([piece.centre for piece in pieces])
    height = centres @ towards
    sides = [[(normal, float(normal @ corners[0])) for corners, normal in piece.faces()] for piece in pieces]
    before: list[set[int]] = [set() for _ in pieces]
    waits = [0] * len(pieces)
    for first in range(len(pieces)):
        meets = ((low[first] < high[first + 1 :]) & (low[first + 1 :] < high[first])).all(axis=1)
        for second in (first + 1 + int(k) for k in np.flatnonzero(meets)):
            nearer = _nearer(pieces, sides, first, second, towards, TOUCHING * size)
            if nearer is not None:
                farther = first + second - nearer
                before[farther].add(nearer)
                waits[nearer] += 1
    ready = [(float(height[k]), k) for k in range(len(pieces)) if waits[k] == 0]
    heapq.heapify(ready)
    left, drawn = set(range(len(pieces))), []
    while left:
        # pieces that cover each other in a ring have no order: the farthest is drawn first
        k = heapq.heappop(ready)[1] if ready else min(left, key=lambda k: height[k])
        if k not in left:
            continue
        left.remove(k)
        drawn.append(k)
        for nearer in before[k]:
            waits[nearer] -= 1
            if waits[nearer] == 0:
                heapq.heappush(ready, (float(height[nearer]), nearer))
    return drawn


def _nearer(
    pieces: Sequence[Piece], sides: Sequence[Sequence[tuple[Array, float]]], first: int, second: int, towards: Array, slack: float
) -> int | None:
    """Which of two pieces covers the other; None where no face separates them, or faces separate them in both ways."""
    found = set()
    for own, other in ((first, second), (second, first)):
        for normal, offset in sides[own]:
            slope = float(normal @ towards)
            if abs(slope) > 1e-6 and pieces[other].least(normal) >= offset - slack:
                found.add(other if slope > 0.0 else own)
    return found.pop() if len(found) == 1 else None
