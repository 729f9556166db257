"""Meshes from files. OBJ is read here, the other formats by trimesh: this is the one file that imports it."""

import io
from os.path import exists
from pathlib import Path

import numpy as np

from avatarsim.errors import InvalidFile, MissingPackage
from avatarsim.pieces.mesh import Mesh
from avatarsim.pieces.obj_file import read_obj
from avatarsim.regular_file import check, read_bytes

BY_TRIMESH = (".glb", ".gltf", ".off", ".ply", ".stl")
"""What trimesh reads without further packages. Scenes of several meshes become one mesh."""


def read_mesh(path: str | Path) -> Mesh:
    """The mesh of a file, its format told by the ending of its name.

    Raises InvalidFile (missing, unknown format, broken, without a triangle); MissingPackage without trimesh.
    """
    path = Path(path)
    # by os.path, which takes names that are too long for the system as names of nothing
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


def whole_stl(name: str, content: bytes) -> bytes:
    """The content of an STL file; text, in which a name may be of any encoding, as UTF-8. Raises InvalidFile where it is cut off:
    trimesh takes a binary file of a wrong length for text, and of a text without end the solids before."""
    size, count = len(content), int.from_bytes(content[STL_HEADER - 4 : STL_HEADER], "little")
    if size >= STL_HEADER and size == STL_HEADER + STL_TRIANGLE * count:
        return content
    words = content.lower().split()
    if words[:1] == [b"solid"] and b"facet" in words:
        # a name may follow the last word
        if b"endsolid" not in words or b"facet" in words[len(words) - words[::-1].index(b"endsolid") :]:
            raise InvalidFile(f"end of {name}", "cut off within a solid", "endsolid, as the end of STL text")
        return content.decode("utf-8", "replace").encode()
    if size < STL_HEADER:
        raise InvalidFile(f"length of {name} [bytes]", size, f"{STL_HEADER} at least in binary STL; text begins with solid")
    valid = f"{STL_HEADER + STL_TRIANGLE * count}, for the {count} triangles that its header announces"
    raise InvalidFile(f"length of {name} [bytes]", size, valid)


def _by_trimesh(path: Path, ending: str) -> Mesh:
    try:
        import trimesh
    except ImportError as error:
        raise MissingPackage("trimesh", "assets", f"reading {ending} meshes") from error
    valid = f"a whole {ending} file with at least one triangle"
    thing = f"mesh {path.name}"
    check(path, thing, valid)
    source = io.BytesIO(whole_stl(path.name, read_bytes(path, thing, valid))) if ending == ".stl" else str(path)

    class Beside(trimesh.resolvers.FilePathResolver):
        """The files beside a .gltf that it names: regular ones too."""

        def get(self, name: str) -> bytes:
            return read_bytes(self.absolute(name), f"file {name} of {path.name}", valid)

    try:
        loaded = trimesh.load_mesh(source, file_type=ending[1:], process=False, resolver=Beside(str(path)))
        vertices = np.array(loaded.vertices, dtype=np.float64).reshape(-1, 3)
        triangles = np.array(loaded.faces, dtype=np.int64).reshape(-1, 3)
    except Exception as error:  # what a reader of foreign files raises on a broken one is not listed anywhere
        raise InvalidFile(thing, f"{type(error).__name__}: {error}", valid) from error
    if not len(triangles) or not ((triangles >= 0) & (triangles < len(vertices))).all():
        raise InvalidFile(f"triangles of {path.name}", len(triangles), valid)
    return Mesh(path.name, vertices, triangles, np.zeros(len(triangles), dtype=np.int64), welded=ending != ".stl")
