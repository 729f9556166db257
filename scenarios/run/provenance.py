"""Provenance of figures: versions, machine, command, and hashes of the scenes they are about."""

import hashlib
import os
import platform
import subprocess
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from datetime import UTC, datetime
from enum import Enum
from functools import cache
from pathlib import Path

import numpy as np

from avatarsim.running.sources import cpu, digest_of, version
from avatarsim.scene.scene import Scene
from avatarsim.version import VERSION
from runfiles.engines import engines
from scenarios.run.machine import clock, usable_cpus

PACKAGES = tuple(dict.fromkeys([
    "numpy", "numba", "scipy", *(name for one in engines().values() for name in one.packages), "coal", "python-fcl",
]))
"""Distributions beside our own, which runs uninstalled too, whose versions can change a figure."""

ROOT = Path(__file__).resolve().parents[2]
CODE = ("avatarsim", "runfiles", "reference", "scenarios")
"""Folders whose files decide what an engine shows in a scene. Recordings made by other code are not kept by `--resume`."""


def provenance(command: list[str]) -> dict[str, object]:
    """What is known before a run begins; `seconds` is added at its end."""
    return {
        "command": " ".join(["python -m scenarios", *command]),
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "cpu": cpu(),
        "cpus": os.cpu_count() or 1,
        "cpus_usable": usable_cpus(),
        **clock(),
        "code": code_hash(),
        "commit": commit_of(ROOT),
        "versions": {"avatarsim": VERSION, **{name: version(name) for name in PACKAGES}},
    }


@cache
def code_hash() -> str:
    """`hash_of_sources` of this project, as it was when first asked for: what runs is what was read then."""
    return hash_of_sources(ROOT)


def commit_of(root: Path) -> str | None:
    """Hash of the commit that is checked out at `root`; None where that is no repository, or git is missing."""
    if not (root / ".git").exists():
        return None
    try:
        said = subprocess.run(["git", "rev-parse", "HEAD"], cwd=root, capture_output=True, text=True, check=True, timeout=20.0)
    except (OSError, subprocess.SubprocessError):
        return None
    return said.stdout.strip() or None


def hash_of_sources(root: Path) -> str:
    """Sixteen hexadecimal digits of every source file below `root` that can change what is recorded."""
    return digest_of(root, CODE)


def scene_hash(scene: Scene) -> str:
    """Sixteen hexadecimal digits of everything in the scene's description; equal scenes give equal hashes everywhere."""
    digest = hashlib.blake2b(digest_size=8)
    _feed(digest, scene)
    return digest.hexdigest()


def _feed(digest: "hashlib.blake2b", value: object) -> None:
    """Feed the kind of every part as well as its content, so that no two different scenes look alike."""
    digest.update(f"<{type(value).__name__}>".encode())
    if isinstance(value, np.ndarray):
        digest.update(repr(value.shape).encode() + np.ascontiguousarray(value).tobytes())
    elif is_dataclass(value) and not isinstance(value, type):
        for entry in fields(value):
            digest.update(entry.name.encode())
            _feed(digest, getattr(value, entry.name))
    elif isinstance(value, Enum):
        digest.update(value.name.encode())
    elif isinstance(value, Mapping):
        for key in sorted(value):
            _feed(digest, key)
            _feed(digest, value[key])
    elif isinstance(value, list | tuple):
        digest.update(f"{len(value)}".encode())
        for item in value:
            _feed(digest, item)
    else:
        digest.update(repr(value).encode())
