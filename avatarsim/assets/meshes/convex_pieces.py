"""Convex pieces of any mesh: as authored where already convex, else by approximate convex decomposition, with error bounds.

Result of a convex decomposition: convex pieces for a body, with bounds of their distance from the mesh.
"""

import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from avatarsim.assets.meshes import cache
from avatarsim.assets.meshes.decompose import PieceOptions, decomposed
from avatarsim.assets.meshes.enclosing import enclosing
from avatarsim.assets.meshes.hausdorff import Deviation, deviation
from avatarsim.assets.meshes.hulls import Hull, depth_below, hull_of
from avatarsim.assets.meshes.mesh import Array, Mesh, groups_of, read_mesh, signed_volume
from avatarsim.assets.meshes.repairs import Sound, finite, mended
from avatarsim.errors import InvalidShape
from avatarsim.scene.checks import finite_array, positive
from avatarsim.scene.shape import ConvexHull, Piece


@dataclass(frozen=True)
class Pieces:
    """Convex pieces of one mesh, for `Body(..., pieces=found.pieces, ...)`.

    pieces      hulls in the mesh's own frame [m], scaled and turned as asked
    source      "convex groups" or "convex mesh" (vertices as authored), "hull" (one requested hull), "decomposed"
    uncovered   [m] no point of the mesh's surface is farther than this from the nearest piece
    added       [m] no point of a piece is farther than this from the mesh, its inside included
    size        [m] diagonal of the box around the mesh, in its own axes
    reached     [m] some point is this far: at most `hausdorff`, and a measure of how sharp that bound is
    repairs     one sentence for everything that was changed before pieces were made
    from_cache  True when nothing had to be computed
    cache_note  where the answer was stored, or the reason why it was not
    seconds     [s] duration of the call

    Bounds are valid up to rounding. A mesh with holes has its inside where it fills more than half of the view.
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
        """Bound [m] of the Hausdorff distance: no point of the surface or of the pieces is farther from the other."""
        return max(self.uncovered, self.added)

    @property
    def vertices(self) -> tuple[int, ...]:
        """Number of vertices of every piece."""
        return tuple(len(piece.shape.vertices) for piece in self.pieces if isinstance(piece.shape, ConvexHull))


CONVEX = 1e-4
"""Share of its size by which a surface may lie below its hull and still count as convex: the digits of a text file."""

SMALLEST, LARGEST = 1e-4, 500.0
"""Valid sizes of a mesh [m]. Beyond, the file's unit is not the metre: a human in millimetres is 1.7 km tall."""

HALF = 0.5
"""A closed surface whose volume is below this share of its hull's is not convex, however thin the layer between."""


