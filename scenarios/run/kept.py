"""The recordings that a run has kept, by scene: what later questions about the run are answered from."""

import math
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from avatarsim.errors import InvalidFile
from runfiles.record import Recording
from scenarios import catalog
from scenarios.scenario import Scenario


def scenes_of(run: Path, who: str, pattern: str = "*") -> list[str]:
    """Names of the scenes that `run` has a recording of by one "engine.preset", seed 0."""
    ending = f".{who}.0.npz"
    names = [path.name.removesuffix(ending) for path in sorted((run / "recordings").glob(f"*{ending}"))]
    return [name for name in names if fnmatchcase(name, pattern)]


def fitting(recording: Recording, path: Path, finite: bool = False) -> Recording:
    """`recording`, which lies at `path`, if it is of the catalogue's scene of its name: as many bodies, links and hinges, and a
    tracker and times that are finite; with `finite` all poses shown too. An engine may show what is no number, and comparisons
    with it pass over that; of the one whose postures are asked about, nothing can be said then. Raises InvalidFile."""
    scene = catalog.get(path.name.split(".")[0]).build()
    bodies, links, hinges = len(scene.names), len(scene.links), scene.first_sample.angles.size
    for name, width, valid in (
        ("positions", recording.positions.shape[1], (bodies,)), ("raw_positions", recording.raw_positions.shape[1], (links,)),
        ("raw_angles", recording.raw_angles.shape[1], (hinges,)), ("angles", recording.angles.shape[1], (0, hinges)),
    ):
        if width not in valid:
            raise InvalidFile(f"width of {name} in recording {path}", width, f"{valid[-1]}, as scene {scene.name} has them")
    if recording.frames < 1:
        raise InvalidFile(f"frames of recording {path}", recording.frames, "1 at least")
    if not _number(recording.meta.get("dt")) > 0.0:
        raise InvalidFile(f"dt in recording {path}", recording.meta.get("dt"), "the length of a frame [s], above 0")
    shown = ("positions", "orientations") if finite else ()
    for name in ("times", "raw_positions", "raw_orientations", "raw_angles", *shown):
        if not np.isfinite(getattr(recording, name)).all():
            raise InvalidFile(f"{name} in recording {path}", "not all finite", "finite numbers")
    return recording


def _number(value: object) -> float:
    """A number of a recording's meta; not a number where it is none, or infinite."""
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else math.nan


def as_recorded(name: str, recording: Recording) -> Scenario:
    """The scenario at the length that was recorded."""
    return catalog.get(name).as_run(bool(recording.meta.get("full")))
