"""Cache of decompositions in the user's cache folder, by content hash of mesh and options; damaged entries are recomputed.

The folder is chosen and trusted as for compiled kernels, and entries are written and checked as for them (`avatarsim/files.py`).
"""

import hashlib
import io
import json
import zipfile
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

from avatarsim.assets.meshes.decompose import PieceOptions
from avatarsim.assets.meshes.hausdorff import RESOLUTION, Deviation
from avatarsim.assets.meshes.mesh import Array, Mesh
from avatarsim.errors import InvalidFile
from avatarsim.files import Damaged, bases, is_readable, is_writable, parsed_json, read_entry, write_entry

NAME = "avatarsim-pieces"
"""Name of the folder of answers wherever it lies."""

FORMAT = 3
"""Version of the entries: raise it when equal mesh and options give other pieces than before, or the layout changes."""

@dataclass(frozen=True, eq=False)
class Answer:
    """Pieces in the mesh's unit and frame, as they are cached: `hulls` of (n, 3) vertices each."""

    hulls: tuple[Array, ...]
    source: str
    deviation: Deviation
    repairs: tuple[str, ...]


def key_of(mesh: Mesh, options: PieceOptions) -> str:
    """Return the content hash that names the entry: of the mesh's numbers, the options, and the versions that affect it."""
    try:
        by = version("coacd")
    except PackageNotFoundError:
        by = "none"
    head = {"format": FORMAT, "coacd": by, "resolution": RESOLUTION, "welded": mesh.welded, **asdict(options)}
    digest = hashlib.sha256(json.dumps(head, sort_keys=True).encode())
    for array in (mesh.vertices, mesh.triangles, mesh.groups):
        digest.update(str(array.shape).encode() + np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:40]


def load(key: str) -> tuple[Answer | None, str]:
    """Return the cached answer, if there is one, and a sentence about it."""
    for folder in filter(is_readable, _folders()):
        path = folder / f"{key}.npz"
        try:
            answer = _decoded(read_entry(path))
        except Damaged:
            return None, f"the entry {path} was damaged and was computed anew"
        except OSError:
            # missing, unreadable, or owned by another user
            continue
        if answer is not None:
            return answer, f"read from {path}"
        return None, f"the entry {path} has another layout and was computed anew"
    return None, ""


def store(key: str, answer: Answer) -> str:
    """Store an answer where possible, and return a sentence with its place, or that it could not be stored."""
    data = _encoded(answer)
    for folder in filter(is_writable, _folders()):
        path = folder / f"{key}.npz"
        try:
            write_entry(path, data)
        except OSError:
            # such as a full disk
            continue
        return f"kept in {path}"
    return "not kept: no cache folder can be written to"


def _encoded(answer: Answer) -> bytes:
    about = {"source": answer.source, "repairs": answer.repairs, "deviation": asdict(answer.deviation)}
    counts = np.array([len(points) for points in answer.hulls], dtype=np.int64)
    stream = io.BytesIO()
    np.savez_compressed(stream, vertices=np.concatenate(answer.hulls), counts=counts, about=np.array(json.dumps(about)))
    return stream.getvalue()


def _decoded(data: bytes) -> Answer | None:
    """Return the answer in an entry; None if its layout is another."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as entry:
            about = parsed_json(str(entry["about"]), "entry", "what this cache wrote")
            hulls = tuple(np.split(entry["vertices"], np.cumsum(entry["counts"])[:-1]))
        return Answer(hulls, about["source"], Deviation(**about["deviation"]), tuple(about["repairs"]))
    except (InvalidFile, ValueError, KeyError, TypeError, OSError, zipfile.BadZipFile):
        return None


def _folders() -> list[Path]:
    """Return folders for the cache, best first."""
    return bases(NAME)