def pieces_of_mesh(
    mesh: str | Path | Mesh | tuple[ArrayLike, ArrayLike], scale: float = 1.0, *, y_up: bool = False, threshold: float = 0.05,
    seed: int = 0, most_vertices: int = 128, most_pieces: int | None = None, hull: bool = False, repair: str = "auto",
    fit: float | None = None, kept: bool = True, quiet: bool = False,
) -> Pieces:
    """Return convex pieces of a file (.obj .stl .ply .off .glb .gltf .dae) or of (vertices (n, 3), triangles (t, 3)).

    Groups of an OBJ that are all convex are taken as they are, every vertex as authored; a convex mesh is one piece.
    All other meshes are decomposed by CoACD, and the answer is kept in the user's cache folder.

    scale          metres per unit of the file; with `y_up`, the file's y axis becomes z
    threshold      concavity that a piece may keep, relative to the mesh's size (CoACD's measure), 0.01 to 1
    seed           of CoACD's search; the same seed gives the same bits
    most_vertices  of a piece; a hull with more is enclosed in one with so many, and the bound includes the added distance. Convex
                   groups stay as authored
    fit            metres that enclosing a hull may add; where `most_vertices` add more, a piece has more vertices
    most_pieces    at most so many, if CoACD can
    hull           one piece, the convex hull, even of a mesh with holes
    repair         "auto": merge equal vertices, drop degenerate triangles and copies, turn triangles outwards, and wrap a
                   surface that goes through itself in a closed one; refuse open surfaces, whose inside is a guess.
                   "remesh": wrap open surfaces too. "refuse": never wrap
    kept           False leaves the cache folder alone
    quiet          True prints nothing on the error stream, which otherwise shows the progress of steps longer than a second

    Raises InvalidFile (missing, unknown or broken file), InvalidShape (empty, not finite, flat, open, crossing itself, a
    size that no body has), InvalidInput (an option out of range), MissingPackage (trimesh or coacd).
    """
    begun = time.monotonic()
    scale = positive("scale of a mesh", scale)
    options = PieceOptions(threshold, seed, most_vertices, most_pieces, hull, repair, None if fit is None else fit / scale)
    read = finite(_as_mesh(mesh))
    _believable(read, scale)
    key = cache.key_of(read, options) if kept else ""
    answer, note = cache.load(key) if kept else (None, "not kept: kept=False")
    from_cache = answer is not None
    if answer is None:
        answer = answered(read, options, quiet)
        if kept:
            note = "; ".join(part for part in (note, cache.store(key, answer)) if part)
    pieces = tuple(Piece(ConvexHull(turned(scale * points, y_up))) for points in answer.hulls)
    gap = answer.deviation
    return Pieces(
        pieces, answer.source, scale * gap.uncovered, scale * gap.added, scale * gap.reached, scale * read.size,
        answer.repairs, from_cache, note, time.monotonic() - begun,
    )


def answered(mesh: Mesh, options: PieceOptions, quiet: bool) -> cache.Answer:
    """Return the pieces of a mesh with finite vertices, in its own unit."""
    groups = () if options.hull else _convex_groups(mesh)
    if len(groups) > 1:
        depth = max(depth_below(hull, group.corners) for hull, group in groups)
        # qhull drops some vertices in the middle of a face; "as authored" means all
        return cache.Answer(tuple(hull.points for hull, _ in groups), "convex groups", Deviation(0.0, depth, 0.0), ())
    sound = mended(mesh)
    used = sound.mesh.part(np.ones(len(sound.mesh.triangles), dtype=bool))
    whole = hull_of(used.vertices, mesh.name)
    closed = not any(fault.open for fault in sound.faults)
    repairs = sound.repairs
    is_convex = not sound.faults and _is_convex(whole, used)
    if options.hull or is_convex:
        repairs += tuple(f"the hull closes this: {fault.thing} is {fault.value}" for fault in sound.faults)
        return _measured([whole], "hull" if options.hull else "convex mesh", used, closed, options, repairs, is_convex)
    remesh = options.repair == "remesh" or (options.repair == "auto" and all(fault.crossing for fault in sound.faults))
    if sound.faults and not remesh:
        sound.refuse()
    if sound.faults:
        repairs += tuple(f"wrapped in a closed surface: {fault.thing} is {fault.value}" for fault in sound.faults)
    stream = None if quiet else sys.stderr
    clouds = decomposed(_parts(sound), options, bool(sound.faults), stream)
    hulls = [hull for points in clouds if (hull := _solid(points, mesh.name))]
    if not hulls:
        raise InvalidShape(f"decomposition of {mesh.name}", "flat pieces only", "a mesh with a volume")
    return _measured(hulls, "decomposed", used, closed, options, repairs)


