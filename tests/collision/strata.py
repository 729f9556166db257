"""Stratified pairs of convex shapes: every kind with each kind, in every awkward place and size, a batch at a time."""

from dataclasses import dataclass
from itertools import combinations_with_replacement, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from avatarsim.model.geometry import ELLIPSOID, POINTS, Shapes, make_shapes

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

KINDS = ("sphere", "capsule", "box", "ellipsoid", "hull")
OUTLINES = ("plump", "plate", "needle")
THIN = 1e-3
"""Thickness of a plate, and both thicknesses of a needle, relative to the length: the slivers of 1:1000."""


@dataclass(frozen=True)
class Form:
    """A shape about the origin, size about 1 m.

    rows (n, 3) as `Shapes` takes them; faces (f, 3) counter-clockwise from outside; edges (e, 4): two ends, then the
    third corners of the two faces that meet there.
    """

    kind: str
    rows: Array
    radius: float
    faces: Ints
    edges: Ints

    @property
    def code(self) -> int:
        """Return the code of `Shapes.kind`."""
        return ELLIPSOID if self.kind == "ellipsoid" else POINTS

    @property
    def size(self) -> float:
        """Largest extent [m]."""
        if self.kind == "ellipsoid":
            return float(2.0 * np.linalg.norm(self.rows[1:], axis=1).max())
        return float(np.linalg.norm(np.ptp(self.rows, axis=0)) + 2.0 * self.radius)


def draw_form(kind: str, outline: str, rng: np.random.Generator, corners: tuple[int, int] = (4, 64)) -> Form:
    """Return a random form; a hull has a log-uniform number of corners within `corners`."""
    stretch = rng.uniform(0.3, 1.0, 3)
    stretch[rng.permutation(3)[: OUTLINES.index(outline)]] *= THIN
    if kind == "sphere":
        return _faceless(kind, np.zeros((1, 3)), 0.5 * float(stretch.max()))
    if kind == "capsule":
        radius = 0.5 * float(stretch[1]) if outline == "plump" else 0.5 * THIN
        return _faceless(kind, np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]) * stretch.max(), radius)
    if kind == "ellipsoid":
        rows = np.vstack([np.zeros(3), np.diag(0.5 * stretch)])
        return _faceless(kind, rows, 0.0)
    if kind == "box":
        points = np.array(list(product((-0.5, 0.5), repeat=3)))
    else:
        count = int(round(np.exp(rng.uniform(*np.log(corners)))))
        points = rng.normal(size=(count, 3))
        points *= 0.5 / np.linalg.norm(points, axis=1, keepdims=True)
    # Faces are found before the stretch, which keeps them: afterwards rounding would decide some of them.
    faces, edges = _faces_and_edges(points)
    return Form(kind, points * stretch, 0.0, faces, edges)


def _faceless(kind: str, rows: Array, radius: float) -> Form:
    return Form(kind, rows, radius, np.zeros((0, 3), np.int64), np.zeros((0, 4), np.int64))


def _faces_and_edges(points: Array) -> tuple[Ints, Ints]:
    """Return triangles, counter-clockwise from outside, and edges of the hull of points that are all its corners."""
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
    """Return a random spot on a 'face', 'edge' or 'corner'; on the nearest thing that the form has."""
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
    """Return the vector product."""
    # Ten times as fast as numpy's for two vectors; a million pairs need several each.
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


PLACES = ("apart", "shallow", "deep", "concentric", "flush", "parallel", "grazing")
STRATA = (*PLACES, "plates", "needles", "scales", "unequal", "far", "smooth-deep", "large")
"""The places hold plump shapes of about 1 m; the next five hold all places in turn. Ellipsoids deep in something are a stratum
of their own, of all outlines and sizes, and not in the others: there no facet is final, and it takes a method of its own.
Large: hulls of 65 to 300 corners, with each other and with all kinds."""
PAIRS_OF_KINDS = tuple(combinations_with_replacement(KINDS, 2))
BATCH = 60
"""Pairs drawn at a time, from 20 shapes."""

