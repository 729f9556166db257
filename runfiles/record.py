"""A recording: everything one engine showed in one scene, and what the user did, as one file, or as one beside the user's motion,
which is the same in all recordings of a scene: a run keeps it once, under a name that follows from its bytes."""

import hashlib
import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.files import parsed_json
from runfiles import array_file
from runfiles.files import plain, write_whole

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

SCHEMA_VERSION = 2
"""Layout of the file. A reader refuses every other one, so raise it with any change of a field's meaning."""
EVENTS = ("step", "approach", "impact")
"""Names of what a snapshot inside a frame can be (`avatarsim.engine.Snapshot.event`); codes are places in this tuple."""
MOTIONS = "motions"
"""Where users' motions lie in a run's folder, named by MOTION."""
MOTION = "motion"
"""The array of a recording that names the file of its user's motion, in place of OF_USER."""
OF_USER = ("raw_positions", "raw_orientations", "raw_angles")
"""The fields that are the user's motion."""
COUNTED = ("counts", "statuses")
"""The fields that hold numbers of frames by name."""
LAYOUT: Mapping[str, tuple[str | int, ...]] = {
    "times": ("f8", "states"),
    "positions": ("f8", "states", "bodies", 3),
    "orientations": ("f8", "states", "bodies", 4),
    "velocities": ("f8", "states", "bodies", 3),
    "angular_velocities": ("f8", "states", "bodies", 3),
    "angles": ("f8", "states", "angles"),
    "raw_positions": ("f8", "states", "links", 3),
    "raw_orientations": ("f8", "states", "links", 4),
    "raw_angles": ("f8", "states", "hinges"),
    "inside_time": ("f8", "snapshots"),
    "inside_frame": ("i8", "snapshots"),
    "inside_event": ("i8", "snapshots"),
    "inside_positions": ("f8", "snapshots", "bodies", 3),
    "inside_orientations": ("f8", "snapshots", "bodies", 4),
    "inside_velocities": ("f8", "snapshots", "bodies", 3),
    "inside_angular_velocities": ("f8", "snapshots", "bodies", 3),
    "state_hashes": ("U", "states"),
    "counted": ("i8", "states"),
    "overlap": ("f8", "states"),
    "frame_times_ns": ("i8", "repeats", "frames"),
}
"""Kind of number and axes of every field, and of every array in COUNTED; axes of one name are equally long."""


@dataclass(frozen=True, eq=False)
class Recording:
    """F frames of n bodies and links in canonical order, L links, H hinges, S snapshots inside frames. Row 0 is the first
    state, before any time passes.

    times (F+1,) [s]; positions (F+1, n, 3) [m] and orientations (F+1, n, 4) of body frames; velocities (F+1, n, 3) of centres
    of mass [m/s]; angular_velocities (F+1, n, 3) [rad/s]; angles (F+1, H) [rad], or (F+1, 0) from an engine that gives none.
    raw_*: the tracker's own posture: link frames (F+1, L, 3), (F+1, L, 4), hinge angles (F+1, H).
    inside_*: sub-steps and events in order: time (S,) [s], frame (S,) from 1 to F, event (S,) code in EVENTS, poses, velocities;
    all of them while it is measured, those of `scenarios.results.thinned` in the file of a run.
    Quaternions do not change their sign from row to row; `state_hashes` are of those that the engine gave.
    overlap (F+1,) [m] of every state shown, as the run judged it; empty where it was not judged.
    counts, statuses: (F+1,) per name. state_hashes (F+1,). frame_times_ns (repeats, frames), empty before the timing pass.
    meta: scene, engine, version, preset, seed, dt, settings, cannot_say, scene_hash, error (why it ended early, or absent).
    """

    meta: Mapping[str, object]
    times: Array
    positions: Array
    orientations: Array
    velocities: Array
    angular_velocities: Array
    angles: Array
    raw_positions: Array
    raw_orientations: Array
    raw_angles: Array
    inside_time: Array
    inside_frame: Integers
    inside_event: Integers
    inside_positions: Array
    inside_orientations: Array
    inside_velocities: Array
    inside_angular_velocities: Array
    state_hashes: NDArray[np.str_]
    counts: Mapping[str, Integers] = field(default_factory=dict)
    statuses: Mapping[str, Integers] = field(default_factory=dict)
    frame_times_ns: Integers = field(default_factory=lambda: np.zeros((0, 0), dtype=np.int64))
    overlap: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def frames(self) -> int:
        """Number F of frames advanced."""
        return len(self.times) - 1

    @property
    def links(self) -> slice:
        """Where the links are among the n bodies and links."""
        n = self.positions.shape[1]
        return slice(n - self.raw_positions.shape[1], n)

    @property
    def dt(self) -> float:
        """Length of a frame [s]."""
        return float(str(self.meta["dt"]))


