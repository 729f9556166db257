"""A recording: the output of one engine in one scene, and the user's motion, as one file, or as two, since that motion is the
same in all recordings of a scene: a run keeps it once, under a name that follows from its bytes."""

import hashlib
import json
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import MISSING, dataclass, field, fields
from pathlib import Path
from typing import Annotated, Any, get_type_hints

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
WHOLE = "the whole file that a run wrote"
EVENTS = ("step", "approach", "impact")
"""Kinds of a snapshot inside a frame (`avatarsim.engine.Snapshot.event`); codes are places in this tuple."""
MOTIONS = "motions"
"""Where users' motions lie in a run's folder, named by MOTION."""
MOTION = "motion"
"""The array of a recording that names the file of its user's motion, in place of OF_USER."""
OF_USER = ("raw_positions", "raw_orientations", "raw_angles")
"""The fields that are the user's motion."""
COUNTED = ("counts", "statuses")
"""The fields that hold numbers of frames by name."""

Vectors = Annotated[Array, "f8", "states", "bodies", 3]
Inside = Annotated[Array, "f8", "snapshots", "bodies", 3]
Codes = Annotated[Integers, "i8", "snapshots"]
PerState = Annotated[Mapping[str, Integers], "i8", "states"]


@dataclass(frozen=True, eq=False)
class Recording:
    """F frames of n bodies and links in canonical order, L links, H hinges, S snapshots inside frames. Row 0 is the first
    state, before any time passes.

    times (F+1,) [s]; positions (F+1, n, 3) [m] and orientations (F+1, n, 4) of body frames; velocities (F+1, n, 3) of centres
    of mass [m/s]; angular_velocities (F+1, n, 3) [rad/s]; angles (F+1, H) [rad], or (F+1, 0) from an engine that gives none.
    raw_*: the tracker's own posture: link frames (F+1, L, 3), (F+1, L, 4), hinge angles (F+1, H).
    inside_*: sub-steps and events in order: time (S,) [s], frame (S,) from 1 to F, event (S,) code in EVENTS, poses, velocities;
    all of them while it is measured, those of `scenarios.run.run_files` in the file of a run.
    Quaternions do not change their sign from row to row; `state_hashes` are of those that the engine gave.
    overlap (F+1,) [m] of every state shown, as the run judged it; empty where it was not judged.
    counts, statuses: (F+1,) per name. state_hashes (F+1,). frame_times_ns (repeats, frames), empty before the timing pass.
    Annotations have the kind of number and the axes of every array; axes of one name are equally long.
    meta: scene, engine, version, preset, seed, dt, settings, unsupported, scene_hash, error (why it ended early, or absent).
    """

    meta: Mapping[str, object]
    times: Annotated[Array, "f8", "states"]
    positions: Vectors
    orientations: Annotated[Array, "f8", "states", "bodies", 4]
    velocities: Vectors
    angular_velocities: Vectors
    angles: Annotated[Array, "f8", "states", "angles"]
    raw_positions: Annotated[Array, "f8", "states", "links", 3]
    raw_orientations: Annotated[Array, "f8", "states", "links", 4]
    raw_angles: Annotated[Array, "f8", "states", "hinges"]
    inside_time: Annotated[Array, "f8", "snapshots"]
    inside_frame: Codes
    inside_event: Codes
    inside_positions: Inside
    inside_orientations: Annotated[Array, "f8", "snapshots", "bodies", 4]
    inside_velocities: Inside
    inside_angular_velocities: Inside
    state_hashes: Annotated[NDArray[np.str_], "U", "states"]
    counts: PerState = field(default_factory=dict)
    statuses: PerState = field(default_factory=dict)
    frame_times_ns: Annotated[Integers, "i8", "repeats", "frames"] = field(
        default_factory=lambda: np.zeros((0, 0), dtype=np.int64)
    )
    overlap: Annotated[Array, "f8", "states"] = field(default_factory=lambda: np.zeros(0))

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
    meta = json.dumps(plain({"schema_version": SCHEMA_VERSION, **recording.meta}), allow_nan=False)
    arrays: dict[str, NDArray[np.generic]] = {"meta": np.array(meta)}
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
    digest = hashlib.sha256()
    for name in OF_USER:
        digest.update(f"{name} {moved[name].dtype.str} {moved[name].shape}".encode())
        digest.update(np.ascontiguousarray(moved[name]).tobytes())
    return digest.hexdigest()[:32]


