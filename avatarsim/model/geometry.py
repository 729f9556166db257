"""Bodies and their convex pieces as arrays, and the poses that move them.

All convex pieces of a world as flat arrays, which the collision kernels read.

Pair filter: which pairs of bodies may collide, by a family per body and a sparse list of excluded pairs. Rest depths: how deep
the few pairs may be that overlap at home.
"""

from collections.abc import Iterable, Sequence
from typing import Annotated, Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.jit.kept import NOT_KEPT, Whole
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Grid, IndexLine, Line, Matrices, Vectors
from avatarsim.jit.record import known_as_table
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere
from avatarsim.spatial import rotation

POINTS = 0
"""Kind: the convex hull of points, swept by a ball. Sphere: 1 point, capsule: 2, box: 8, hull: n."""

ELLIPSOID = 1
"""Kind: exactly 4 rows, the centre and the three semi-axes as vectors (directions scaled by lengths), not
points."""


SHAPE = np.dtype([("kind", "i8"), ("start", "i8"), ("radius", "f8"), ("extent", "f8")], align=True)
"""One row of Shapes; whole words, as arenas require."""


class Shapes(np.recarray[Any, np.dtype[Any]]):
    """The convex pieces of a world: ns rows, and one more of which only ``start`` means anything.

    Vertex rows are passed separately, in world coordinates, at every call. One array of records and no tuple of arrays: it is
    passed from kernel to kernel as seven words, and all fields of a shape lie in one line of the processor's cache.
    """

    kind: NDArray[np.int64]
    """POINTS or ELLIPSOID."""
    start: NDArray[np.int64]
    """Shape s owns vertex rows start[s] .. start[s + 1]."""
    radius: NDArray[np.float64]
    """Rounding radius [m] around the points; 0 for box, hull and ellipsoid."""
    extent: NDArray[np.float64]
    """Largest extent [m], the length to which all tolerances are relative."""


def make_shapes(
    kind: Sequence[int] | NDArray[np.int64], start: Sequence[int] | NDArray[np.int64],
    radius: Sequence[float] | NDArray[np.float64], extent: Sequence[float] | NDArray[np.float64],
) -> Shapes:
    """Return shapes of ns kinds, ns + 1 starts, ns radii and ns extents."""
    ns = len(kind)
    made = np.zeros(ns + 1, SHAPE)
    made["start"] = start
    made["kind"][:ns], made["radius"][:ns], made["extent"][:ns] = kind, radius, extent
    return made.view(Shapes)


known_as_table(Shapes, SHAPE)


Index = NDArray[np.int64]

OPEN: Final = -1
"""Family of bodies that may collide with bodies of any family."""


class PairFilter(NamedTuple):
    """For nb bodies and m pairs that never meet; memory is linear in both.

    family   (nb) two bodies of one family never meet, unless it is OPEN: all fixed bodies are one family
    first    (nb + 1) body i never meets never[first[i]] .. never[first[i + 1] - 1]
    never    (m) bodies k > i, in ascending order for each i: neighbours in a chain, the author's exclusions
    """

    family: Annotated[IndexLine, Whole(OPEN, lambda sizes: sizes.bodies)]
    first: Annotated[IndexLine, NOT_KEPT]
    never: Annotated[IndexLine, NOT_KEPT]


def pair_filter(family: ArrayLike, skipped: Iterable[tuple[int, int]] = ()) -> PairFilter:
    """Return the filter of bodies with these families (nb) that also leaves out the pairs ``skipped``, in any order."""
    families = np.array(family, dtype=np.int64)
    known = sorted({(min(pair), max(pair)) for pair in skipped})
    pairs = np.array(known, dtype=np.int64).reshape(-1, 2)
    first = np.searchsorted(pairs[:, 0], np.arange(len(families) + 1)).astype(np.int64)
    return PairFilter(families, first, np.ascontiguousarray(pairs[:, 1]))


@kernel
def may_meet(wanted: PairFilter, a: int, b: int) -> bool:
    """Return True if the pair of bodies a and b, in any order, is of interest. Logarithmic in the skipped pairs of one body."""
    if wanted.family[a] == wanted.family[b] and wanted.family[a] != OPEN:
        return False
    low, high = min(a, b), max(a, b)
    left, end = wanted.first[low], wanted.first[low + 1]
    right = end
    while left < right:
        middle = (left + right) // 2
        if wanted.never[middle] < high:
            left = middle + 1
        else:
            right = middle
    return not (left < end and wanted.never[left] == high)