NEARLY_PARALLEL = 1e-8
"""[rad] by which flush and parallel pairs are off in one case of three; in the others 0 and 1e-12 to 1e-4."""
FAR = 1e5
"""[m] from the origin: there a coordinate is rounded to 1.5e-11 m."""


class Batch(NamedTuple):
    """Pair k is the shapes 2 k and 2 k + 1."""

    vertices: Array
    """(nv, 3) vertices passed to the kernels [m]."""
    centred: Array
    """(nv, 3) the same, both shapes of a pair moved, without rounding, to where the origin is near [m]."""
    centre: Array
    """(np, 3) by how much [m]."""
    shapes: Shapes
    face: Ints
    """(nf, 3) corners, counted from the first row of their shape."""
    face_start: Ints
    seed: Array
    """(np, 3) the direction that the query starts with."""
    label: list[str]
    """(np,) stratum/seed/number of the batch/k, place and kinds."""


def draw(stratum: str, seed: int, number: int) -> Batch:
    """Return batch `number` of a stratum: BATCH pairs, the pairs of kinds in turn. The same arguments give the same bits."""
    rng = np.random.default_rng([STRATA.index(stratum), seed, number])
    modes = {"plates": "plate", "needles": "needle", "smooth-deep": OUTLINES[number % 3]}
    corners = (65, 300) if stratum == "large" else (4, 64)
    pool = {
        # The fourth of each is plump, so that slivers also meet ordinary shapes.
        (kind, k): draw_form(kind, modes.get(stratum, "plump") if k < 3 else "plump", rng, corners)
        for kind in KINDS
        for k in range(4)
    }
    kinds = [pair for pair in PAIRS_OF_KINDS if belongs(stratum, pair)]
    pairs, labels = [], []
    for k in range(BATCH):
        kind_a, kind_b = kinds[k % len(kinds)]
        a, b = pool[kind_a, int(rng.integers(4))], pool[kind_b, int(rng.integers(3))]
        if rng.integers(2):
            a, b = b, a
        if a.kind == b.kind and rng.integers(4) == 0:
            a = b
        place, size = stratum, stratum
        if stratum == "smooth-deep":
            place, size = ("deep", "concentric")[rng.integers(2)], ("plain", "scales", "unequal", "far")[rng.integers(4)]
        elif stratum not in PLACES:
            shallow = "ellipsoid" in (a.kind, b.kind)
            place = str(rng.choice([p for p in PLACES if not (shallow and p in ("deep", "concentric"))]))
        if size == "unequal":
            a = scaled(a, 10.0 ** rng.uniform(-3.0, 0.0))
        if size == "scales":
            factor = 10.0 ** rng.uniform(-3.0, 3.0)
            a, b = scaled(a, factor), scaled(b, factor)
        rows_a, rows_b = laid(a, b, place, rng)
        shift = np.zeros(3)
        if size == "far":
            shift = FAR * rng.uniform(-1.0, 1.0, 3)
            shift[rng.integers(3)] = FAR
        pairs.append((at(a, rows_a, shift), a, at(b, rows_b, shift), b))
        labels.append(f"{stratum}/{seed}/{number}/{k} {place} {a.kind} {b.kind}")
    seeds = np.where(rng.integers(2, size=BATCH)[:, None] == 1, rng.normal(size=(BATCH, 3)), 0.0)
    return packed(pairs, seeds, labels)


def belongs(stratum: str, kinds: tuple[str, str]) -> bool:
    """Return whether pairs of these kinds are in the stratum."""
    if stratum == "large":
        return "hull" in kinds
    smooth = "ellipsoid" in kinds
    return smooth if stratum == "smooth-deep" else not (smooth and stratum in ("deep", "concentric"))


def scaled(form: Form, factor: float) -> Form:
    """Return the same form, larger."""
    return Form(form.kind, form.rows * factor, form.radius * factor, form.faces, form.edges)


def at(form: Form, rows: Array, shift: Array) -> Array:
    """Return rows moved by `shift`; the semi-axes of an ellipsoid are directions and stay."""
    moved = rows.copy()
    moved[slice(0, 1) if form.kind == "ellipsoid" else slice(None)] += shift
    return moved


