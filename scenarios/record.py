"""A recording: everything one engine showed in one scene, and what the user did, as one file."""

import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from scenarios.files import plain, write_whole

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

SCHEMA_VERSION = 1
"""Layout of the file. A reader refuses every other one, so raise it with any change of a field's meaning."""
EVENTS = ("step", "approach", "impact")
"""Names of what a snapshot inside a frame can be (`avatarsim.engine.Snapshot.event`); codes are places in this tuple."""
WIDE = ("inside_positions", "inside_orientations", "inside_velocities", "inside_angular_velocities")
"""The fields that grow with sub-steps times bodies: bodies that never change in them are stored once."""


@dataclass(frozen=True, eq=False)
class Recording:
    """F frames of n bodies and links in canonical order, L links, H hinges, S snapshots inside frames. Row 0 is the first
    state, before any time passes.

    times (F+1,) [s]; positions (F+1, n, 3) [m] and orientations (F+1, n, 4) of body frames; velocities (F+1, n, 3) of centres
    of mass [m/s]; angular_velocities (F+1, n, 3) [rad/s]; angles (F+1, H) [rad], or (F+1, 0) from an engine that gives none.
    raw_*: the tracker's own posture: link frames (F+1, L, 3), (F+1, L, 4), hinge angles (F+1, H).
    inside_*: sub-steps and events in order: time (S,) [s], frame (S,) from 1 to F, event (S,) code in EVENTS, poses, velocities.
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


def save(recording: Recording, path: Path) -> None:
    """Write `recording` to `path`, whole or not at all."""
    arrays: dict[str, NDArray[np.generic]] = {"meta": np.array(_json(recording.meta))}
    for entry in fields(recording):
        value = getattr(recording, entry.name)
        if isinstance(value, Mapping):
            if entry.name != "meta":
                arrays.update({f"{entry.name}:{name}": numbers for name, numbers in value.items()})
        elif entry.name in WIDE and len(value):
            changing = np.flatnonzero(~_same_bits(value))
            # a crowd in which all move is not copied for nothing
            few = len(changing) < value.shape[1]
            if few:
                arrays[f"{entry.name}:first"], arrays[f"{entry.name}:changing"] = value[0], changing
            arrays[entry.name] = value[:, changing] if few else value
        else:
            arrays[entry.name] = value
    write_whole(path, lambda file: np.savez(file, allow_pickle=False, **arrays))


def _json(meta: Mapping[str, object]) -> str:
    """Settings may hold numpy numbers and infinities, so they go through the same door as results.json."""
    return json.dumps(plain({"schema_version": SCHEMA_VERSION, **meta}), allow_nan=False)


def _same_bits(values: Array) -> NDArray[np.bool_]:
    """(n,) True where body n has the same bits in all rows of values (S, n, k); bits, because nan differs from itself."""
    bits = np.ascontiguousarray(values).view(np.int64)
    return np.asarray((bits == bits[:1]).all(axis=(0, 2)))


def load(path: Path) -> Recording:
    """Read a recording. Raises InvalidFile when it is missing, truncated, or of another layout."""
    try:
        # opened here because numpy leaves a file that is no archive open
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            arrays: dict[str, Any] = {name: stored[name] for name in stored.files}
        meta = json.loads(str(arrays.pop("meta")))
        version = meta.pop("schema_version")
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        found = f"{type(error).__name__}: {error}"
        raise InvalidFile(f"recording {path}", found, "a whole .npz file from this runner") from error
    if version != SCHEMA_VERSION:
        raise InvalidFile(f"schema_version of {path}", version, f"{SCHEMA_VERSION}; run again")
    for name in WIDE:
        if f"{name}:first" in arrays:
            first, changing = arrays.pop(f"{name}:first"), arrays.pop(f"{name}:changing")
            wide = np.repeat(first[None], len(arrays[name]), axis=0)
            wide[:, changing] = arrays[name]
            arrays[name] = wide
    named: dict[str, dict[str, Integers]] = {"counts": {}, "statuses": {}}
    for key in [key for key in arrays if ":" in key]:
        kind, name = key.split(":", 1)
        named[kind][name] = arrays.pop(key)
    try:
        return Recording(meta=meta, counts=named["counts"], statuses=named["statuses"], **arrays)
    except TypeError as error:
        raise InvalidFile(f"recording {path}", str(error), "every field of this layout, and no other") from error
