"""Approximate convex decomposition by CoACD (Wei et al. 2022), in a worker process that ends with its parent.

Options of the convex decomposition, checked for type and range.
"""

import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from avatarsim.assets.meshes.mesh import Array, Mesh
from avatarsim.console import Progress
from avatarsim.errors import InvalidInput, InvalidShape, MissingPackage, UnknownName
from avatarsim.scene.checks import positive, within

REPAIRS = ("auto", "remesh", "refuse")
"""Repairs allowed for surfaces that cannot be mended as they are; `pieces_of_mesh` explains each."""


@dataclass(frozen=True)
class PieceOptions:
    """Options that shape the pieces in addition to the mesh, free of units, so that one cached answer serves every scale."""

    threshold: float = 0.05
    seed: int = 0
    most_vertices: int = 128
    most_pieces: int | None = None
    hull: bool = False
    repair: str = "auto"
    fit: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "threshold", within("threshold of the decomposition", self.threshold, 0.01, 1.0, InvalidInput))
        require_whole_number("seed of the decomposition", self.seed, 0, 2**31 - 1)
        require_whole_number("most vertices of a piece", self.most_vertices, 8, 4096)
        if self.fit is not None:
            object.__setattr__(self, "fit", positive("fit of the pieces", self.fit, InvalidInput))
        if self.most_pieces is not None:
            require_whole_number("most pieces of a mesh", self.most_pieces, 1, 4096)
        if not isinstance(self.hull, bool):
            raise InvalidInput("whether a mesh becomes its hull", self.hull, "True or False")
        if self.repair not in REPAIRS:
            raise UnknownName("repair", self.repair, REPAIRS)


def require_whole_number(thing: str, value: object, low: int, high: int) -> int:
    """Return `value` if it is a whole number from low to high."""
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InvalidInput(thing, value, f"a whole number from {low} to {high}")
    return value


ROOT = Path(__file__).resolve().parents[3]
"""The folder that the package lies in, from which the process can import it."""

REMESH_RESOLUTION = 50
"""CoACD's resolution of a remeshed surface: its cells are about a fiftieth of the mesh. Finer: minutes."""

_POOL = re.compile(r"iter (\d+) ---- waiting pool: (\d+)")
_SHARE = re.compile(r"Processing \[([\d.]+)%\]")


def decomposed(meshes: list[Mesh], options: PieceOptions, remesh: bool, stream: TextIO | None) -> list[Array]:
    """Return vertices (n, 3) of convex hulls that approximate the meshes, in their unit. Equal options give equal bits.

    `remesh` first wraps each surface in a closed one. Raises MissingPackage without coacd, InvalidShape if CoACD fails.
    """
    name = meshes[0].name
    if find_spec("coacd") is None:
        raise MissingPackage("coacd", "assets", f"decomposing {name} into convex pieces")
    used = np.concatenate([mesh.vertices[np.unique(mesh.triangles)] for mesh in meshes])
    middle, size = 0.5 * (used.min(axis=0) + used.max(axis=0)), float(np.linalg.norm(np.ptp(used, axis=0)))
    with tempfile.TemporaryDirectory(prefix="avatarsim-pieces-") as folder:
        source, target = Path(folder) / "wanted.npz", Path(folder) / "found.npz"
        arrays: dict[str, Any] = {}
        for k, mesh in enumerate(meshes):
            # only vertices in use, of size 1 about the origin: then neither the unit nor the place changes a bit
            part = mesh.part(np.ones(len(mesh.triangles), dtype=bool))
            arrays[f"vertices{k}"], arrays[f"triangles{k}"] = (part.vertices - middle) / size, part.triangles
        arrays |= {
            "meshes": len(meshes), "threshold": options.threshold, "seed": options.seed, "remesh": remesh,
            "resolution": REMESH_RESOLUTION, "most": options.most_pieces or -1,
        }
        np.savez(source, **arrays)
        with Progress(f"decomposing {name}", stream) as progress:
            command = [sys.executable, "-m", "avatarsim.assets.meshes.coacd_process", str(source), str(target)]
            output, code = _run(command, len(meshes), progress)
        hulls = []
        if code == 0 and target.is_file():
            with np.load(target, allow_pickle=False) as found:
                hulls = [found[f"hull{k}"] * size + middle for k in range(len(found.files))]
    if not hulls:
        last = output[-1] if output else f"code {code}"
        raise InvalidShape(f"decomposition of {name}", last, "a mesh that CoACD can decompose; try repair='remesh' or hull=True")
    return hulls


def _run(command: list[str], meshes: int, progress: Progress) -> tuple[list[str], int]:
    """Run the worker process to its end, and return its last lines and exit code; Ctrl-C ends it along with this process."""
    # threads that wait without spinning: on a busy machine CoACD otherwise spends most of its time waiting
    calm = {"OMP_WAIT_POLICY": "PASSIVE", **os.environ}
    process = subprocess.Popen(
        command, cwd=ROOT, env=calm, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace"
    )
    output: list[str] = []
    mesh, settled, waiting, share = -1, 0, 1, 0.0
    try:
        assert process.stdout is not None
        for line in process.stdout:
            output = [*output[-5:], line.strip()]
            if line.startswith("mesh "):
                mesh, settled, waiting, share = mesh + 1, 0, 1, 0.0
            elif found := _POOL.search(line):
                settled, waiting, share = settled + waiting, int(found[2]), 0.0
            elif found := _SHARE.search(line):
                share = max(share, float(found[1]) / 100.0)
            # finished parts, of those known so far: cutting a part makes new ones, so the share may step back
            part = (settled + share * waiting) / max(settled + waiting, 1)
            progress.step((max(mesh, 0) + part) / meshes, f"{waiting} parts in this round")
        return output, process.wait()
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        if process.stdout is not None:
            process.stdout.close()
