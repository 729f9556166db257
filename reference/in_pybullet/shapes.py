"""Our convex pieces as Bullet collision shapes, vertex for vertex."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.scene.checks import Quaternion
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere, ellipsoid_hull
from avatarsim.spatial import rotation
from reference.in_pybullet.stand_ins import ELLIPSOID_VERTICES

Array = NDArray[np.float64]


def xyzw(quaternion: Array | Quaternion) -> list[float]:
    """Scalar last, as PyBullet wants it. Together with `wxyz` the only place where the order changes."""
    w, x, y, z = (float(value) for value in quaternion)
    return [x, y, z, w]


def wxyz(quaternion: Sequence[float]) -> Array:
    """Scalar first, as everywhere else."""
    x, y, z, w = quaternion
    return np.array([w, x, y, z])


def collision_shape(pieces: tuple[Piece, ...], frame: Array, client: int) -> int:
    """Shape of all pieces, in a frame that is turned by the quaternion `frame` against the body's; -1, Bullet's word for none,
    without pieces."""
    if not pieces:
        return -1
    back = rotation.conjugate(frame)
    places = [rotation.rotate(back, piece.position).tolist() for piece in pieces]
    turns = [xyzw(rotation.multiply(back, piece.orientation)) for piece in pieces]
    if len(pieces) == 1:
        arguments = _single(pieces[0].shape)
        made = pybullet.createCollisionShape(
            collisionFramePosition=places[0], collisionFrameOrientation=turns[0], physicsClientId=client, **arguments
        )
        return int(made)
    with TemporaryDirectory() as folder:
        rows = [_row(piece.shape, Path(folder) / f"{k}.obj") for k, piece in enumerate(pieces)]
        columns = {name: [row[name] for row in rows] for name in rows[0]}
        made = pybullet.createCollisionShapeArray(
            collisionFramePositions=places, collisionFrameOrientations=turns, physicsClientId=client, **columns
        )
    return int(made)


def hull_of(shape: Shape) -> Array | None:
    """Vertices if Bullet sees the shape as a hull, None if it has a word for it."""
    if isinstance(shape, Ellipsoid):
        return ellipsoid_hull(shape.radii, ELLIPSOID_VERTICES).vertices
    return shape.vertices if isinstance(shape, ConvexHull) else None


def _single(shape: Shape) -> dict[str, object]:
    if isinstance(shape, Sphere):
        return {"shapeType": pybullet.GEOM_SPHERE, "radius": shape.radius}
    if isinstance(shape, Box):
        return {"shapeType": pybullet.GEOM_BOX, "halfExtents": [0.5 * edge for edge in shape.size]}
    if isinstance(shape, Capsule):
        return {"shapeType": pybullet.GEOM_CAPSULE, "radius": shape.radius, "height": shape.length}
    vertices = hull_of(shape)
    assert vertices is not None
    return {"shapeType": pybullet.GEOM_MESH, "vertices": vertices.tolist()}


def _row(shape: Shape, file: Path) -> dict[str, object]:
    """One row of createCollisionShapeArray, which takes hulls from files only."""
    one: dict[str, object] = {
        "shapeTypes": 0, "radii": 1.0, "halfExtents": [1.0, 1.0, 1.0], "lengths": 1.0, "fileNames": "", "meshScales": [1.0] * 3,
    }
    if isinstance(shape, Sphere):
        return {**one, "shapeTypes": pybullet.GEOM_SPHERE, "radii": shape.radius}
    if isinstance(shape, Box):
        return {**one, "shapeTypes": pybullet.GEOM_BOX, "halfExtents": [0.5 * edge for edge in shape.size]}
    if isinstance(shape, Capsule):
        return {**one, "shapeTypes": pybullet.GEOM_CAPSULE, "radii": shape.radius, "lengths": shape.length}
    vertices = hull_of(shape)
    assert vertices is not None
    # any faces will do, as long as they name every vertex: Bullet keeps the vertices and makes the hull
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f 1 {k} {k + 1}" for k in range(2, len(vertices))]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return {**one, "shapeTypes": pybullet.GEOM_MESH, "fileNames": str(file)}