class RestDepths(NamedTuple):
    """Depths of the m pairs of bodies that overlap at home, by ``key``, in ascending order; memory is linear in m.

    bodies  (1) number of bodies
    key     (m) a * bodies + b of bodies a < b
    depth   (m) how deep [m] the pair may be; every other pair 0
    """

    bodies: IndexLine
    key: IndexLine
    depth: Line


def rest_depths(bodies: int, pairs: Iterable[tuple[int, int, float]] = ()) -> RestDepths:
    """Return the table of so many bodies whose ``pairs`` (body, body, depth [m]) overlap at home, in any order."""
    known = sorted((min(a, b) * bodies + max(a, b), depth) for a, b, depth in pairs)
    keys, depths = [key for key, _ in known], [depth for _, depth in known]
    return RestDepths(np.array([bodies], dtype=np.int64), np.array(keys, dtype=np.int64), np.array(depths, dtype=np.float64))


@kernel
def rest_depth(rest: RestDepths, a: int, b: int) -> float:
    """Return how deep [m] bodies a and b, in any order, may be. Logarithmic in the number of pairs that may be at all."""
    left, right = 0, rest.key.shape[0]
    if right == 0:
        return 0.0
    end, key = right, min(a, b) * rest.bodies[0] + max(a, b)
    while left < right:
        middle = (left + right) // 2
        if rest.key[middle] < key:
            left = middle + 1
        else:
            right = middle
    return float(rest.depth[left]) if left < end and rest.key[left] == key else 0.0


Array = NDArray[np.float64]

CORNERS = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
"""Corners (8, 3) of a cube of 1 m about the origin."""


class Geometry(NamedTuple):
    """Constant geometry of a world of nb bodies and ns pieces.

    shapes       kind, start, radius and size of every piece
    local        (nv, 3) vertices in the frame of their body
    first_shape  (nb + 1) pieces of body b are first_shape[b] .. first_shape[b + 1]
    body         (ns) body of a piece
    wanted       pairs of bodies that must not overlap
    rest         how deep pairs may be that overlap at home
    """

    shapes: Shapes
    local: Vectors
    first_shape: IndexLine
    body: IndexLine
    wanted: PairFilter
    rest: RestDepths


class Poses(NamedTuple):
    """Poses of all bodies in the world: position (nb, 3) of its origin [m] and rotation (nb, 3, 3) matrix out of its axes;
    vertices (nv, 3) of its pieces [m]; boxes (ns, 6) around the pieces and hulls (nb, 6) around the bodies [m], each as low x, y,
    z, high x, y, z."""

    position: Vectors
    rotation: Matrices
    vertices: Vectors
    boxes: Grid
    hulls: Grid


def piece_points(piece: Piece) -> tuple[int, Array, float]:
    """Return the kind, points in the body frame and rounding radius of one piece."""
    shape, turn = piece.shape, rotation.to_matrix(piece.orientation)
    if isinstance(shape, Ellipsoid):
        axes = turn @ np.diag(shape.radii)
        return ELLIPSOID, np.vstack([np.array(piece.position), axes.T]), 0.0
    radius = 0.0
    if isinstance(shape, Sphere):
        points, radius = np.zeros((1, 3)), shape.radius
    elif isinstance(shape, Capsule):
        points, radius = np.array([[0.0, 0.0, -0.5], [0.0, 0.0, 0.5]]) * shape.length, shape.radius
    elif isinstance(shape, Box):
        points = CORNERS * np.array(shape.size)
    else:
        assert isinstance(shape, ConvexHull)
        points = np.array(shape.vertices)
    return POINTS, points @ turn.T + np.array(piece.position), radius


