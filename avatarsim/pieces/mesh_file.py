"""Meshes from files. OBJ is read here, the other formats by trimesh: this is the one file that imports it."""

from pathlib import Path

import numpy as np

from avatarsim.errors import InvalidFile, MissingPackage
from avatarsim.pieces.mesh import Mesh
from avatarsim.pieces.obj_file import read_obj

BY_TRIMESH = (".glb", ".gltf", ".off", ".ply", ".stl")
"""What trimesh reads without further packages. Scenes of several meshes become one mesh."""


def read_mesh(path: str | Path) -> Mesh:
    """The mesh of a file, its format told by the ending of its name.

    Raises InvalidFile (missing, unknown format, broken, without a triangle); MissingPackage without trimesh.
    """
    path = Path(path)
    if not path.is_file():
        raise InvalidFile("mesh file", str(path), "the path of an existing file")
    ending = path.suffix.lower()
    if ending == ".obj":
        return read_obj(path)
    if ending not in BY_TRIMESH:
        raise InvalidFile(f"format of {path.name}", ending, "one of .obj " + " ".join(BY_TRIMESH))
    return _by_trimesh(path, ending)


def _by_trimesh(path: Path, ending: str) -> Mesh:
    try:
        import trimesh
    except ImportError as error:
        raise MissingPackage("trimesh", "assets", f"reading {ending} meshes") from error
    valid = f"a whole {ending} file with at least one triangle"
    try:
        # by its path, since a .gltf names further files beside it
        loaded = trimesh.load_mesh(str(path), file_type=ending[1:], process=False)
        vertices = np.array(loaded.vertices, dtype=np.float64).reshape(-1, 3)
        triangles = np.array(loaded.faces, dtype=np.int64).reshape(-1, 3)
    except Exception as error:  # what a reader of foreign files raises on a broken one is not listed anywhere
        raise InvalidFile(f"mesh {path.name}", f"{type(error).__name__}: {error}", valid) from error
    if not len(triangles) or not ((triangles >= 0) & (triangles < len(vertices))).all():
        raise InvalidFile(f"triangles of {path.name}", len(triangles), valid)
    return Mesh(path.name, vertices, triangles, np.zeros(len(triangles), dtype=np.int64), welded=ending != ".stl")
