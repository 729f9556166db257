"""Provenance of a run and its plan: code, versions and machine behind its figures, and the jobs that a later command resumes.

The plan is written before anything is measured. A command that resumes a run has to cover all of its plan, and may have
more: other rows would be lost with the results.json that it writes.
"""

import hashlib
import os
import platform
import shlex
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields, is_dataclass
from datetime import UTC, datetime
from enum import Enum
from functools import cache
from pathlib import Path

import numpy as np

from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.files import read_json
from avatarsim.running.sources import PACKAGE, cpu, digest_of, version
from avatarsim.scene.scene import Scene
from avatarsim.version import VERSION
from runfiles.engines import engines
from runfiles.files import plain, write_json
from runfiles.published import MAX_BYTES, SCHEMA_VERSION
from scenarios.job import Job
from scenarios.run.machine import clock, usable_cpus

ROOT = PACKAGE.parent
"""The checkout; of a wheel, in whose package the harness lies, the folder of installed packages."""
CODE = ("avatarsim", "runfiles", "reference", "scenarios")
"""Folders whose files can change a recording; `--resume` keeps no recording of other code."""
PLAN, PLAN_VERSION = "plan.json", 1
"""File of a run's plan, and its layout."""
VALID_PLAN = "one that this version wrote; run again"


def packages() -> tuple[str, ...]:
    """Return the distributions in addition to avatarsim whose versions can change a figure. Raises InvalidFile."""
    return "numpy", "numba", "scipy", *(name for one in engines().values() for name in one.packages), "coal", "python-fcl"


def provenance(command: Sequence[str]) -> dict[str, object]:
    """Return the facts known before a run begins; `seconds` is added at its end."""
    return {
        "command": " ".join(["python -m scenarios", *command]), "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "python": platform.python_version(), "platform": platform.platform(), "cpu": cpu(), "cpus": os.cpu_count() or 1,
        "cpus_usable": usable_cpus(), **clock(), "code": code_hash(), "commit": commit_of(ROOT),
        "versions": {"avatarsim": VERSION, **{name: version(name) for name in packages()}},
    }


@cache
def code_hash() -> str:
    """Return the hash of this project's sources at the first call: of the code that runs."""
    return hash_of_sources(ROOT)


def hash_of_sources(root: Path) -> str:
    """Return sixteen hexadecimal digits of every source file below `root` that can change a recording."""
    return digest_of(root, CODE)


def commit_of(root: Path) -> str | None:
    """Return the hash of the commit that is checked out at `root`; None without a repository or git."""
    if not (root / ".git").exists():
        return None
    try:
        ran = subprocess.run(["git", "rev-parse", "HEAD"], cwd=root, capture_output=True, text=True, check=True, timeout=20.0)
    except (OSError, subprocess.SubprocessError):
        return None
    return ran.stdout.strip() or None


def scene_hash(scene: Scene) -> str:
    """Return sixteen hexadecimal digits of the scene's description; equal scenes have equal hashes everywhere."""
    digest = hashlib.blake2b(digest_size=8)
    _feed(digest, scene)
    return digest.hexdigest()


def _feed(digest: "hashlib.blake2b", value: object) -> None:
    """Feed the type of every part as well as its content, so that no two different scenes look alike."""
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


def earlier_run(folder: Path, command: str) -> Path:
    """Return `folder`, resolved, if it is a run of `command`. Raises InvalidInput or InvalidFile: files are written there."""
    # os.path, since pathlib raises for names that are too long for the system
    if not os.path.isdir(folder):
        raise InvalidInput("--resume", str(folder), "the folder of an earlier run")
    results = _results(folder)
    if results.get("schema_version") != SCHEMA_VERSION:
        raise InvalidFile(f"schema_version of {folder}", results.get("schema_version"), f"{SCHEMA_VERSION}; run again")
    origin = results.get("provenance")
    words = str(origin.get("command", "")).split() if isinstance(origin, dict) else []
    # python -m scenarios COMMAND ...
    wrote = words[3] if words[:3] == ["python", "-m", "scenarios"] and len(words) > 3 else None
    if wrote != command:
        raise InvalidInput("--resume", str(folder), f"a run of the same command, {command}; this one was written by {wrote}")
    return folder.resolve()


def has_ended(folder: Path) -> bool:
    """Return whether a run has come to its end."""
    return _results(folder).get("exit_code") is not None


def _results(folder: Path) -> Mapping[str, object]:
    results = read_json(folder / "results.json", f"results.json of {folder}", "the whole file of a run", MAX_BYTES)
    return results if isinstance(results, dict) else {}


def _described(job: Job) -> Mapping[str, object]:
    """Return all that decides the frames of a job, as JSON holds it."""
    return {str(name): plain(value) for name, value in asdict(job).items()}


def write_plan(folder: Path, words: Sequence[str], jobs: Sequence[Job]) -> None:
    """Write the plan of a run into its folder: the words of its command line, and its jobs."""
    runs = [_described(job) for job in jobs]
    write_json(folder / PLAN, {"schema_version": PLAN_VERSION, "words": list(words), "runs": runs})


def check_plan(folder: Path, jobs: Sequence[Job]) -> None:
    """Raise InvalidInput where the plan of the run in `folder` has a job that is not among `jobs`: its rows would be lost."""
    path = folder / PLAN
    stored = read_json(path, f"plan {path}", VALID_PLAN, MAX_BYTES)
    if not isinstance(stored, dict) or stored.get("schema_version") != PLAN_VERSION or not isinstance(stored.get("words"), list):
        raise InvalidFile(f"plan {path}", "of another layout", VALID_PLAN)
    runs = stored.get("runs")
    if not isinstance(runs, list) or not all(isinstance(run, dict) for run in runs):
        raise InvalidFile(f"runs of plan {path}", "no list of objects", VALID_PLAN)
    planned = [_described(job) for job in jobs]
    if left := [run for run in runs if run not in planned]:
        first = ", ".join(f"{name} {value}" for name, value in left[0].items() if value)
        again = resume_command(folder, [str(word) for word in stored["words"]])
        valid = f"a run whose jobs this command has; {len(left)} are missing, first {first}. `{again}` resumes it"
        raise InvalidInput("--resume", str(folder), valid)


def resume_command(folder: Path, words: Sequence[str]) -> str:
    """Return the command line that resumes the run in `folder`, begun with `words`, quoted for a shell."""
    remaining, skip = list[str](), False
    for word in words:
        if not skip and word != "--resume" and not word.startswith("--resume="):
            remaining.append(word)
        skip = not skip and word == "--resume"
    return shlex.join(["python", "-m", "scenarios", *remaining, "--resume", str(folder)])