def read(path: Path, names: Collection[str] | None = None) -> dict[str, Any]:
    """Read fields of a recording by name, wherever its user's motion is stored.

    Args:
        path: of the file.
        names: fields to read; all without it.

    Raises:
        InvalidFile: for a file that is missing, damaged, too large or of another layout, and where the motion's file is.
    """
    stored = _arrays(path, lambda key: names is None or key == "meta" or key.partition(":")[0] in names)
    try:
        meta = parsed_json(str(stored.pop("meta", None)), f"meta of recording {path}", WHOLE)
        version = meta.pop("schema_version")
    except (KeyError, AttributeError, TypeError) as error:
        raise InvalidFile(f"meta of recording {path}", f"{type(error).__name__}: {error}", WHOLE) from error
    if version != SCHEMA_VERSION:
        raise InvalidFile(f"schema_version of {path}", version, f"{SCHEMA_VERSION}; run again")
    values: dict[str, Any] = {"meta": meta}
    for key, array in stored.items():
        kind, counts, name = key.partition(":")
        values |= {kind: values.get(kind, {}) | {name: array}} if counts and kind in COUNTED else {key: array}
    known = {entry.name: entry.default is MISSING and entry.default_factory is MISSING for entry in fields(Recording)}
    needed = {name for name, always in known.items() if always} if names is None else {*names}
    if wrong := sorted((needed - values.keys()) | (values.keys() - known.keys())):
        raise InvalidFile(f"recording {path}", f"lacks or adds {', '.join(wrong)}", "every field of this layout, and no other")
    if name := _misfit(values):
        raise InvalidFile(f"{name} in recording {path}", "of another shape or kind", "a fit to the rest, as in `Recording`")
    return values


def load(path: Path) -> Recording:
    """Read a whole recording. Raises InvalidFile as `read`."""
    return Recording(**read(path))


def _arrays(path: Path, wanted: Callable[[str], bool]) -> dict[str, NDArray[Any]]:
    """Return the arrays of a recording whose name is `wanted`, with those of its user's motion. Raises InvalidFile."""
    arrays = array_file.read(path, lambda name: name == MOTION or wanted(name))
    if (named := arrays.pop(MOTION, None)) is None:
        return arrays
    if not re.fullmatch(r"[0-9a-f]{32}", str(named)):
        raise InvalidFile(f"{MOTION} of recording {path}", str(named)[:64], "32 hexadecimal digits")
    motion = path.parent.parent / MOTIONS / f"{named}.npz"
    moved = array_file.read(motion)
    if moved.keys() != set(OF_USER) or _digest(moved) != str(named):
        raise InvalidFile(f"the user's motion in {motion}", "another motion than that of its name", WHOLE)
    return arrays | {name: array for name, array in moved.items() if wanted(name)}


def _misfit(values: Mapping[str, Any]) -> str:
    """Return the first field that contradicts its annotation or those before it, "" without one; an empty `overlap` fits."""
    sizes: dict[str, int] = {}
    for name, hint in get_type_hints(Recording, include_extras=True).items():
        kind, *axes = getattr(hint, "__metadata__", ("",))
        for array in values.get(name, {}).values() if name in COUNTED else [values[name]] if kind and name in values else []:
            if name == "overlap" and array.size == 0:
                continue
            shape = tuple(
                sizes.setdefault(axis, size) if isinstance(axis, str) else axis
                for axis, size in zip(axes, array.shape, strict=False)
            )
            if not array.dtype.str[1:].startswith(kind) or array.ndim != len(axes) or array.shape != shape:
                return name
    # snapshots name frames and events that there are
    most = {"inside_frame": sizes.get("states", 1) - 1, "inside_event": len(EVENTS) - 1}
    for name in most.keys() & values.keys():
        if values[name].size and not 0 <= values[name].min() <= values[name].max() <= most[name]:
            return name
    return ""