def save(recording: Recording, path: Path, motions: Path | None = None) -> None:
    """Write `recording` to `path`, whole or not at all; its user's motion into the folder `motions`, if there is one."""
    arrays: dict[str, NDArray[np.generic]] = {"meta": np.array(_json(recording.meta))}
    for entry in fields(recording):
        value = getattr(recording, entry.name)
        if not isinstance(value, Mapping):
            arrays[entry.name] = value
        elif entry.name != "meta":
            arrays.update({f"{entry.name}:{name}": numbers for name, numbers in value.items()})
    if motions is not None:
        moved = {name: arrays.pop(name) for name in OF_USER}
        digest = _digest(moved)
        arrays[MOTION] = np.array(digest)
        write_whole(motions / f"{digest}.npz", lambda file: array_file.write(file, moved))
    write_whole(path, lambda file: array_file.write(file, arrays))


def _digest(moved: Mapping[str, NDArray[np.generic]]) -> str:
    """The name of a user's motion: equal for equal arrays."""
    found = hashlib.sha256()
    for name in OF_USER:
        found.update(f"{name} {moved[name].dtype.str} {moved[name].shape}".encode())
        found.update(np.ascontiguousarray(moved[name]).tobytes())
    return found.hexdigest()[:32]


def arrays_of(path: Path, wanted: Callable[[str], bool] = lambda name: True) -> dict[str, NDArray[Any]]:
    """The arrays of a recording whose name is `wanted`, its user's motion among them wherever it is kept. Raises InvalidFile for
    one that is missing, damaged or too large, and where the motion's file is."""
    arrays = array_file.read(path, lambda name: name == MOTION or wanted(name))
    if (named := arrays.pop(MOTION, None)) is None:
        return arrays
    if not re.fullmatch(r"[0-9a-f]{32}", str(named)):
        raise InvalidFile(f"{MOTION} of recording {path}", str(named)[:64], "32 hexadecimal digits")
    beside = path.parent.parent / MOTIONS / f"{named}.npz"
    moved = array_file.read(beside)
    if moved.keys() != set(OF_USER) or _digest(moved) != str(named):
        raise InvalidFile(f"the user's motion in {beside}", "another one than its name says", "the whole file that a run wrote")
    return arrays | {name: array for name, array in moved.items() if wanted(name)}


def _json(meta: Mapping[str, object]) -> str:
    """Settings may hold numpy numbers and infinities, so they go through the same door as results.json."""
    return json.dumps(plain({"schema_version": SCHEMA_VERSION, **meta}), allow_nan=False)


def load(path: Path) -> Recording:
    """Read a recording. Raises InvalidFile when it is missing, truncated, too large, or of another layout."""
    arrays = arrays_of(path)
    meta, version = about(arrays.pop("meta", None), path)
    if version != SCHEMA_VERSION:
        raise InvalidFile(f"schema_version of {path}", version, f"{SCHEMA_VERSION}; run again")
    named: dict[str, dict[str, Integers]] = {name: {} for name in COUNTED}
    for key in [key for key in arrays if key.split(":", 1)[0] in named]:
        kind, name = key.split(":", 1)
        named[kind][name] = arrays.pop(key)
    try:
        recording = Recording(meta=meta, counts=named["counts"], statuses=named["statuses"], **arrays)
    except TypeError as error:
        raise InvalidFile(f"recording {path}", str(error), "every field of this layout, and no other") from error
    if name := misfit({entry.name: getattr(recording, entry.name) for entry in fields(recording)}) or _beyond(recording):
        raise InvalidFile(f"{name} in recording {path}", "of another shape or kind", "what fits the rest, as `Recording` says")
    return recording


def about(stored: NDArray[np.str_] | None, path: Path) -> tuple[dict[str, object], object]:
    """A recording's meta, and the version of the layout."""
    try:
        meta = parsed_json(str(stored), f"meta of recording {path}", "what this runner wrote")
        return meta, meta.pop("schema_version")
    except (KeyError, AttributeError, TypeError) as error:
        raise InvalidFile(f"meta of recording {path}", f"{type(error).__name__}: {error}", "what this runner wrote") from error


def misfit(arrays: Mapping[str, Any]) -> str:
    """The first of a recording's fields that contradicts LAYOUT or those before it; empty if there is none. What is no field is
    passed over, and so is an empty `overlap`."""
    sizes: dict[str, int] = {}
    counted = [numbers for name in COUNTED for numbers in arrays.get(name, {}).values()]
    for name, (kind, *axes) in LAYOUT.items():
        for found in counted if name == "counted" else [arrays[name]] if name in arrays else []:
            if name == "overlap" and found.size == 0:
                continue
            expected = tuple(
                sizes.setdefault(axis, size) if isinstance(axis, str) else axis
                for axis, size in zip(axes, found.shape, strict=False)
            )
            if not found.dtype.str[1:].startswith(kind) or found.ndim != len(axes) or found.shape != expected:
                return name
    return ""


def _beyond(recording: Recording) -> str:
    """The field of snapshots that names a frame or an event that there is not; empty if neither does."""
    for name, most in (("inside_frame", recording.frames), ("inside_event", len(EVENTS) - 1)):
        found = getattr(recording, name)
        if found.size and not 0 <= found.min() <= found.max() <= most:
            return name
    return ""
