"""What a run keeps of a scene beside its figures: what the scene looks like, and what every engine showed in it."""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.files import parsed_json, read_json
from runfiles import array_file
from runfiles.record import arrays_of, misfit

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

SCENE_SCHEMA, RECORDING_SCHEMA = 1, 2
"""Layouts that this reader knows of `scenes/*.json` and `recordings/*.npz`."""
WANTED = ("positions", "orientations", "velocities", "angular_velocities", "times", "raw_positions", "raw_orientations")
"""Members of a recording that are read; the others, poses inside frames, are most of it."""
WHOLE = "a whole .npz file from this runner"
WRITTEN = "the whole file that a run wrote"
PARTS = {"name", "role", "pieces", "mass"}
"""What a scene's file says of every body."""
COUNTED = ("contacts", "iterations", "pairs", "waiting", "planning")
"""Counts per frame that a page shows or tells of, where an engine gives them."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A scene's file: see `scenarios.results.drawn`; `parents` is empty where an earlier run did not write them."""

    bodies: Sequence[Mapping[str, Any]]
    gravity: Array
    parents: Sequence[int | None] = ()

    def names_of_links(self, count: int) -> list[str]:
        """Names of the links, so many, which stand behind all bodies."""
        return [str(body["name"]) for body in self.bodies[len(self.bodies) - count :]] if count else []


@dataclass(frozen=True, eq=False)
class Shown:
    """What one engine showed in F+1 states: times (F+1,) [s], poses and velocities (F+1, n, ...) as `runfiles.record` has them,
    raw_* (F+1, L, ...) of the tracker, counts by name (F+1,), overlapping pairs (frame, body, body, depth [m])."""

    run: str
    times: Array
    positions: Array
    orientations: Array
    velocities: Array
    angular_velocities: Array
    raw_positions: Array
    raw_orientations: Array
    counts: Mapping[str, Integers] = field(default_factory=dict)
    pairs: Sequence[tuple[int, int, int, float]] = ()


def drawn(run_dir: Path, scene: str) -> Drawn | None:
    """The scene's file, None where the run has none. Raises InvalidFile for one that is damaged or of another layout."""
    path = run_dir / "scenes" / f"{scene}.json"
    if not os.path.exists(path):
        return None
    found: Any = read_json(path, str(path), WRITTEN)
    try:
        version, bodies, gravity = found["schema_version"], list(found["bodies"]), np.array(found["gravity"], dtype=np.float64)
        parents = list(found.get("parents", ()))
    except (ValueError, KeyError, TypeError, OverflowError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", WRITTEN) from error
    if version != SCENE_SCHEMA:
        raise InvalidFile(f"schema_version of {path}", version, f"{SCENE_SCHEMA}; run again")
    if gravity.shape != (3,) or not all(isinstance(body, dict) and PARTS <= body.keys() for body in bodies):
        raise InvalidFile(str(path), "gravity or bodies of another layout", WRITTEN)
    if not all(parent is None or (type(parent) is int and 0 <= parent < link) for link, parent in enumerate(parents)):
        raise InvalidFile(f"parents in {path}", parents, "of each link the place of an earlier one, or null")
    return Drawn(bodies, gravity, parents)


def shown(run_dir: Path, scene: str, runs: Sequence[str], seed: int = 0) -> list[Shown]:
    """The recordings of `runs` (engine/preset) in a scene, those that there are. Raises InvalidFile for a damaged one."""
    found = []
    for run in runs:
        stem = f"{scene}.{run.replace('/', '.', 1)}.{seed}"
        path = run_dir / "recordings" / f"{stem}.npz"
        # unlike Path.exists this has an answer for names that no file system takes
        if os.path.exists(path):
            found.append(_shown(path, run, run_dir / "overlaps" / f"{stem}.npz"))
    return found


def _shown(path: Path, run: str, overlaps: Path) -> Shown:
    stored = arrays_of(path, {"meta", *WANTED, *(f"counts:{name}" for name in COUNTED)}.__contains__)
    try:
        version = parsed_json(str(stored["meta"]), f"meta of recording {path}", WHOLE)["schema_version"]
    except (KeyError, TypeError) as error:
        raise InvalidFile(f"recording {path}", f"{type(error).__name__}: {error}", WHOLE) from error
    if version != RECORDING_SCHEMA:
        raise InvalidFile(f"schema_version of {path}", version, f"{RECORDING_SCHEMA}; run again")
    if missing := [name for name in WANTED if name not in stored]:
        raise InvalidFile(f"recording {path}", f"without {', '.join(missing)}", WHOLE)
    counts = {name: stored[f"counts:{name}"] for name in COUNTED if f"counts:{name}" in stored}
    if name := misfit({**stored, "counts": counts}):
        raise InvalidFile(f"{name} in recording {path}", "of another shape or kind", WHOLE)
    pairs = _pairs(overlaps, *stored["positions"].shape[:2])
    return Shown(run, counts=counts, pairs=pairs, **{name: stored[name] for name in WANTED})


def fitting(one: Shown, scene: Drawn | None) -> Shown:
    """`one`, if it has a state at least, at times that are numbers, and as many bodies as the scene's file; else InvalidFile."""
    if not len(one.times) or not np.isfinite(one.times).all():
        raise InvalidFile(f"times in the recording of {one.run}", "none, or not all finite", WHOLE)
    if scene is not None and one.positions.shape[1] != len(scene.bodies):
        valid = f"{len(scene.bodies)}, as the file of the scene has them"
        raise InvalidFile(f"bodies in the recording of {one.run}", one.positions.shape[1], valid)
    return one


def _pairs(path: Path, states: int, bodies: int) -> list[tuple[int, int, int, float]]:
    """Overlapping pairs of so many states shown of so many bodies and links."""
    if not os.path.exists(path):
        return []
    stored = array_file.read(path)
    for name, kind, most in (("frame", "i", states), ("first", "i", bodies), ("second", "i", bodies), ("depth", "f", math.inf)):
        found = stored.get(name)
        if found is None or found.dtype.kind != kind or found.shape != (stored["frame"].size,):
            raise InvalidFile(f"{name} in {path}", "missing, or of another shape or kind", WHOLE)
        if found.size and not 0 <= found.min() <= found.max() < most:
            raise InvalidFile(f"{name} in {path}", found.max(), f"from 0 to below {most}")
    columns = [stored[name].tolist() for name in ("frame", "first", "second", "depth")]
    return list(zip(*columns, strict=True))
