"""Triangle meshes from files. OBJ is read here, the other formats by trimesh, which only this file imports.

Of OBJ files only vertices, groups and faces are read. Groups are the usual form of convex pieces made by authors.
"""

import io
from collections.abc import Iterable
from dataclasses import dataclass
from os.path import exists
from pathlib import Path
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile, MissingPackage
from avatarsim.files import check, read_bytes, read_text

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Mesh:
    """`vertices` (n, 3) in the file's unit, `triangles` (t, 3) of vertex numbers, `groups` (t,) of group numbers.

    `name` is used in errors; `welded` is True if its format shares vertices between triangles at all.
    """

    name: str
    vertices: Array
    triangles: Indices
    groups: Indices
    welded: bool = True

    @property
    def corners(self) -> Array:
        """Return corners (t, 3, 3) of every triangle."""
        return self.vertices[self.triangles]

    @property
    def size(self) -> float:
        """Diagonal of the box around all vertices in use; 0 when there is none."""
        used = self.vertices[np.unique(self.triangles)]
        return float(np.linalg.norm(np.ptp(used, axis=0))) if len(used) else 0.0

    def part(self, chosen: NDArray[np.bool_]) -> "Mesh":
        """Return the chosen (t,) triangles, with the vertices that they use, in the order of the file."""
        used, local = np.unique(self.triangles[chosen], return_inverse=True)
        triangles = local.reshape(-1, 3).astype(np.int64)
        return Mesh(self.name, self.vertices[used], triangles, self.groups[chosen], self.welded)


def areas(corners: Array) -> Array:
    """Return the area (t,) of triangles with corners (t, 3, 3)."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * np.asarray(np.linalg.norm(across, axis=1))


def signed_volume(corners: Array) -> float:
    """Return the volume inside a closed surface with corners (t, 3, 3); negative when its triangles face inwards."""
    if not len(corners):
        return 0.0
    about = corners - corners.mean(axis=(0, 1))
    return float(np.einsum("ti,ti->", about[:, 0], np.cross(about[:, 1], about[:, 2]))) / 6.0


def read_obj(path: Path) -> Mesh:
    """Read the mesh of an OBJ file; polygons are cut into fans, every line that starts with o or g opens a group.

    Raises InvalidFile for an unreadable file, words that are not numbers, and faces without vertices.
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
    """Return one mesh per group, with the vertices that it uses, all in the order of the file."""
    return tuple(mesh.part(mesh.groups == group) for group in np.unique(mesh.groups))


def groups(path: Path) -> tuple[tuple[Array, Indices], ...]:
    """Return vertices (n, 3) and triangles (t, 3) of each group of an OBJ file, in its unit and counted within the group."""
    return tuple((part.vertices, part.triangles) for part in groups_of(read_obj(path)))


def _lines(path: Path) -> Iterable[str]:
    return read_text(path, f"mesh {path.name}", "a readable OBJ file", errors="replace").splitlines()


def _index(word: str, count: int) -> int:
    """Return the index of the vertex that `word` (such as 7//3 or -1) names, among the `count` read so far."""
    index = int(word.split("/")[0])
    place = index - 1 if index > 0 else count + index
    if not 0 <= place < count:
        raise IndexError(f"vertex {index} of {count}")
    return place


BY_TRIMESH = (".glb", ".gltf", ".off", ".ply", ".stl", ".dae")
"""Formats read by trimesh, COLLADA with pycollada. A scene of several meshes becomes one mesh."""

MOST_INSTANCES = 8
"""Nodes of a COLLADA file that instantiate other nodes: nested ones multiply, eight make 18 copies at most. More: a small file
fills the memory; the robots known here have none in shapes that collide."""


def read_mesh(path: str | Path) -> Mesh:
    """Read the mesh of a file, in the format of its suffix.

    Raises InvalidFile (missing, unknown format, broken, without a triangle); MissingPackage without trimesh.
    """
    path = Path(path)
    # by os.path, which treats names that are too long for the system as missing files
    if not exists(path):
        raise InvalidFile("mesh file", str(path), "the path of an existing file")
    ending = path.suffix.lower()
    if ending == ".obj":
        return read_obj(path)
    if ending not in BY_TRIMESH:
        raise InvalidFile(f"format of {path.name}", ending, "one of .obj " + " ".join(BY_TRIMESH))
    return _by_trimesh(path, ending)


STL_HEADER, STL_TRIANGLE = 84, 50
"""Bytes of a binary STL file before its first triangle, the last four of them the number of triangles, and for each of these."""


