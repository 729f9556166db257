"""Mesh files of a model: found in its folder, read once, and passed to MuJoCo from memory.

What MuJoCo does not read itself (STL files of text or of more than 200,000 triangles, .ply, .off, .glb, .dae) is read by trimesh.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from avatarsim.assets import caps
from avatarsim.assets.meshes.mesh import BY_TRIMESH, STL_HEADER, STL_TRIANGLE, read_mesh
from avatarsim.assets.models import preflight
from avatarsim.errors import InvalidFile, MissingPackage
from avatarsim.files import read_bytes

BY_MUJOCO = (".msh", ".obj", ".stl")
"""Mesh files that MuJoCo reads."""

CONVERTED = tuple(ending for ending in BY_TRIMESH if ending not in (*BY_MUJOCO, ".gltf"))
"""Formats that are read by trimesh for MuJoCo. A .gltf file would name further files."""

PLATE = 1e-3
"""Thickness given to flat meshes, as a share of their size. Less: the hull's planes are lost in rounding; more: it shows."""

MOST_TRIANGLES = 200_000
"""Triangles of an STL file beyond which MuJoCo refuses it."""


@dataclass
class MeshFiles:
    """The mesh files of one model.

    texts    the model's XML files
    nowhere  the folder of the texts as MuJoCo sees it
    read     called with the number of bytes read so far
    assets   contents of files for MuJoCo, by generated names in place of paths
    plates   names of meshes that were given a thickness"""

    texts: preflight.Texts
    nowhere: str
    read: Callable[[int], None]
    assets: dict[str, bytes] = field(default_factory=dict)
    plates: list[str] = field(default_factory=list)
    _names: dict[Path, str] = field(default_factory=dict)
    _bytes: int = 0

    def attach_meshes(self, spec: Any) -> None:
        """Attach the contents of all meshes. Raises InvalidFile for a missing or invalid mesh or a path leading out."""
        main = PurePosixPath(self.texts.main).parent
        # the folders of the texts of this model, its own first
        bases = list(dict.fromkeys([main, *(PurePosixPath(name).parent for name in self.texts.texts)]))
        # the settings of the compiler are shared between meshes: read before the first one is changed
        for mesh, meshdir in [(mesh, mesh.compiler.meshdir) for mesh in spec.meshes if mesh.file]:
            mesh.name = mesh.name or PurePosixPath(mesh.file).stem
            thing, file = f"mesh {mesh.name} of {self.texts.main}", mesh.file.removeprefix(self.nowhere)
            preflight.require_relative(thing, file)
            # MuJoCo puts the folder of an included text before a name and shortens both: the name as written is tried too
            names = [file, self.texts.meshes.get(mesh.name, file)]
            tried = [path for name in names for path in candidates(name, meshdir, bool(spec.strippath), bases)]
            self._attach(mesh, thing, self._place(thing, file, tried))
            mesh.content_type = mesh.compiler.meshdir = ""
        spec.meshdir, spec.strippath, spec.assets = "", False, self.assets

    def _place(self, thing: str, file: str, tried: list[PurePosixPath]) -> Path:
        """Return the path of the file; of one in a format that is not read, a copy in another format next to it."""
        ending = PurePosixPath(file).suffix.lower()
        if ending in (*BY_MUJOCO, *CONVERTED):
            return preflight.existing(thing, tried, self.texts.folder)[1]
        copies = [path.with_suffix(other) for path in tried for other in (".obj", ".stl", ".STL", *CONVERTED)]
        try:
            return preflight.existing(thing, copies, self.texts.folder)[1]
        except InvalidFile as error:
            formats = " ".join((*BY_MUJOCO, *CONVERTED))
            valid = f"a file {formats}: convert it, and put the copy beside it under the same name"
            raise InvalidFile(thing, file, valid) from error

    def _attach(self, mesh: Any, thing: str, place: Path) -> None:
        if place not in self._names:
            content = read_bytes(place, thing, "a readable mesh file", caps.BYTES - self._bytes)
            self._bytes += len(content)
            self.read(self._bytes)
            ending = place.suffix.lower()
            if ending in CONVERTED or (ending == ".stl" and not is_read_by_mujoco(content)):
                self._by_trimesh(mesh, thing, place)
                return
            self._names[place] = f"{len(self._names)}{ending}"
            self.assets[self._names[place]] = content
        mesh.file = self._names[place]

    def thicken(self, mesh: Any) -> None:
        """Make a plate of a mesh whose vertices lie in one plane, as thick as the share PLATE of its size."""
        self.plates.append(mesh.name)
        place = next((place for place, name in self._names.items() if name == mesh.file), None)
        if place is not None:
            self._by_trimesh(mesh, f"mesh {mesh.name} of {self.texts.main}", place)
        points, triangles = np.array(mesh.uservert).reshape(-1, 3), np.array(mesh.userface).reshape(-1, 3)
        centred = points - points.mean(axis=0)
        across = 0.5 * PLATE * np.ptp(centred, axis=0).max() * np.linalg.svd(centred, full_matrices=False)[2][2]
        mesh.uservert = np.concatenate([points + across, points - across]).ravel()
        mesh.userface = np.concatenate([triangles, triangles[:, ::-1] + len(points)]).ravel()
        mesh.usernormal, mesh.usertexcoord, mesh.userfacenormal, mesh.userfacetexcoord = [], [], [], []

    def _by_trimesh(self, mesh: Any, thing: str, place: Path) -> None:
        try:
            found = read_mesh(place)
        except MissingPackage as error:
            raise InvalidFile(thing, f"{place.name} without trimesh, which reads it", str(error)) from error
        mesh.file, mesh.uservert, mesh.userface = "", found.vertices.ravel(), found.triangles.ravel()


def is_read_by_mujoco(content: bytes) -> bool:
    """Return True if an STL file is binary, whole and not too large for MuJoCo."""
    count = int.from_bytes(content[STL_HEADER - 4 : STL_HEADER], "little")
    return len(content) == STL_HEADER + STL_TRIANGLE * count and count <= MOST_TRIANGLES


def candidates(file: str, meshdir: str, stripped: bool, bases: list[PurePosixPath]) -> list[PurePosixPath]:
    """Return paths below the folder at which a mesh may lie, in the order in which they are tried.
    As MuJoCo would find it, as it is written, and for package://name/rest the rest below each folder above, with and without the
    name. `bases` are the folders of the texts; MuJoCo adds that of an included one to an unknown name, so it is tried without."""
    scheme, mark, rest = file.partition("://")
    path = PurePosixPath((rest if mark else scheme).lstrip("/"))
    found: list[PurePosixPath] = []
    for base in bases:
        if not mark and path.is_relative_to(base) and base.parts:
            found += [one / meshdir / path.relative_to(base) for one in (*bases[:1], base)]
    for base in (*bases, PurePosixPath()):
        if stripped and meshdir:
            found.append(base / meshdir / path.name)
        if not mark:
            found += [base / meshdir / path, base / path]
        else:
            for above in (base, *base.parents):
                found += [above / path, above / PurePosixPath(*path.parts[1:])]
        if stripped:
            found.append(base / meshdir / path.name)
    return list(dict.fromkeys(found))
