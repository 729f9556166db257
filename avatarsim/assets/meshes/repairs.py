"""Mesh repair that keeps the surface: merges vertices, drops degenerate triangles, orients faces; refuses all other faults.

Edge topology of a triangle mesh: closedness, orientation and connected components.

Self-intersections of a mesh: edges against triangles by signed volumes, for pairs from sweep and prune over their boxes.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.meshes.mesh import Array, Indices, Mesh, signed_volume
from avatarsim.assets.meshes.mesh_queries import inside_closed, ragged
from avatarsim.errors import InvalidShape


@dataclass(frozen=True, eq=False)
class Edges:
    """Number of triangles at each undirected edge, and the pairs of triangles that share an edge of exactly two.

    counts  (e,) triangles at each edge; balance (e,) the excess of triangles along it in one direction
    pairs   (p, 2) triangles at the edges of two; alike (p,) whether both run along it in one direction, so face apart
    """

    counts: Indices
    balance: Indices
    pairs: Indices
    alike: NDArray[np.bool_]

    @property
    def open(self) -> int:
        """Number of edges with an odd number of triangles: the surface has a border there, or a fin."""
        return int((self.counts % 2).sum())

    @property
    def unbalanced(self) -> int:
        """Number of edges along which neighbours face opposite sides."""
        return int((self.balance != 0).sum())


def edges_of(triangles: Indices) -> Edges:
    """Return the edges of triangles (t, 3)."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    owner = np.repeat(np.arange(len(triangles)), 3)
    forward = start < end
    keys = np.stack([np.minimum(start, end), np.maximum(start, end)], axis=1)
    _, place, counts = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    place = place.ravel()
    balance = np.bincount(place, np.where(forward, 1.0, -1.0)).astype(np.int64)
    order = np.argsort(place, kind="stable")
    first = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)[counts == 2]
    a, b = order[first], order[first + 1]
    return Edges(counts.astype(np.int64), balance, np.stack([owner[a], owner[b]], axis=1), forward[a] == forward[b])


def parts(count: int, edges: Edges) -> Indices:
    """Return the number (t,) of the connected part of each of `count` triangles."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    a, b = edges.pairs.T
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def to_flip(count: int, edges: Edges) -> NDArray[np.bool_] | None:
    """Return which of `count` triangles to turn over so that neighbours face the same side; None if no choice does that.

    Every triangle has two sheets, as it is and turned over. Sheets of neighbours that agree are joined; a surface
    with two sides falls into two halves, a Moebius band does not.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    a, b = edges.pairs.T
    turned = np.where(edges.alike, count, 0)
    rows, columns = np.concatenate([a, a + count]), np.concatenate([b + turned, b + count - turned])
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(2 * count, 2 * count))
    label = np.asarray(connected_components(graph, directed=False)[1])
    as_is, over = label[:count], label[count:]
    if (as_is == over).any():
        return None
    # labels count up from sheet 0 of the first triangle of each part
    return np.asarray(as_is > over)


TOUCH = 1e-9
"""Share of an edge or a triangle by which a crossing must lie inside both. At 0, triangles that only touch count."""

PAIRS_AT_ONCE = 2_000_000
"""Pairs of triangles whose boxes are compared in one go, for the memory."""


