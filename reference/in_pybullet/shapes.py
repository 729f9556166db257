"""Our convex pieces as Bullet collision shapes, vertex for vertex."""

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.errors import InvalidScene
from avatarsim.scene.checks import Quaternion
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.spatial import rotation
from reference.narrowing import hull_of

Array = NDArray[np.float64]
IDENTITY = np.array(rotation.IDENTITY)

SAME = 1e-12
"""Places [m] and turns that differ by no more are one: rounding errors must not keep a shape from its own frame."""

MAX_PIECES = 16
"""Pieces that PyBullet takes for one compound (MAX_COMPOUND_COLLISION_SHAPES in its headers): more are dropped silently."""


def parted(pieces: tuple[Piece, ...]) -> list[tuple[Piece, ...]]:
    """Return `pieces` in groups that PyBullet takes whole; one empty group of none."""
    return [pieces[k : k + MAX_PIECES] for k in range(0, len(pieces), MAX_PIECES)] or [()]


def xyzw(quaternion: Array | Quaternion) -> list[float]:
    """Return a quaternion scalar last, as PyBullet wants it. Together with `wxyz` the only place where the order changes."""
    w, x, y, z = (float(value) for value in quaternion)
    return [x, y, z, w]


def wxyz(quaternion: Sequence[float]) -> Array:
    """Return a quaternion scalar first, as everywhere else."""
    x, y, z, w = quaternion
    return np.array([w, x, y, z])


Placed = tuple[Shape | Array, list[float], list[float]]
"""A shape, or the vertices (n, 3) [m] of a hull, with its place [m] and its turn (x, y, z, w)."""


def placed(pieces: tuple[Piece, ...], frame: Array, centre: Array, hulls: bool = False) -> list[Placed]:
    """Return all pieces in a frame that is turned by the quaternion `frame` against the body's; `centre` (3,) [m] is the mass
    centre in that frame; `hulls`: boxes as hulls of their corners.

    One piece is in the mass centre's own frame where it can be: there Bullet keeps the shape itself, anywhere else a compound of
    it, whose contacts begin when boxes around the parts overlap and end when they do not. Only the shape itself is met before it
    overlaps. Raises InvalidScene for more pieces than PyBullet takes.
    """
    if len(pieces) > MAX_PIECES:
        raise InvalidScene("pieces of a moving body or link in PyBullet", len(pieces), f"at most {MAX_PIECES}")
    back, shapes = rotation.conjugate(frame), list[Placed]()
    for piece in pieces:
        shape: Shape | Array = corners(piece.shape) if hulls and isinstance(piece.shape, Box) else piece.shape
        place, turn = rotation.rotate(back, piece.position), rotation.multiply(back, piece.orientation)
        if len(pieces) == 1:
            vertices = vertices_of(shape)
            if vertices is not None:
                shape, place, turn = rotation.rotate(turn, vertices) + (place - centre), centre, IDENTITY
            elif np.abs(place - centre).max() < SAME:
                shape, turn = _upright(shape, turn)
                place = centre if turn is IDENTITY else place
        shapes.append((shape, place.tolist(), xyzw(turn)))
    return shapes


def _upright(shape: Shape | Array, turn: Array) -> tuple[Shape | Array, Array]:
    """Return the same solid without its turn if there is one: of a box whose axes change places, another box."""
    if np.abs(turn - IDENTITY).max() < SAME:
        return shape, IDENTITY
    axes = np.abs(rotation.to_matrix(turn))
    if isinstance(shape, Box) and np.abs(axes - np.round(axes)).max() < SAME:
        return Box(tuple((np.round(axes) @ shape.size).tolist())), IDENTITY
    return shape, IDENTITY if isinstance(shape, Sphere) else turn


def collision_shape(parts: list[Placed], client: int) -> int:
    """Make one shape of all parts; return -1, Bullet's code for none, without parts."""
    if not parts:
        return -1
    shapes, places, turns = (list(column) for column in zip(*parts, strict=True))
    if len(parts) == 1:
        return int(pybullet.createCollisionShape(
            collisionFramePosition=places[0], collisionFrameOrientation=turns[0], physicsClientId=client, **_single(shapes[0])
        ))
    with TemporaryDirectory() as folder:
        rows = [_row(shape, Path(folder) / f"{k}.obj") for k, shape in enumerate(shapes)]
        columns = {name: [row[name] for row in rows] for name in rows[0]}
        return int(pybullet.createCollisionShapeArray(
            collisionFramePositions=places, collisionFrameOrientations=turns, physicsClientId=client, **columns
        ))


def corners(box: Box) -> ConvexHull:
    """Return a box as the hull of its eight corners."""
    return ConvexHull(0.5 * np.array(box.size) * np.array(list(product((-1.0, 1.0), repeat=3))))


def vertices_of(shape: Shape | Array) -> Array | None:
    """Return vertices if Bullet sees the shape as a hull, None if it has a type for it."""
    if isinstance(shape, Ellipsoid):
        return hull_of(shape).vertices
    if isinstance(shape, np.ndarray):
        return shape
    return shape.vertices if isinstance(shape, ConvexHull) else None


def _single(shape: Shape | Array) -> dict[str, object]:
    if isinstance(shape, Sphere):
        return {"shapeType": pybullet.GEOM_SPHERE, "radius": shape.radius}
    if isinstance(shape, Box):
        return {"shapeType": pybullet.GEOM_BOX, "halfExtents": [0.5 * edge for edge in shape.size]}
    if isinstance(shape, Capsule):
        return {"shapeType": pybullet.GEOM_CAPSULE, "radius": shape.radius, "height": shape.length}
    vertices = vertices_of(shape)
    assert vertices is not None
    return {"shapeType": pybullet.GEOM_MESH, "vertices": vertices.tolist()}


def _row(shape: Shape | Array, file: Path) -> dict[str, object]:
    """Return one row of createCollisionShapeArray, which takes hulls from files only."""
    one: dict[str, object] = {
        "shapeTypes": 0, "radii": 1.0, "halfExtents": [1.0, 1.0, 1.0], "lengths": 1.0, "fileNames": "", "meshScales": [1.0] * 3,
    }
    if isinstance(shape, Sphere):
        return {**one, "shapeTypes": pybullet.GEOM_SPHERE, "radii": shape.radius}
    if isinstance(shape, Box):
        return {**one, "shapeTypes": pybullet.GEOM_BOX, "halfExtents": [0.5 * edge for edge in shape.size]}
    if isinstance(shape, Capsule):
        return {**one, "shapeTypes": pybullet.GEOM_CAPSULE, "radii": shape.radius, "lengths": shape.length}
    vertices = vertices_of(shape)
    assert vertices is not None
    # any faces will do, as long as they name every vertex: Bullet keeps the vertices and makes the hull
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f 1 {k} {k + 1}" for k in range(2, len(vertices))]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return {**one, "shapeTypes": pybullet.GEOM_MESH, "fileNames": str(file)}
