"""The pieces of a scene as the judge sees them: coal geometries, where they sit, and boxes round them as arrays."""

from functools import lru_cache

import coal
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull as QuickHull

from avatarsim.scene.avatar import Link
from avatarsim.scene.body import Body
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Shape, Sphere
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

CACHE_SIZE = 1024
"""Shapes whose geometry and outline are kept: equal ones, and those of a scene that is judged again, need not be made again.
Fewer than the pieces of one scene would keep nothing."""


@lru_cache(maxsize=CACHE_SIZE)
def coal_geometry(shape: Shape) -> coal.CollisionGeometry:
    """Return `shape` as coal's own kind of it; hulls vertex for vertex, and boxes as hulls of their corners.

    Of coal's own boxes, turned against each other by a millionth of a radian, every twentieth pair came out up to
    0.2 m too shallow; of the same boxes as hulls none did.
    """
    if isinstance(shape, Sphere):
        return coal.Sphere(shape.radius)
    if isinstance(shape, Capsule):
        return coal.Capsule(shape.radius, shape.length)
    if isinstance(shape, Ellipsoid):
        return coal.Ellipsoid(*shape.radii)
    return _coal_hull(rounded_points(shape)[0])


def _coal_hull(vertices: Array) -> coal.CollisionGeometry:
    """Return a coal hull of `vertices` (n, 3), faces wound counter-clockwise seen from outside; inner points are dropped."""
    used, wound = wound_faces(vertices)
    rank = np.zeros(len(vertices), dtype=np.int64)
    rank[used] = np.arange(len(used))
    points, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in vertices[used]:
        points.append(vertex)
    for i, j, k in rank[wound].tolist():
        faces.append(coal.Triangle(i, j, k))
    return coal.Convex(points, faces)


def wound_faces(vertices: Array) -> tuple[Indices, Indices]:
    """Return vertices (k,) of the hull of `vertices` (n, 3), and its triangles (f, 3), counter-clockwise seen from outside."""
    hull = QuickHull(vertices)
    a, b, c = (vertices[hull.simplices[:, k]] for k in range(3))
    outward = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) > 0.0
    return hull.vertices, np.where(outward[:, None], hull.simplices, hull.simplices[:, ::-1])


def rounded_points(shape: Shape) -> tuple[Array, float]:
    """Return `shape` as points (n, 3) [m] in its own frame swept by a ball of a radius [m], which no ellipsoid is.

    Raises TypeError for an ellipsoid.
    """
    if isinstance(shape, Sphere):
        return np.zeros((1, 3)), shape.radius
    if isinstance(shape, Capsule):
        return np.array([[0.0, 0.0, -0.5], [0.0, 0.0, 0.5]]) * shape.length, shape.radius
    if isinstance(shape, Box):
        signs = np.stack(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5]), axis=-1).reshape(-1, 3)
        return signs * np.array(shape.size), 0.0
    if isinstance(shape, ConvexHull):
        return shape.vertices, 0.0
    raise TypeError("an ellipsoid is not the hull of a few points")


def _box_round(shape: Shape) -> tuple[Array, Array, float, float]:
    """Return centre (3,) and half lengths (3,) of a box in the shape's frame, the allowance for rounding, and a radius
    about the centre that holds everything [m]."""
    if isinstance(shape, Ellipsoid):
        return np.zeros(3), np.array(shape.radii), 0.0, max(shape.radii)
    points, radius = rounded_points(shape)
    low, high = points.min(axis=0), points.max(axis=0)
    centre = 0.5 * (low + high)
    return centre, 0.5 * (high - low), radius, float(np.linalg.norm(points - centre, axis=1).max()) + radius


