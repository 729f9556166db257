"""Wavefront OBJ files: vertices, groups and faces, nothing else. Groups are how authors hand over convex pieces."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from avatarsim.errors import InvalidFile
from avatarsim.pieces.mesh import Array, Indices, Mesh
from avatarsim.regular_file import read_text


def read_obj(path: Path) -> Mesh:
    """The mesh of an OBJ file; polygons are cut into fans, every line that starts with o or g opens a group.

    Raises InvalidFile for an unreadable file, words that are no numbers, and faces without vertices.
    """
    vertices: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    groups: list[int] = []
    group = 0
    for number, line in enumerate(_lines(path), start=1):
        words = line.split()
        try:
            if words[:1] == ["v"]:
                x, y, z = (float(word) for word in words[1:4])
                vertices.append([x, y, z])
            elif words[:1] in (["o"], ["g"]):
                group += 1
            elif words[:1] == ["f"]:
                corners = [_index(word, len(vertices)) for word in words[1:]]
                fan = [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:], strict=False)]
                triangles += fan
                groups += [group] * len(fan)
        except (ValueError, IndexError) as error:
            raise InvalidFile(f"line {number} of {path.name}", line.strip(), "a vertex or face of a whole OBJ file") from error
    if not triangles:
        raise InvalidFile(f"faces of {path.name}", 0, "an OBJ file with at least one face")
    return Mesh(path.name, np.array(vertices), np.array(triangles, dtype=np.int64), np.array(groups, dtype=np.int64))


def groups_of(mesh: Mesh) -> tuple[Mesh, ...]:
    """One mesh per group, with the vertices that it uses, all in the order of the file."""
    return tuple(mesh.part(mesh.groups == group) for group in np.unique(mesh.groups))


def groups(path: Path) -> tuple[tuple[Array, Indices], ...]:
    """Per group of an OBJ file its vertices (n, 3) in the file's unit and its triangles (t, 3), counted within the group."""
    return tuple((part.vertices, part.triangles) for part in groups_of(read_obj(path)))


def _lines(path: Path) -> Iterable[str]:
    return read_text(path, f"mesh {path.name}", "a readable OBJ file", errors="replace").splitlines()


def _index(word: str, count: int) -> int:
    """Place of the vertex that `word` (such as 7//3 or -1) names, among the `count` seen so far."""
    index = int(word.split("/")[0])
    place = index - 1 if index > 0 else count + index
    if not 0 <= place < count:
        raise IndexError(f"vertex {index} of {count}")
    return place
