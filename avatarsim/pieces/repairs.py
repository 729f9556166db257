"""Mesh repair that keeps the surface: merges vertices, drops degenerate triangles, orients faces; refuses all other faults."""

from dataclasses import dataclass, replace

import numpy as np

from avatarsim.errors import InvalidShape
from avatarsim.pieces.crossings import crossing_pairs
from avatarsim.pieces.edges import Edges, edges_of, parts, to_flip
from avatarsim.pieces.inside import inside_closed
from avatarsim.pieces.mesh import Array, Indices, Mesh, signed_volume

WELD = 1e-9
"""Vertices nearer than about this share of the mesh's size are one. Larger, and thin walls collapse."""

ADVICE = "repair='remesh' to wrap it in a closed surface, or hull=True for its convex hull"
"""What helps when a surface cannot be mended as it is."""


@dataclass(frozen=True)
class Fault:
    """What could not be mended: the number `value` of `thing`; `open` ones have no inside, `crossing` ones have it twice."""

    thing: str
    value: int
    valid: str
    open: bool = False
    crossing: bool = False


@dataclass(frozen=True, eq=False)
class Sound:
    """A mended mesh, sentences that say what was mended, and the faults that could not be.

    `parts` (t,) numbers the connected parts; `separate` says that parts go through one another, each sound by itself.
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
    """The mesh, if it has triangles and all coordinates are finite; InvalidShape otherwise."""
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
    said: list[str] = []
    mesh = _without_degenerates(_merged(mesh, said), said)
    if not len(mesh.triangles):
        raise InvalidShape(f"number of triangles of {mesh.name}", 0, "at least 4 with three different corners")
    edges = edges_of(mesh.triangles)
    part = parts(len(mesh.triangles), edges)
    if edges.open:
        fault = Fault(f"number of border edges of {mesh.name}", edges.open, f"0, a closed surface; {ADVICE}", open=True)
        return Sound(mesh, tuple(said), (fault,), part)
    turned = _one_way(mesh, edges, said)
    if turned is None:
        thing = f"number of edges of {mesh.name} where neighbours face opposite sides"
        fault = Fault(thing, edges.unbalanced, f"0, or a surface that has two sides; {ADVICE}", open=True)
        return Sound(mesh, tuple(said), (fault,), part)
    mesh = _outwards(turned, part, said)
    pairs = crossing_pairs(mesh.vertices, mesh.triangles) if crossings else np.zeros((0, 2), dtype=np.int64)
    within = int((part[pairs[:, 0]] == part[pairs[:, 1]]).sum())
    hollow = any(signed_volume(mesh.corners[part == k]) < 0.0 for k in np.unique(part)) if len(pairs) else False
    if within or hollow:
        thing = f"number of pairs of triangles of {mesh.name} that go through each other"
        return Sound(mesh, tuple(said), (Fault(thing, len(pairs), f"0; {ADVICE}", crossing=True),), part)
    if len(pairs):
        said.append(f"{len(np.unique(part[pairs]))} closed parts go through one another: every part was decomposed by itself")
    return Sound(mesh, tuple(said), (), part, separate=bool(len(pairs)))


def _merged(mesh: Mesh, said: list[str]) -> Mesh:
    """Equal vertices become one: the first of them, its coordinates untouched."""
    used = np.unique(mesh.triangles)
    grid = np.round((mesh.vertices[used] - mesh.vertices[used].min(axis=0)) / max(WELD * mesh.size, 1e-300))
    _, first, place = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    lost = len(used) - len(first)
    if not lost:
        return mesh
    if mesh.welded:
        said.append(f"{lost} vertices at the place of another were merged with it")
    target = np.zeros(len(mesh.vertices), dtype=np.int64)
    target[used] = used[first[place.ravel()]]
    return replace(mesh, triangles=target[mesh.triangles])


def _without_degenerates(mesh: Mesh, said: list[str]) -> Mesh:
    """Drop triangles with fewer than three corners, and pairs of copies that face each other or the same way.

    A triangle of three different corners in a line stays: it may close a seam, and it takes no room.
    """
    t = mesh.triangles
    thin = (t[:, 0] == t[:, 1]) | (t[:, 1] == t[:, 2]) | (t[:, 2] == t[:, 0])
    if thin.any():
        said.append(f"{int(thin.sum())} triangles with fewer than three different corners were dropped")
        mesh = replace(mesh, triangles=t[~thin], groups=mesh.groups[~thin])
    if len(mesh.triangles):
        _, first = np.unique(np.sort(mesh.triangles, axis=1), axis=0, return_index=True)
        copies = len(mesh.triangles) - len(first)
        if copies:
            said.append(f"{copies} triangles with the corners of another were dropped")
            kept = np.sort(first)
            mesh = replace(mesh, triangles=mesh.triangles[kept], groups=mesh.groups[kept])
    return mesh


def _one_way(mesh: Mesh, edges: Edges, said: list[str]) -> Mesh | None:
    """The mesh with every two neighbours facing the same side; None when there is no such choice."""
    if not edges.unbalanced:
        return mesh
    flips = to_flip(len(mesh.triangles), edges)
    if flips is None:
        return None
    triangles = np.where(flips[:, None], mesh.triangles[:, ::-1], mesh.triangles)
    if edges_of(triangles).unbalanced:
        return None
    count = int(min(flips.sum(), (~flips).sum()))
    said.append(f"{count} triangles faced another side than their neighbours and were turned over")
    return replace(mesh, triangles=triangles)


def _outwards(mesh: Mesh, part: Indices, said: list[str]) -> Mesh:
    """Turn over every part that faces inwards, unless it bounds a hollow inside another part."""
    triangles, corners, turned = mesh.triangles.copy(), mesh.corners, 0
    inward = [k for k in np.unique(part) if signed_volume(corners[part == k]) < 0.0]
    for k in inward:
        own = part == k
        if not _within(corners[own][:1, 0], corners, part, own):
            triangles[own] = triangles[own][:, ::-1]
            turned += 1
    if turned:
        said.append(f"{turned} closed part{'s' if turned > 1 else ''} faced inwards and was turned outwards")
    return replace(mesh, triangles=triangles)


def _within(point: Array, corners: Array, part: Indices, own: "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]") -> bool:
    """Whether a point lies in any other part, whichever way that one faces."""
    for k in np.unique(part[~own]):
        other = corners[part == k]
        outward = other if signed_volume(other) > 0.0 else other[:, ::-1]
        if inside_closed(point, outward)[0]:
            return True
    return False
