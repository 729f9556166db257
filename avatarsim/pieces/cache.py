"""Answers kept in the user's cache folder, by a hash of everything that shapes them; damage is found and made good.

The folder is chosen as for compiled kernels: XDG_CACHE_HOME, else ~/.cache, else a private temporary folder.
"""

import hashlib
import io
import json
import os
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

from avatarsim.pieces.hausdorff import RESOLUTION, Deviation
from avatarsim.pieces.mesh import Array, Mesh
from avatarsim.pieces.wishes import Wishes

FORMAT = 1
"""Raise it whenever the same mesh and wishes give other pieces than before, or the file looks different."""

MARK = 32
"""Bytes at the start of an entry: the SHA-256 of the rest."""


@dataclass(frozen=True, eq=False)
class Answer:
    """Pieces in the mesh's unit and frame, as they are kept: `hulls` of (n, 3) vertices each."""

    hulls: tuple[Array, ...]
    source: str
    deviation: Deviation
    repairs: tuple[str, ...]


def key_of(mesh: Mesh, wishes: Wishes) -> str:
    """Name of the entry: the mesh's numbers, the wishes, and the versions that shape the answer."""
    try:
        by = version("coacd")
    except PackageNotFoundError:
        by = "none"
    head = {"format": FORMAT, "coacd": by, "resolution": RESOLUTION, "welded": mesh.welded, **asdict(wishes)}
    digest = hashlib.sha256(json.dumps(head, sort_keys=True).encode())
    for array in (mesh.vertices, mesh.triangles, mesh.groups):
        digest.update(str(array.shape).encode() + np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:40]


def load(key: str) -> tuple[Answer | None, str]:
    """The kept answer, if there is one, and a sentence about it."""
    for folder in _folders():
        path = folder / f"{key}.npz"
        try:
            data = path.read_bytes()
        except OSError:
            continue
        answer = _unpacked(data)
        if answer is not None:
            return answer, f"read from {path}"
        return None, f"the entry {path} was damaged and was computed anew"
    return None, ""


def store(key: str, answer: Answer) -> str:
    """Keep an answer where it can be kept; a sentence that says where, or that it could not be."""
    data = _packed(answer)
    for folder in _folders():
        path = folder / f"{key}.npz"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            handle, scratch = tempfile.mkstemp(prefix=f"{key}-", suffix=".part", dir=folder)
        except OSError:
            continue
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
            # readers see the old entry, the new one, or none, and so do two writers at once
            os.replace(scratch, path)
        except OSError:
            Path(scratch).unlink(missing_ok=True)
            continue
        except BaseException:
            Path(scratch).unlink(missing_ok=True)
            raise
        return f"kept in {path}"
    return "not kept: no cache folder can be written to"


def _packed(answer: Answer) -> bytes:
    about = {"source": answer.source, "repairs": answer.repairs, "deviation": asdict(answer.deviation)}
    counts = np.array([len(points) for points in answer.hulls], dtype=np.int64)
    stream = io.BytesIO()
    np.savez_compressed(stream, vertices=np.concatenate(answer.hulls), counts=counts, about=np.array(json.dumps(about)))
    data = stream.getvalue()
    return hashlib.sha256(data).digest() + data


def _unpacked(data: bytes) -> Answer | None:
    """The answer in an entry; None if the entry is not as it was written."""
    if hashlib.sha256(data[MARK:]).digest() != data[:MARK]:
        return None
    try:
        with np.load(io.BytesIO(data[MARK:]), allow_pickle=False) as entry:
            about = json.loads(str(entry["about"]))
            hulls = tuple(np.split(entry["vertices"], np.cumsum(entry["counts"])[:-1]))
        return Answer(hulls, about["source"], Deviation(**about["deviation"]), tuple(about["repairs"]))
    except (ValueError, KeyError, TypeError, OSError, zipfile.BadZipFile):
        return None


def _folders() -> Iterator[Path]:
    """Places for the cache, best first. The shared temporary folder only if nobody else can have written into ours."""
    if os.environ.get("XDG_CACHE_HOME"):
        yield Path(os.environ["XDG_CACHE_HOME"]) / "avatarsim-pieces"
    home = Path(os.path.expanduser("~"))
    if home.is_absolute():
        yield home / ".cache" / "avatarsim-pieces"
    user = os.getuid() if hasattr(os, "getuid") else 0
    shared = Path(tempfile.gettempdir()) / f"avatarsim-pieces-{user}"
    try:
        shared.mkdir(mode=0o700, exist_ok=True)
        if not shared.is_symlink() and shared.stat().st_uid == user and not shared.stat().st_mode & 0o022:
            yield shared
    except OSError:
        pass
