"""Wavefront OBJ files whose groups are convex pieces, read as hulls: vertices, groups and faces, nothing else."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.scene.shape import ConvexHull, Piece

Array = NDArray[np.float64]


def groups(path: Path) -> tuple[tuple[Array, NDArray[np.int64]], ...]:
    """Per group its vertices (n, 3) in the file's unit and its triangles (t, 3), vertices counted within the group.

    Polygons are cut into fans. Raises InvalidFile for words that are no numbers and for faces without vertices.
    """
    vertices: list[list[float]] = []
    faces: list[list[tuple[int, int, int]]] = [[]]
    for number, line in enumerate(_lines(path), start=1):
        words = line.split()
        try:
            if words[:1] == ["v"]:
                x, y, z = (float(word) for word in words[1:4])
                vertices.append([x, y, z])
            elif words[:1] in (["o"], ["g"]):
                faces.append([])
            elif words[:1] == ["f"]:
                corners = [_index(word, len(vertices)) for word in words[1:]]
                faces[-1] += [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:], strict=False)]
        except (ValueError, IndexError) as error:
            raise InvalidFile(f"line {number} of {path.name}", line.strip(), "a vertex or face of a whole OBJ file") from error
    found = []
    for triangles in faces:
        if triangles:
            used, local = np.unique(np.array(triangles), return_inverse=True)
            found.append((np.array(vertices)[used], local.reshape(-1, 3).astype(np.int64)))
    if not found:
        raise InvalidFile(f"faces of {path.name}", 0, "an OBJ file with at least one face")
    return tuple(found)


def convex_pieces(path: Path, scale: float, y_up: bool) -> tuple[Piece, ...]:
    """One hull per group, `scale` metres per unit; the body frame is below the middle of the object's box, z up.

    The groups are taken to be convex, as their author decomposed them: the hull of a group is the group.
    """
    hulls = []
    for vertices, _ in groups(path):
        points = scale * vertices
        hulls.append(np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=-1) if y_up else points)
    low, high = np.vstack(hulls).min(axis=0), np.vstack(hulls).max(axis=0)
    foot = np.array([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2]])
    return tuple(Piece(ConvexHull(points - foot)) for points in hulls)


def _lines(path: Path) -> Iterable[str]:
    try:
        return path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as error:
        raise InvalidFile(f"mesh {path.name}", str(error), "a readable OBJ file") from error


def _index(word: str, count: int) -> int:
    """Place of the vertex that `word` (such as 7//3 or -1) names, among the `count` seen so far."""
    index = int(word.split("/")[0])
    place = index - 1 if index > 0 else count + index
    if not 0 <= place < count:
        raise IndexError(f"vertex {index} of {count}")
    return place