def _as_mesh(mesh: str | Path | Mesh | tuple[ArrayLike, ArrayLike]) -> Mesh:
    if isinstance(mesh, Mesh):
        return mesh
    if isinstance(mesh, str | Path):
        return read_mesh(mesh)
    if not isinstance(mesh, tuple | list) or len(mesh) != 2:
        raise InvalidShape("mesh", mesh, "the path of a file, or a pair of vertices (n, 3) and triangles (m, 3)")
    vertices, triangles = np.asarray(mesh[0]), np.asarray(mesh[1])
    if vertices.ndim != 2 or vertices.shape[1:] != (3,):
        raise InvalidShape("shape of the vertices of a mesh", vertices.shape, "(n, 3)")
    if triangles.size == 0:
        raise InvalidShape("number of triangles of the mesh", 0, "at least 4, around a volume")
    numbers = finite_array("triangles of the mesh", triangles, (-1, 3), InvalidShape)
    good = (numbers == np.floor(numbers)) & (numbers >= 0) & (numbers < len(vertices))
    if not good.all():
        valid = f"a whole number from 0 to {len(vertices) - 1}"
        raise InvalidShape("vertex number of a triangle", float(numbers[~good][0]), valid)
    return Mesh("the mesh", vertices.astype(np.float64), numbers.astype(np.int64), np.zeros(len(numbers), dtype=np.int64))


def _believable(mesh: Mesh, scale: float) -> None:
    size = scale * mesh.size
    if not SMALLEST <= size <= LARGEST:
        valid = f"from {SMALLEST:g} to {LARGEST:g}; scale is metres per unit of the file, 0.001 for millimetres"
        raise InvalidShape(f"size of {mesh.name} [m] at scale {scale:g}", size, valid)


def _convex_groups(mesh: Mesh) -> tuple[tuple[Hull, Mesh], ...]:
    """Return hull and mesh of every group, if there are several and each is closed and convex; none otherwise."""
    groups = groups_of(mesh)
    found = []
    for group in groups if len(groups) > 1 else ():
        sound = mended(group, crossings=False)
        hull = _solid(group.vertices, mesh.name)
        if sound.faults or hull is None or not _is_convex(hull, sound.mesh):
            return ()
        found.append((hull, group))
    return tuple(found)


def _is_convex(hull: Hull, mesh: Mesh) -> bool:
    """Return True if a closed surface lies on its hull all over, and goes around it once."""
    own, full = signed_volume(mesh.corners), signed_volume(_outward(hull))
    return depth_below(hull, mesh.corners) <= CONVEX * mesh.size and own >= HALF * full


def _outward(hull: Hull) -> Array:
    """Return the hull's facets (m, 3, 3), all facing outwards."""
    about = hull.facets - hull.points[hull.used].mean(axis=0)
    inward = np.linalg.det(about) < 0.0
    return np.where(inward[:, None, None], hull.facets[:, ::-1], hull.facets)


def _parts(sound: Sound) -> list[Mesh]:
    """Return the meshes to decompose: the whole mesh, or each of its parts when they go through one another."""
    if not sound.separate:
        return [sound.mesh]
    return [sound.mesh.part(sound.parts == k) for k in np.unique(sound.parts)]


def _solid(points: Array, name: str) -> Hull | None:
    """Return the hull of points, or None when they are flat: such a piece has no volume."""
    try:
        return hull_of(points, name)
    except InvalidShape:
        return None


def _measured(
    hulls: list[Hull], source: str, mesh: Mesh, closed: bool, options: PieceOptions, notes: tuple[str, ...], convex: bool = False
) -> cache.Answer:
    """Enclose the hulls in ones of few vertices and measure these against the mesh; convex ones by depth alone."""
    around = [enclosing(hull, options.most_vertices, mesh.name, options.fit)[0] for hull in hulls]
    if convex and around[0] is hulls[0]:
        gap = Deviation(0.0, depth_below(around[0], mesh.corners), 0.0)
    else:
        gap = deviation(around, mesh.corners, closed)
    return cache.Answer(tuple(hull.points[hull.used] for hull in around), source, gap, notes)


def turned(points: Array, y_up: bool) -> Array:
    """Return points (n, 3) of a file, its y axis as z where `y_up`."""
    return np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=-1) if y_up else points