def crossing_pairs(vertices: Array, triangles: Indices) -> Indices:
    """Return pairs (k, 2) of triangles without a common vertex, of which an edge of one goes through the other.

    Vertices must be merged, else neighbours have no common vertex. Triangles that overlap within one plane, and neighbours
    folded onto each other, are not found.
    """
    corners = vertices[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    axis = int(np.argmax(low.std(axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    # in this order, the boxes that overlap box k along the axis are the next ones, up to `last`
    last = np.searchsorted(low[order, axis], high[order, axis], side="right")
    counts = np.maximum(last - np.arange(len(order)) - 1, 0)
    found = []
    begin, total = 0, np.concatenate([[0], np.cumsum(counts)])
    while begin < len(order):
        end = max(begin + 1, int(np.searchsorted(total, total[begin] + PAIRS_AT_ONCE, side="right")) - 1)
        owner, step = ragged(counts[begin:end])
        a, b = order[begin + owner], order[begin + owner + 1 + step]
        near = ((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)
        a, b = a[near], b[near]
        strangers = ~(triangles[a][:, :, None] == triangles[b][:, None, :]).any(axis=(1, 2))
        a, b = a[strangers], b[strangers]
        met = _pierced(corners[a], corners[b]) | _pierced(corners[b], corners[a])
        found.append(np.stack([a[met], b[met]], axis=1))
        begin = end
    return np.concatenate(found) if found else np.zeros((0, 2), dtype=np.int64)


def _pierced(one: Array, other: Array) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
    """Return True if an edge of triangle `one` (n, 3, 3) goes through the inside of `other` (n, 3, 3).
    Computed by volumes of tetrahedra."""
    a, b, c = other[:, 0], other[:, 1], other[:, 2]
    normal = np.cross(b - a, c - a)
    scale = np.einsum("ni,ni->n", normal, normal)
    met = np.zeros(len(one), dtype=bool)
    for k in range(3):
        p, q = one[:, k], one[:, (k + 1) % 3]
        from_p, from_q = np.einsum("ni,ni->n", normal, p - a), np.einsum("ni,ni->n", normal, q - a)
        across = from_p - from_q
        share = from_p / np.where(across != 0.0, across, 1.0)
        point = p + share[:, None] * (q - p)
        inside = (across != 0.0) & (share > TOUCH) & (share < 1.0 - TOUCH)
        for start, end in ((a, b), (b, c), (c, a)):
            inside &= np.einsum("ni,ni->n", np.cross(end - start, point - start), normal) > TOUCH * scale
        met |= inside
    return met


WELD = 1e-9
"""Vertices nearer than about this share of the mesh's size are one. Larger, and thin walls collapse."""

ADVICE = "repair='remesh' to wrap it in a closed surface, or hull=True for its convex hull"
"""Advice for surfaces that cannot be mended as they are."""


@dataclass(frozen=True)
class Fault:
    """An unmended fault: the number `value` of `thing`; `open` ones have no inside, `crossing` ones have it twice."""

    thing: str
    value: int
    valid: str
    open: bool = False
    crossing: bool = False


@dataclass(frozen=True, eq=False)
class Sound:
    """A mended mesh, sentences on the repairs, and the faults that could not be mended.

    `parts` (t,) numbers the connected parts; `separate` is True if parts go through one another, each sound by itself.
    """

    mesh: Mesh
    repairs: tuple[str, ...]
    faults: tuple[Fault, ...]
    parts: Indices
    separate: bool = False

    def refuse(self) -> None:
        """Raise InvalidShape for the first fault."""
        for fault in self.faults:
            raise InvalidShape(fault.thing, fault.value, fault.valid)


def finite(mesh: Mesh) -> Mesh:
    """Return the mesh if it has triangles and all coordinates are finite; InvalidShape otherwise."""
    if not len(mesh.triangles):
        raise InvalidShape(f"number of triangles of {mesh.name}", 0, "at least 4, around a volume")
    broken = ~np.isfinite(mesh.vertices).all(axis=1)
    if broken.any():
        first = int(np.flatnonzero(broken)[0])
        raise InvalidShape(f"vertex {first} of {mesh.name}", mesh.vertices[first].tolist(), "finite numbers only")
    return mesh


def mended(mesh: Mesh, crossings: bool = True) -> Sound:
    """Merge equal vertices, drop triangles without corners and copies, turn neighbours to face the same way, outwards.

    `crossings` False leaves out the search for triangles that go through one another.
    """
    notes: list[str] = []
    mesh = _without_degenerates(_merged(mesh, notes), notes)
    if not len(mesh.triangles):
        raise InvalidShape(f"number of triangles of {mesh.name}", 0, "at least 4 with three different corners")
    edges = edges_of(mesh.triangles)
    part = parts(len(mesh.triangles), edges)
    if edges.open:
        fault = Fault(f"number of border edges of {mesh.name}", edges.open, f"0, a closed surface; {ADVICE}", open=True)
        return Sound(mesh, tuple(notes), (fault,), part)
    turned = _one_way(mesh, edges, notes)
    if turned is None:
        thing = f"number of edges of {mesh.name} where neighbours face opposite sides"
        fault = Fault(thing, edges.unbalanced, f"0, or a surface that has two sides; {ADVICE}", open=True)
        return Sound(mesh, tuple(notes), (fault,), part)
    mesh = _outwards(turned, part, notes)
    pairs = crossing_pairs(mesh.vertices, mesh.triangles) if crossings else np.zeros((0, 2), dtype=np.int64)
    within = int((part[pairs[:, 0]] == part[pairs[:, 1]]).sum())
    hollow = any(signed_volume(mesh.corners[part == k]) < 0.0 for k in np.unique(part)) if len(pairs) else False
    if within or hollow:
        thing = f"number of pairs of triangles of {mesh.name} that go through each other"
        return Sound(mesh, tuple(notes), (Fault(thing, len(pairs), f"0; {ADVICE}", crossing=True),), part)
    if len(pairs):
        notes.append(f"{len(np.unique(part[pairs]))} closed parts go through one another: every part was decomposed by itself")
    return Sound(mesh, tuple(notes), (), part, separate=bool(len(pairs)))


def _merged(mesh: Mesh, notes: list[str]) -> Mesh:
    """Merge equal vertices into the first of them, its coordinates untouched."""
    used = np.unique(mesh.triangles)
    grid = np.round((mesh.vertices[used] - mesh.vertices[used].min(axis=0)) / max(WELD * mesh.size, 1e-300))
    _, first, place = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    lost = len(used) - len(first)
    if not lost:
        return mesh
    if mesh.welded:
        notes.append(f"{lost} vertices at the place of another were merged with it")
    target = np.zeros(len(mesh.vertices), dtype=np.int64)
    target[used] = used[first[place.ravel()]]
    return replace(mesh, triangles=target[mesh.triangles])


def _without_degenerates(mesh: Mesh, notes: list[str]) -> Mesh:
    """Drop triangles with fewer than three corners, and pairs of copies that face each other or the same way.

    A triangle of three different corners in a line stays: it may close a seam, and it takes no room.
    """
    t = mesh.triangles
    thin = (t[:, 0] == t[:, 1]) | (t[:, 1] == t[:, 2]) | (t[:, 2] == t[:, 0])
    if thin.any():
        notes.append(f"{int(thin.sum())} triangles with fewer than three different corners were dropped")
        mesh = replace(mesh, triangles=t[~thin], groups=mesh.groups[~thin])
    if len(mesh.triangles):
        _, first = np.unique(np.sort(mesh.triangles, axis=1), axis=0, return_index=True)
        copies = len(mesh.triangles) - len(first)
        if copies:
            notes.append(f"{copies} triangles with the corners of another were dropped")
            kept = np.sort(first)
            mesh = replace(mesh, triangles=mesh.triangles[kept], groups=mesh.groups[kept])
    return mesh


def _one_way(mesh: Mesh, edges: Edges, notes: list[str]) -> Mesh | None:
    """Return the mesh with every two neighbours facing the same side; None when there is no such choice."""
    if not edges.unbalanced:
        return mesh
    flips = to_flip(len(mesh.triangles), edges)
    if flips is None:
        return None
    triangles = np.where(flips[:, None], mesh.triangles[:, ::-1], mesh.triangles)
    if edges_of(triangles).unbalanced:
        return None
    count = int(min(flips.sum(), (~flips).sum()))
    notes.append(f"{count} triangles faced another side than their neighbours and were turned over")
    return replace(mesh, triangles=triangles)


def _outwards(mesh: Mesh, part: Indices, notes: list[str]) -> Mesh:
    """Turn over every part that faces inwards, unless it bounds a hollow inside another part."""
    triangles, corners, turned = mesh.triangles.copy(), mesh.corners, 0
    inward = [k for k in np.unique(part) if signed_volume(corners[part == k]) < 0.0]
    for k in inward:
        own = part == k
        if not _within(corners[own][:1, 0], corners, part, own):
            triangles[own] = triangles[own][:, ::-1]
            turned += 1
    if turned:
        notes.append(f"{turned} closed part{'s' if turned > 1 else ''} faced inwards and was turned outwards")
    return replace(mesh, triangles=triangles)


def _within(point: Array, corners: Array, part: Indices, own: "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]") -> bool:
    """Return True if a point lies in any other part, regardless of the side that one faces."""
    for k in np.unique(part[~own]):
        other = corners[part == k]
        outward = other if signed_volume(other) > 0.0 else other[:, ::-1]
        if inside_closed(point, outward)[0]:
            return True
    return False
