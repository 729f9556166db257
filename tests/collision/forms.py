"""Convex shapes with their faces and edges, and where on their surface another shape can be laid: the material of strata.py."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from avatarsim.model.geometry import ELLIPSOID, POINTS

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

KINDS = ("sphere", "capsule", "box", "ellipsoid", "hull")
OUTLINES = ("plump", "plate", "needle")
THIN = 1e-3
"""Thickness of a plate, and both thicknesses of a needle, relative to the length: the slivers of 1:1000."""
NONE = -1
"""Corner that an edge without a neighbouring face (the axis of a capsule) does not have."""


@dataclass(frozen=True)
class Form:
    """A shape about the origin, size about 1 m.

    rows (n, 3) as `Shapes` wants them; faces (f, 3) counter-clockwise from outside; edges (e, 4): two ends, then the
    third corners of the two faces that meet there.
    """

    kind: str
    rows: Array
    radius: float
    faces: Ints
    edges: Ints

    @property
    def code(self) -> int:
        """What `Shapes.kind` says."""
        return ELLIPSOID if self.kind == "ellipsoid" else POINTS

    @property
    def size(self) -> float:
        """Largest extent [m]."""
        if self.kind == "ellipsoid":
            return float(2.0 * np.linalg.norm(self.rows[1:], axis=1).max())
        return float(np.linalg.norm(np.ptp(self.rows, axis=0)) + 2.0 * self.radius)


def draw_form(kind: str, outline: str, rng: np.random.Generator, corners: tuple[int, int] = (4, 64)) -> Form:
    """A random form; a hull has a log-uniform number of corners within `corners`."""
    stretch = rng.uniform(0.3, 1.0, 3)
    stretch[rng.permutation(3)[: OUTLINES.index(outline)]] *= THIN
    if kind == "sphere":
        return _rounded(kind, np.zeros((1, 3)), 0.5 * float(stretch.max()))
    if kind == "capsule":
        radius = 0.5 * float(stretch[1]) if outline == "plump" else 0.5 * THIN
        return _rounded(kind, np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]) * stretch.max(), radius)
    if kind == "ellipsoid":
        rows = np.vstack([np.zeros(3), np.diag(0.5 * stretch)])
        return Form(kind, rows, 0.0, np.zeros((0, 3), np.int64), np.zeros((0, 4), np.int64))
    if kind == "box":
        points = np.array(list(product((-0.5, 0.5), repeat=3)))
    else:
        count = int(round(np.exp(rng.uniform(*np.log(corners)))))
        points = rng.normal(size=(count, 3))
        points *= 0.5 / np.linalg.norm(points, axis=1, keepdims=True)
    # Faces are found before the stretch, which keeps them: afterwards rounding would decide some of them.
    faces, edges = _faces_and_edges(points)
    return Form(kind, points * stretch, 0.0, faces, edges)


def _rounded(kind: str, rows: Array, radius: float) -> Form:
    edges = np.array([[0, len(rows) - 1, NONE, NONE]], np.int64)
    return Form(kind, rows, radius, np.zeros((0, 3), np.int64), edges)


def _faces_and_edges(points: Array) -> tuple[Ints, Ints]:
    """Triangles, counter-clockwise from outside, and edges of the hull of points that are all its corners."""
    hull = ConvexHull(points)
    if len(hull.vertices) != len(points):
        raise ValueError(f"{len(points) - len(hull.vertices)} points are no corners")
    faces = hull.simplices.astype(np.int64)
    a, b, c = (points[faces[:, k]] for k in range(3))
    inward = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    thirds: dict[tuple[int, int], list[int]] = {}
    for face in faces.tolist():
        for k in range(3):
            end, other, third = face[k], face[(k + 1) % 3], face[(k + 2) % 3]
            thirds.setdefault((min(end, other), max(end, other)), []).append(third)
    return faces, np.array([[*ends, *third] for ends, third in thirds.items()], np.int64)


@dataclass(frozen=True)
class Spot:
    """A point of a form's surface, the unit outward normal of a plane that touches the form there, a unit tangent."""

    point: Array
    normal: Array
    tangent: Array


def draw_spot(form: Form, feature: str, rng: np.random.Generator) -> Spot:
    """A random spot on a 'face', 'edge' or 'corner'; on the nearest thing that the form has."""
    normal, tangent = _unit(rng.normal(size=3)), rng.normal(size=3)
    rows = form.rows
    if form.kind == "ellipsoid":
        axes = rows[1:] @ normal
        return _spot(axes @ rows[1:] / np.linalg.norm(axes), normal, tangent)
    if form.kind == "capsule" and feature != "corner":
        tangent = rows[1] - rows[0]
        normal = _unit(cross(tangent, normal))
        return _spot(rows[0] + rng.uniform() * tangent + form.radius * normal, normal, tangent)
    if feature == "face" and len(form.faces):
        a, b, c = rows[form.faces[rng.integers(len(form.faces))]]
        return _spot(rng.dirichlet(np.ones(3)) @ np.array([a, b, c]), cross(b - a, c - a), b - a)
    if feature == "edge" and len(form.faces):
        i, j, k, m = form.edges[rng.integers(len(form.edges))]
        a, b = rows[i], rows[j]
        one, two = (_unit(cross(b - a, rows[third] - a)) for third in (k, m))
        # Of the two normals of each face one points out; between both outward ones the plane touches the edge only.
        one = one if ((rows - a) @ one).max() < -((rows - a) @ one).min() else -one
        two = two if ((rows - a) @ two).max() < -((rows - a) @ two).min() else -two
        share = rng.uniform(0.1, 0.9)
        return _spot(a + rng.uniform() * (b - a), share * one + (1.0 - share) * two, b - a)
    return _spot(rows[np.argmax(rows @ normal)] + form.radius * normal, normal, tangent)


def _spot(point: Array, normal: Array, tangent: Array) -> Spot:
    normal = _unit(normal)
    return Spot(point, normal, _unit(tangent - (tangent @ normal) * normal))


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))


def cross(a: Array, b: Array) -> Array:
    """Vector product."""
    # Ten times as fast as numpy's for two vectors; a million pairs need several each.
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