def geometry(scene: Scene) -> Geometry:
    """Return arrays of all pieces of `scene`; simulated bodies are re-centred on their centre of mass."""
    groups = [body.pieces for body in scene.bodies] + [link.pieces for link in scene.links]
    centres = [
        np.array(body.mass.centre) if body.role is Role.SIMULATED and body.mass else np.zeros(3) for body in scene.bodies
    ] + [np.zeros(3)] * len(scene.links)
    kinds, blocks, radii, sizes, owners, first = [], [], [], [], [], [0]
    for owner, (pieces, centre) in enumerate(zip(groups, centres, strict=True)):
        for piece in pieces:
            kind, points, radius = piece_points(piece)
            points[: 1 if kind == ELLIPSOID else None] -= centre
            extent = 2.0 * np.linalg.norm(points[1:], axis=1).max() if kind == ELLIPSOID else np.ptp(points, axis=0).max()
            kinds.append(kind)
            blocks.append(points)
            radii.append(radius)
            sizes.append(float(extent) + 2.0 * radius)
            owners.append(owner)
        first.append(len(kinds))
    start = np.cumsum([0] + [len(block) for block in blocks])
    local = np.ascontiguousarray(np.vstack(blocks)) if blocks else np.zeros((0, 3))
    shapes = make_shapes(kinds, start, radii, sizes)
    return Geometry(
        shapes, local, np.array(first, dtype=np.int64), np.array(owners, dtype=np.int64),
        pair_filter(scene.families, scene.skipped), rest_depths(len(groups), scene.resting),
    )


def poses(geo: Geometry, position: Array, orientation: Array) -> Poses:
    """Return fresh pose arrays with every body at the given position (nb, 3) and orientation (nb, 4)."""
    nb, ns = len(geo.first_shape) - 1, len(geo.body)
    fresh = Poses(
        np.ascontiguousarray(position, dtype=np.float64).copy(),
        np.ascontiguousarray(rotation.to_matrix(orientation)).reshape(nb, 3, 3),
        np.zeros_like(geo.local), np.zeros((ns, 6)), np.zeros((nb, 6)),
    )
    for b in range(nb):
        place(geo, fresh, b)
    return fresh


@kernel
def allowed_depth(geo: Geometry, s: int, t: int) -> float:
    """Return how deep [m] pieces s and t may be."""
    return rest_depth(geo.rest, geo.body[s], geo.body[t])


@kernel
def place(geo: Geometry, poses: Poses, b: int) -> None:
    """Carry the pieces of body b to its pose: world vertices, boxes of pieces, box of the body."""
    R, p, V = poses.rotation, poses.position, poses.vertices
    r00, r01, r02 = R[b, 0, 0], R[b, 0, 1], R[b, 0, 2]
    r10, r11, r12 = R[b, 1, 0], R[b, 1, 1], R[b, 1, 2]
    r20, r21, r22 = R[b, 2, 0], R[b, 2, 1], R[b, 2, 2]
    px, py, pz = p[b, 0], p[b, 1], p[b, 2]
    # the box of a body without pieces is a point; it has no pairs of pieces
    bare = geo.first_shape[b] == geo.first_shape[b + 1]
    for k in range(3):
        poses.hulls[b, k] = p[b, k] if bare else np.inf
        poses.hulls[b, 3 + k] = p[b, k] if bare else -np.inf
    for s in range(geo.first_shape[b], geo.first_shape[b + 1]):
        first, last = geo.shapes.start[s], geo.shapes.start[s + 1]
        radius = geo.shapes.radius[s]
        lx, ly, lz, ux, uy, uz = np.inf, np.inf, np.inf, -np.inf, -np.inf, -np.inf
        smooth = geo.shapes.kind[s] == ELLIPSOID
        ex, ey, ez = 0.0, 0.0, 0.0
        for i in range(first, last):
            x, y, z = geo.local[i, 0], geo.local[i, 1], geo.local[i, 2]
            wx, wy, wz = r00 * x + r01 * y + r02 * z, r10 * x + r11 * y + r12 * z, r20 * x + r21 * y + r22 * z
            if smooth and i > first:
                # the other three rows of an ellipsoid are semi-axes, which do not translate
                ex, ey, ez = ex + wx * wx, ey + wy * wy, ez + wz * wz
            else:
                wx, wy, wz = wx + px, wy + py, wz + pz
                lx, ly, lz = min(lx, wx), min(ly, wy), min(lz, wz)
                ux, uy, uz = max(ux, wx), max(uy, wy), max(uz, wz)
            V[i, 0] = wx
            V[i, 1] = wy
            V[i, 2] = wz
        ex, ey, ez = np.sqrt(ex) + radius, np.sqrt(ey) + radius, np.sqrt(ez) + radius
        B = poses.boxes
        B[s, 0], B[s, 1], B[s, 2] = lx - ex, ly - ey, lz - ez
        B[s, 3], B[s, 4], B[s, 5] = ux + ex, uy + ey, uz + ez
        for k in range(3):
            poses.hulls[b, k] = min(poses.hulls[b, k], B[s, k])
            poses.hulls[b, 3 + k] = max(poses.hulls[b, 3 + k], B[s, 3 + k])