def laid(a: Form, b: Form, place: str, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return world rows of both, b about the origin."""
    if place in ("deep", "concentric"):
        turns = Rotation.from_quat(rng.normal(size=(2, 4))).as_matrix()
        if rng.integers(3) == 0:
            turns[0] = turns[1]
        shift = rng.normal(size=3) * min(a.size, b.size) * rng.uniform(0.02, 0.3)
        if place == "concentric":
            shift *= rng.choice([0.0, 1e-12, 1e-8, 1e-4])
        return at(a, a.rows @ turns[0].T, shift), b.rows @ turns[1].T
    features = ("face", "edge", "corner")
    on_a, on_b = features[rng.integers(3)], features[rng.integers(3)]
    tilt, spin = 0.0, rng.uniform(0.0, 6.28)
    size = min(a.size, b.size)
    if place == "apart":
        gap = size * 10.0 ** rng.uniform(-2.0, 0.3)
    elif place == "shallow":
        gap = -size * 10.0 ** rng.uniform(-6.0, -1.5)
    else:
        gap = size * rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-15.0, -3.0)
    if place in ("flush", "parallel"):
        on_a = on_b = "face" if place == "flush" else "edge"
        spin = rng.integers(4) * 0.5 * np.pi
        tilt = (0.0, NEARLY_PARALLEL, 10.0 ** rng.uniform(-12.0, -4.0))[rng.integers(3)]
        gap *= rng.choice([0.0, 1.0])
    if place == "parallel" and rng.integers(2):
        gap = size * rng.choice([-0.05, 0.2])
    spot_a, spot_b = draw_spot(a, on_a, rng), draw_spot(b, on_b, rng)
    # a is turned so that its spot faces that of b, then spun about the common normal, tilted, and laid with the gap.
    of_a = np.array([-spot_a.normal, spot_a.tangent, cross(-spot_a.normal, spot_a.tangent)])
    of_b = np.array([spot_b.normal, spot_b.tangent, cross(spot_b.normal, spot_b.tangent)])
    c, s = np.cos(spin), np.sin(spin)
    spun = np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]]) @ of_b
    turn_a = spun.T @ of_a
    if tilt:
        turn_a = Rotation.from_rotvec(tilt * rng.normal(size=3)).as_matrix() @ turn_a
    turn_b = np.eye(3) if rng.integers(3) == 0 else Rotation.from_quat(rng.normal(size=4)).as_matrix()
    shift = spot_b.point + gap * spot_b.normal - turn_a @ spot_a.point
    return at(a, a.rows @ turn_a.T, shift) @ turn_b.T, b.rows @ turn_b.T


def packed(pairs: list[tuple[Array, Form, Array, Form]], seeds: Array, labels: list[str]) -> Batch:
    """Return pairs of world rows and forms as one batch."""
    rows = [r for rows_a, _, rows_b, _ in pairs for r in (rows_a, rows_b)]
    forms = [f for _, form_a, _, form_b in pairs for f in (form_a, form_b)]
    centre = np.array([rows_b[0] if np.abs(rows_b[0]).max() > 0.1 * FAR else np.zeros(3) for _, _, rows_b, _ in pairs])
    centred = [at(form, r, -centre[k // 2]) for k, (r, form) in enumerate(zip(rows, forms, strict=True))]
    shapes = make_shapes(
        [form.code for form in forms], _starts([len(r) for r in rows]), [form.radius for form in forms],
        [form.size for form in forms],
    )
    return Batch(
        np.ascontiguousarray(np.vstack(rows)),
        np.ascontiguousarray(np.vstack(centred)),
        centre,
        shapes,
        np.ascontiguousarray(np.vstack([form.faces for form in forms])),
        _starts([len(form.faces) for form in forms]),
        np.ascontiguousarray(seeds),
        labels,
    )


def _starts(lengths: list[int]) -> Ints:
    return np.cumsum([0, *lengths]).astype(np.int64)