class Outline:
    """Measures of a shape along an axis that need no search: how far it reaches, and its faces.

    points (k, 3) [m] swept by a ball of `radius` [m] are the shape, unless it is an ellipsoid, which has none;
    faces (f, 3) are its unit face normals, offsets (f,) [m] how far it reaches along them, edges (e, 3) its unit edge
    directions; none for smooth shapes.
    """

    def __init__(self, shape: Shape) -> None:
        self._radii: Array | None = None
        self.points, self.radius = np.zeros((0, 3)), 0.0
        self.faces = self.edges = np.zeros((0, 3))
        if isinstance(shape, Ellipsoid):
            self._radii = np.array(shape.radii)
        else:
            self.points, self.radius = rounded_points(shape)
            if isinstance(shape, (Box, ConvexHull)):
                hull = QuickHull(self.points)
                # a box's sides are two triangles each: once is enough
                self.faces = np.unique(hull.equations[:, :3].round(15), axis=0)
                corners = self.points[hull.simplices]
                edges = (corners - np.roll(corners, 1, axis=1)).reshape(-1, 3)
                edges /= np.linalg.norm(edges, axis=1)[:, None]
                # both ways along an edge are one direction
                edges *= np.where(edges @ np.array([1.0, np.sqrt(2.0), np.sqrt(3.0)]) < 0.0, -1.0, 1.0)[:, None]
                self.edges = np.unique(edges.round(12), axis=0)
            elif isinstance(shape, Capsule):
                self.edges = np.array([[0.0, 0.0, 1.0]])
        self.offsets = self.reach(self.faces)

    def reach(self, axes: Array) -> Array:
        """Return the highest coordinate (...) [m] of the shape along unit `axes` (..., 3), in the shape's own frame."""
        if self._radii is not None:
            return np.asarray(np.sqrt(((axes * self._radii) ** 2).sum(axis=-1)))
        return np.asarray((axes @ self.points.T).max(axis=-1) + self.radius)


@lru_cache(maxsize=CACHE_SIZE)
def outline(shape: Shape) -> Outline:
    """Return the outline of `shape`, which nothing changes."""
    return Outline(shape)


class Pieces:
    """All convex pieces of a scene in canonical order, ready to be placed: p pieces of n bodies.

    centres (p, 3) and radii (p,) [m] are those of balls that hold the pieces, in the pieces' own frames; swings (p,) [m] how far
    the points reach from there that a turn moves, without the ball they are swept by, which is the same whichever way it turns.
    """

    def __init__(self, scene: Scene) -> None:
        owners: tuple[Body | Link, ...] = (*scene.bodies, *scene.links)
        pieces = [(k, piece) for k, owner in enumerate(owners) for piece in owner.pieces]
        self.owner = np.array([k for k, _ in pieces])
        self.shapes = tuple(piece.shape for _, piece in pieces)
        self.geometries = tuple(coal_geometry(shape) for shape in self.shapes)
        self.outlines = tuple(outline(shape) for shape in self.shapes)
        self.positions = np.array([piece.position for _, piece in pieces])
        self.turns = rotation.to_matrix(np.array([piece.orientation for _, piece in pieces]))
        boxes = [_box_round(shape) for shape in self.shapes]
        self.centres = np.array([box[0] for box in boxes])
        self._halves = np.array([box[1] for box in boxes])
        self._rounding = np.array([box[2] for box in boxes])
        self.radii = np.array([box[3] for box in boxes])
        self.swings = self.radii - self._rounding

    def placed(self, positions: Array, turns: Array) -> tuple[Array, Array]:
        """Return positions (..., p, 3) [m] and turns (..., p, 3, 3) of the pieces in the world, from those of the n bodies."""
        turn = turns[..., self.owner, :, :]
        return positions[..., self.owner, :] + np.einsum("...pij,pj->...pi", turn, self.positions), turn @ self.turns

    def boxes(self, positions: Array, turns: Array) -> tuple[Array, Array]:
        """Return lower and upper corners (..., p, 3) [m] of axis-aligned boxes round the placed pieces."""
        centres = positions + np.einsum("...pij,pj->...pi", turns, self.centres)
        halves = np.einsum("...pij,pj->...pi", np.abs(turns), self._halves) + self._rounding[:, None]
        halves = np.minimum(halves, self.radii[:, None])
        return centres - halves, centres + halves
