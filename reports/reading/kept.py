"""Scenes and recordings of a run: the bodies of a scene, and the states that every engine showed in it."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile, InvalidShape
from avatarsim.files import read_json
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere
from runfiles import overlapping, record

Array = NDArray[np.float64]

SCENE_SCHEMA = 1
"""Layout of `scenes/*.json`."""
WANTED = ("positions", "orientations", "velocities", "angular_velocities", "times", "raw_positions", "raw_orientations")
"""Fields of a recording that are read; the others, poses inside frames, are most of it."""
WRITTEN = "the whole file that a run wrote"
PARTS = {"name", "role", "pieces", "mass"}
"""Entries of every body in a scene's file."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A scene's file: see `scenarios.run.run_files`; `parents` is empty where an earlier run did not write them.

    The pieces of its bodies are tuples of `Piece`.
    """

    bodies: Sequence[Mapping[str, Any]]
    gravity: Array
    parents: Sequence[int | None] = ()

    def names_of_links(self, count: int) -> list[str]:
        """Return the names of the last ``count`` bodies, which are the links."""
        return [str(body["name"]) for body in self.bodies[len(self.bodies) - count :]]


@dataclass(frozen=True, eq=False)
class Shown:
    """F+1 states that one engine showed: times (F+1,) [s], poses and velocities (F+1, n, ...) as `runfiles.record` has them,
    raw_* (F+1, L, ...) of the tracker, overlapping pairs (frame, body, body, depth [m])."""

    run: str
    times: Array
    positions: Array
    orientations: Array
    velocities: Array
    angular_velocities: Array
    raw_positions: Array
    raw_orientations: Array
    pairs: Sequence[tuple[int, int, int, float]] = ()


def read_scene(run_dir: Path, scene: str) -> Drawn | None:
    """Read the scene's file; None where the run has none. Raises InvalidFile for one that is damaged or of another layout."""
    path = run_dir / "scenes" / f"{scene}.json"
    if not os.path.exists(path):
        return None
    raw: Any = read_json(path, str(path), WRITTEN)
    try:
        version, bodies, gravity = raw["schema_version"], list(raw["bodies"]), np.array(raw["gravity"], dtype=np.float64)
        parents = list(raw.get("parents", ()))
    except (ValueError, KeyError, TypeError, OverflowError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", WRITTEN) from error
    if version != SCENE_SCHEMA:
        raise InvalidFile(f"schema_version of {path}", version, f"{SCENE_SCHEMA}; run again")
    if gravity.shape != (3,) or not all(isinstance(body, dict) and PARTS <= body.keys() for body in bodies):
        raise InvalidFile(str(path), "gravity or bodies of another layout", WRITTEN)
    if not all(parent is None or (type(parent) is int and 0 <= parent < link) for link, parent in enumerate(parents)):
        raise InvalidFile(f"parents in {path}", parents, "of each link the place of an earlier one, or null")
    try:
        return Drawn([{**body, "pieces": tuple(map(_piece, body["pieces"]))} for body in bodies], gravity, parents)
    except (InvalidShape, ValueError, KeyError, TypeError, OverflowError) as error:
        raise InvalidFile(f"pieces in {path}", f"{type(error).__name__}: {error}", WRITTEN) from error


def _piece(raw: Mapping[str, Any]) -> Piece:
    """Return a piece of a scene's file. Raises InvalidShape, KeyError, TypeError or ValueError for what is none."""
    match raw["kind"]:
        case "sphere":
            shape: Sphere | Capsule | Box | Ellipsoid | ConvexHull = Sphere(raw["radius"])
        case "capsule":
            shape = Capsule(raw["radius"], raw["length"])
        case "box":
            shape = Box(tuple(raw["size"]))
        case "ellipsoid":
            shape = Ellipsoid(tuple(raw["radii"]))
        case _:
            shape = ConvexHull(np.array(raw["vertices"], dtype=np.float64))
    return Piece(shape, tuple(raw["position"]), tuple(raw["orientation"]))


def shown(run_dir: Path, scene: str, runs: Sequence[str], seed: int = 0, model: Drawn | None = None) -> list[Shown]:
    """Read the recordings of ``runs`` (engine/preset) in a scene, where there are any.

    Raises InvalidFile for one that is damaged, has no state or a time that is no number, or other bodies than ``model``.
    """
    recordings = []
    for run in runs:
        stem = f"{scene}.{run.replace('/', '.', 1)}.{seed}"
        path = run_dir / "recordings" / f"{stem}.npz"
        # unlike Path.exists this has an answer for names that no file system takes
        if not os.path.exists(path):
            continue
        stored = record.read(path, WANTED)
        states, bodies = stored["positions"].shape[:2]
        if not states or not np.isfinite(stored["times"]).all():
            raise InvalidFile(f"times in recording {path}", "none, or not all finite", WRITTEN)
        if model is not None and bodies != len(model.bodies):
            raise InvalidFile(f"bodies in recording {path}", bodies, f"{len(model.bodies)}, as the file of the scene has them")
        pairs = overlapping.read(run_dir, stem, states, bodies)
        recordings.append(Shown(run, pairs=pairs, **{name: stored[name] for name in WANTED}))
    return recordings