def complete_stl(name: str, content: bytes) -> bytes:
    """Return the content of an STL file; text, in which a name may be of any encoding, as UTF-8.
    Raises InvalidFile for a cut file: trimesh takes a binary of wrong length for text, and of cut text the solids before."""
    size, count = len(content), int.from_bytes(content[STL_HEADER - 4 : STL_HEADER], "little")
    if size >= STL_HEADER and size == STL_HEADER + STL_TRIANGLE * count:
        return content
    words = content.lower().split()
    if words[:1] == [b"solid"] and b"facet" in words:
        # a name may follow the last keyword
        if b"endsolid" not in words or b"facet" in words[len(words) - words[::-1].index(b"endsolid") :]:
            raise InvalidFile(f"end of {name}", "cut off within a solid", "endsolid, as the end of STL text")
        return content.decode("utf-8", "replace").encode()
    if size < STL_HEADER:
        raise InvalidFile(f"length of {name} [bytes]", size, f"{STL_HEADER} at least in binary STL; text begins with solid")
    valid = f"{STL_HEADER + STL_TRIANGLE * count}, for the {count} triangles that its header announces"
    raise InvalidFile(f"length of {name} [bytes]", size, valid)


def collada_unit(name: str, content: bytes) -> float:
    """Return the unit of length of a COLLADA file in metres.

    Raises InvalidFile for invalid XML, entities, an invalid unit of length, and more than MOST_INSTANCES."""
    found, parser = {"unit": 1.0, "instances": 0}, expat.ParserCreate()

    def start(tag: str, attributes: dict[str, str]) -> None:
        if tag == "unit" and "meter" in attributes:
            found["unit"] = float(attributes["meter"])
        found["instances"] += tag == "instance_node"

    def refuse(*declared: object) -> None:
        raise InvalidFile(f"DOCTYPE or entity in {name}", declared[0], "COLLADA without DOCTYPE and entities")

    parser.StartElementHandler, parser.StartDoctypeDeclHandler = start, refuse
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError) as error:
        raise InvalidFile(f"mesh {name}", f"{type(error).__name__}: {error}", "a whole COLLADA file") from error
    if not 0.0 < found["unit"] < np.inf:
        raise InvalidFile(f"unit of length of {name} [m]", found["unit"], "a finite number above 0")
    if found["instances"] > MOST_INSTANCES:
        raise InvalidFile(f"instances of nodes in {name}", found["instances"], f"up to {MOST_INSTANCES}")
    return found["unit"]


def _by_trimesh(path: Path, ending: str) -> Mesh:
    try:
        import trimesh

        if ending == ".dae":
            import collada  # noqa: F401
    except ImportError as error:
        raise MissingPackage(error.name or "trimesh", "assets", f"reading {ending} meshes") from error
    valid = f"a whole {ending} file with at least one triangle"
    thing = f"mesh {path.name}"
    check(path, thing, valid)
    source: io.BytesIO | str = str(path)
    unit = 1.0
    if ending == ".stl":
        source = io.BytesIO(complete_stl(path.name, read_bytes(path, thing, valid)))
    elif ending == ".dae":
        content = read_bytes(path, thing, valid)
        source, unit = io.BytesIO(content), collada_unit(path.name, content)

    class FolderResolver(trimesh.resolvers.FilePathResolver):
        """Resolver of the files that a .gltf names, relative to its folder; they must be regular too."""

        def get(self, name: str) -> bytes:
            return read_bytes(self.absolute(name), f"file {name} of {path.name}", valid)

    try:
        # a COLLADA file names pictures, which are not opened
        resolver = None if ending == ".dae" else FolderResolver(str(path))
        loaded = trimesh.load_mesh(source, file_type=ending[1:], process=False, resolver=resolver)
        vertices = unit * np.array(loaded.vertices, dtype=np.float64).reshape(-1, 3)
        triangles = np.array(loaded.faces, dtype=np.int64).reshape(-1, 3)
    except Exception as error:  # exceptions of a reader of foreign files are not listed anywhere
        raise InvalidFile(thing, f"{type(error).__name__}: {error}", valid) from error
    if not len(triangles) or not ((triangles >= 0) & (triangles < len(vertices))).all():
        raise InvalidFile(f"triangles of {path.name}", len(triangles), valid)
    return Mesh(path.name, vertices, triangles, np.zeros(len(triangles), dtype=np.int64), welded=ending not in (".stl", ".dae"))
