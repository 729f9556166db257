"""Convex pieces of a compiled model's geoms: primitives as they are, cylinders as prisms, meshes by hull or decomposition.

A prism encloses its cylinder, and a hull of fewer vertices the hull of its mesh, so that a posture that is free of them is free
of the file's own shapes. The distance that either adds is measured and reported.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.meshes import pieces_of_mesh
from avatarsim.assets.meshes.decompose import PieceOptions
from avatarsim.assets.meshes.enclosing import enclosing
from avatarsim.assets.meshes.hulls import hull_of
from avatarsim.assets.models.compiled import VISIBLE_GROUPS, Compiled, GeomKind
from avatarsim.errors import InvalidFile, InvalidShape, UnknownName
from avatarsim.scene.checks import SHORTEST, Quaternion, Vector
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

SIDES = 32
"""Sides of the prism around a cylinder, whose edges lie 0.5 % of the radius outside. More: support queries take longer."""

PRIMITIVES = {
    GeomKind.SPHERE: 1, GeomKind.CAPSULE: 1, GeomKind.CYLINDER: 2, GeomKind.ELLIPSOID: 3, GeomKind.BOX: 3,
}
"""Kinds of drawn geoms other than meshes, and how many of their sizes must be lengths."""

PLANE = (200.0, 200.0, 10.0)
"""Full size [m] of the box for an infinite plane, below it: farther than an avatar walks in minutes, deeper than one falls in a
frame. Its centre is the mean position of the moving bodies, projected onto the plane."""

Visual = Piece | tuple[Array, Indices]
"""A drawn part of a body: a primitive, or vertices (n, 3) [m] and triangles (t, 3) of a mesh."""

Frames = Mapping[int, tuple[Array, Array]]
"""Position (3,) [m] and orientation (4,) of bodies by their numbers, in the frame of one body or link."""

WAYS = ("hull", "decompose")
"""Conversions of a mesh: one convex piece, or several by approximate convex decomposition."""


@dataclass(frozen=True)
class MeshOptions:
    """Options of meshes: `meshes` of WAYS, or the names of those to decompose, and the most vertices of each unless
    that adds more than `fit` [m]; `repair` of open surfaces, as in `pieces_of_mesh`."""

    meshes: str | tuple[str, ...] = "hull"
    most_vertices: int = 128
    repair: str = "auto"
    fit: float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.meshes, tuple) and self.meshes not in WAYS:
            raise UnknownName("meshes", str(self.meshes), WAYS)
        # checked also where no mesh needs them
        PieceOptions(most_vertices=self.most_vertices, repair=self.repair, fit=self.fit)

    def decomposes(self, mesh: str) -> bool:
        """Return True if a mesh of this name is decomposed."""
        return mesh in self.meshes if isinstance(self.meshes, tuple) else self.meshes == "decompose"


@dataclass(eq=False)
class Geoms:
    """The geoms of a model that bodies collide with, less those in `leave`. `roots` (n, 3): positions of moving roots [m]."""

    model: Compiled
    wanted: MeshOptions = MeshOptions()
    leave: tuple[str, ...] = ()
    roots: Array = field(default_factory=lambda: np.zeros((1, 3)))
    _hull: tuple[float, str] = (0.0, "")
    _decomposed: tuple[float, str] = (0.0, "")
    _meshes: dict[int, tuple[ConvexHull, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        known = [self.label(k) for k in range(len(self.model.geom_name))]
        for name in self.leave:
            if name not in known:
                raise UnknownName("geom in leave", name, known)
        for name in self.wanted.meshes if isinstance(self.wanted.meshes, tuple) else ():
            if name not in self.model.mesh_name:
                raise UnknownName("mesh to decompose", name, self.model.mesh_name)

    @cached_property
    def plane(self) -> tuple[float, float, float]:
        """Return the full size [m] of the box for an infinite plane: PLANE, wider if the moving bodies are far apart."""
        far = float(np.linalg.norm(self.roots - self.roots.mean(axis=0), axis=1).max())
        wide = PLANE[0] + (2.0 * far if far > 0.25 * PLANE[0] else 0.0)
        return wide, wide, PLANE[2]

    @cached_property
    def touching(self) -> NDArray[np.bool_]:
        """Return (g,) whether a geom collides with anything; the others are visual only."""
        found = (self.model.geom_contype != 0) | (self.model.geom_conaffinity != 0)
        found[self.model.pair_geom1] = found[self.model.pair_geom2] = True
        left = [self.label(k) in self.leave for k in range(len(found))]
        return np.asarray(found & ~np.array(left, dtype=np.bool_))

    def of(self, body: int) -> list[int]:
        """Return the numbers of a body's geoms that collide."""
        return [int(k) for k in np.flatnonzero(self.touching & (self.model.geom_bodyid == body))]

    def label(self, geom: int) -> str:
        """Return the name of a geom in errors and sentences."""
        body = self.model.body_name[self.model.geom_bodyid[geom]] or f"body {self.model.geom_bodyid[geom]}"
        return self.model.geom_name[geom] or f"geom {geom} of {body}"

    def pieces(self, geom: int, offset: Array, turn: Array) -> tuple[Piece, ...]:
        """Return pieces of a geom whose body's frame is at `offset` (3,) [m], turned by `turn` (4,). Raises InvalidFile."""
        at, about = self._placed(geom, offset, turn)
        kind = int(self.model.geom_type[geom])
        try:
            if kind == GeomKind.PLANE:
                x, y = self._off_centre(geom)
                middle = at + rotation.rotate(about, (x, y, -0.5 * PLANE[2]))
                return (Piece(Box(self.plane), vector_of(middle), quaternion_of(about)),)
            return tuple(Piece(shape, vector_of(at), quaternion_of(about)) for shape in self._shapes(geom, kind))
        except InvalidShape as error:
            raise InvalidFile(f"shape of {self.label(geom)}: {error.thing}", error.value, error.valid) from error

    def visuals(self, frames: Frames, geoms: Sequence[int] | None = None) -> tuple[Visual, ...]:
        """Return the drawn parts of bodies.

        They are the visible geoms of each body, or of `geoms`, else the colliding ones; none where just pieces are drawn."""
        of_bodies = [g for body in frames for g in self.of(body)]
        drawn = [g for body in frames for g in self._visible(body) or self.of(body)] if geoms is None else list(geoms)
        if drawn == of_bodies and not any(self.model.geom_type[g] == GeomKind.MESH for g in drawn):
            return ()
        return self.parts(frames, drawn)

    def parts(self, frames: Frames, geoms: Sequence[int]) -> tuple[Visual, ...]:
        """Return primitives and meshes of these geoms of these bodies. Raises InvalidFile."""
        found: list[Visual] = []
        for geom in geoms:
            frame = frames[int(self.model.geom_bodyid[geom])]
            if self.model.geom_type[geom] == GeomKind.MESH:
                vertices, triangles = self.model.mesh(int(self.model.geom_dataid[geom]))
                at, about = self._placed(geom, *frame)
                found.append((at + rotation.rotate(about, vertices), triangles))
            else:
                found += self.pieces(geom, *frame)
        return tuple(found)

    def _visible(self, body: int) -> list[int]:
        """Return the numbers of a body's geoms that a viewer shows and that are sound."""
        found = []
        for geom in np.flatnonzero((self.model.geom_bodyid == body) & (self.model.geom_group < VISIBLE_GROUPS)):
            kind = self.model.geom_type[geom]
            if kind == GeomKind.MESH and self.model.mesh_facenum[self.model.geom_dataid[geom]]:
                found.append(int(geom))
            elif kind in PRIMITIVES and (self.model.geom_size[geom][: PRIMITIVES[kind]] > SHORTEST).all():
                found.append(int(geom))
        return found

    def _off_centre(self, geom: int) -> Array:
        """Return the mean position (2,) [m] of the moving bodies in the frame of a plane geom, whose body is fixed."""
        at, about = self._placed(geom, *self.model.pose(int(self.model.geom_bodyid[geom])))
        return rotation.rotate(rotation.conjugate(about), self.roots.mean(axis=0) - at)[:2]

    def _placed(self, geom: int, offset: Array, turn: Array) -> tuple[Array, Array]:
        """Return position and orientation of a geom in a frame in which its body's is at `offset`, turned by `turn`."""
        at = offset + rotation.rotate(turn, self.model.geom_pos[geom])
        return at, rotation.multiply(turn, self.model.geom_quat[geom])

    def _shapes(self, geom: int, kind: int) -> tuple[Shape, ...]:
        a, b, c = (float(size) for size in self.model.geom_size[geom])
        if kind == GeomKind.SPHERE or (kind == GeomKind.CAPSULE and 2.0 * b < SHORTEST):
            return (Sphere(a),)
        if kind == GeomKind.CAPSULE:
            return (Capsule(a, 2.0 * b),)
        if kind == GeomKind.BOX:
            return (Box((2.0 * a, 2.0 * b, 2.0 * c)),)
        if kind == GeomKind.ELLIPSOID:
            return (Ellipsoid((a, b, c)),)
        if kind == GeomKind.CYLINDER:
            return (_prism(a, b),)
        if kind == GeomKind.MESH:
            return self._pieces_of_mesh(geom, int(self.model.geom_dataid[geom]))
        name = GeomKind(kind).name.lower() if kind in GeomKind.__members__.values() else str(kind)
        valid = f'sphere, capsule, box, cylinder, ellipsoid, mesh or plane; leave=("{self.label(geom)}",) leaves it out'
        raise InvalidFile(f"type of {self.label(geom)}", name, valid)

    def _pieces_of_mesh(self, geom: int, mesh: int) -> tuple[ConvexHull, ...]:
        if mesh not in self._meshes:
            vertices, triangles = self.model.mesh(mesh)
            way = self._decompose if self.wanted.decomposes(self.model.mesh_name[mesh]) else self._hull_of
            self._meshes[mesh] = way(self.label(geom), vertices, triangles)
        return self._meshes[mesh]

    def _hull_of(self, label: str, vertices: Array, triangles: Indices) -> tuple[ConvexHull, ...]:
        whole = hull_of(vertices, f"mesh of {label}")
        around, added = enclosing(whole, self.wanted.most_vertices, f"mesh of {label}", self.wanted.fit)
        self._hull = max(self._hull, (added, label))
        return (ConvexHull(around.points[around.used]),)

    def _decompose(self, label: str, vertices: Array, triangles: Indices) -> tuple[ConvexHull, ...]:
        wanted = self.wanted
        try:
            found = pieces_of_mesh(
                (vertices, triangles), most_vertices=wanted.most_vertices, repair=wanted.repair, fit=wanted.fit
            )
        except InvalidShape as error:
            valid = 'a surface that can be decomposed; repair="remesh" wraps it in a closed one, meshes="hull" takes hulls'
            raise InvalidFile(f"mesh of {label}: {error.thing}", error.value, valid) from error
        self._decomposed = max(self._decomposed, (found.hausdorff, label))
        return tuple(piece.shape for piece in found.pieces if isinstance(piece.shape, ConvexHull))

    def notes(self) -> tuple[str, ...]:
        """Return sentences on differences between the pieces made so far and the file's geoms."""
        found = []
        if len(cylinders := np.flatnonzero(self.touching & (self.model.geom_type == GeomKind.CYLINDER))):
            more, name = max((_wider(float(self.model.geom_size[k][0])), self.label(int(k))) for k in cylinders)
            what = f"{len(cylinders)} cylinders are prisms of {SIDES} sides around them"
            found.append(f"{what}, at most {1e3 * more:.3g} mm wider ({name})")
        apart = {mesh for mesh in self._meshes if self.wanted.decomposes(self.model.mesh_name[mesh])}
        if hulls := len(self._meshes) - len(apart):
            added, name = self._hull
            around = f", at most {1e3 * added:.3g} mm wider ({name})" if added else ""
            found.append(f"{hulls} meshes are their convex hulls{around}")
        if apart:
            off, name = self._decomposed
            what = f"{len(apart)} meshes are decomposed into {sum(len(self._meshes[mesh]) for mesh in apart)} convex pieces"
            found.append(f"{what}, at most {1e3 * off:.3g} mm off ({name})")
        return tuple(found)


def _wider(radius: float) -> float:
    """Return by how much the prism around a cylinder of a radius is wider [m]."""
    return float(radius / np.cos(np.pi / SIDES) - radius)


def _prism(radius: float, half: float) -> ConvexHull:
    """Return the prism around a cylinder of a radius and half a length [m]."""
    turns = 2.0 * np.pi * np.arange(SIDES) / SIDES
    ring = (radius + _wider(radius)) * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
    return ConvexHull(np.concatenate([np.column_stack([ring, np.full(SIDES, z)]) for z in (-half, half)]))


def vector_of(array: Array) -> Vector:
    """Return a 3-vector as the tuple that the types of a scene contain."""
    x, y, z = (float(value) for value in array)
    return x, y, z


def quaternion_of(array: Array) -> Quaternion:
    """Return a unit quaternion (4,) as the tuple that the types of a scene contain."""
    w, x, y, z = (float(value) for value in rotation.normalised(array))
    return w, x, y, z
