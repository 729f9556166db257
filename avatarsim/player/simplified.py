"""Meshes of files with fewer triangles, for drawing, and with sharp edges."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from avatarsim.assets.models.pieces_of_geoms import Visual
from avatarsim.errors import MissingPackage
from avatarsim.player.surfaces import Surface, surface
from avatarsim.scene.shape import Piece

TRIANGLES = 70_000
"""Triangles of an avatar's meshes together: 1.2 MB of a page. More: pages of short clips pass 3 MB together with their motions;
fewer: thin fingers lose their shape."""
ROOM_TRIANGLES = 30_000
"""Triangles of a room's meshes together, which are larger and farther away."""
CREASE = 0.72
"""Angle [rad] between two triangles beyond which their common edge is drawn sharp: 41 degrees."""

HASTE = 5.0
"""Largest growth of the error of collapsed edges, from 0 to 10. More: surfaces are farther off, three times at 7; less:
meshes stay finer than the page allows."""


def visual_surfaces(visuals: Mapping[str, Sequence[Visual]], names: Iterable[str], most: int = TRIANGLES) -> dict[str, Surface]:
    """Return the surfaces of those visuals that ``names`` have, with meshes of at most ``most`` triangles together."""
    chosen = {name: visuals[name] for name in names if name in visuals}
    parts = [part for own in chosen.values() for part in own]
    thinned = iter(simplified([part for part in parts if not isinstance(part, Piece)], most))
    return {
        name: surface([part if isinstance(part, Piece) else creased(next(thinned)) for part in own])
        for name, own in chosen.items()
    }


def simplified(meshes: Sequence[Surface], most: int) -> list[Surface]:
    """Return meshes with at most ``most`` triangles together, each with its share (Garland and Heckbert 1997).

    Raises MissingPackage."""
    count = sum(len(triangles) for _, triangles in meshes)
    if count <= most:
        return list(meshes)
    try:
        import fast_simplification
        import trimesh
    except ModuleNotFoundError as error:
        raise MissingPackage(error.name or "fast_simplification", "assets", "drawing fine meshes") from error
    # edges are collapsed where triangles share vertices, but those of STL files do not
    found = [trimesh.Trimesh(points, triangles) for points, triangles in meshes]
    thinned: list[Surface] = [(one.vertices, one.faces) for one in found]
    while count > most:
        before, share = count, most / count
        thinned = [
            fast_simplification.simplify(points, triangles, target_count=int(share * len(triangles)), agg=HASTE)
            if len(triangles) > 4 else (points, triangles) for points, triangles in thinned
        ]
        count = sum(len(triangles) for _, triangles in thinned)
        if count == before:
            break
    return [(np.asarray(points, dtype=np.float64), np.asarray(triangles, dtype=np.int64)) for points, triangles in thinned]


def creased(mesh: Surface) -> Surface:
    """Return a mesh whose triangles share vertices only across edges that should look round. Raises MissingPackage."""
    try:
        import trimesh
    except ModuleNotFoundError as error:
        raise MissingPackage("trimesh", "assets", "drawing meshes") from error
    found = trimesh.graph.smooth_shade(trimesh.Trimesh(*mesh, process=False), angle=CREASE, facet_minarea=None)
    return np.asarray(found.vertices, dtype=np.float64), np.asarray(found.faces, dtype=np.int64)
