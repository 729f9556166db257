"""Robot trajectories: rows of generalized coordinates (root position, quaternion, joints), in NumPy archives and tables of text.

Archives are recognised by their entries: `qpos` or `joint_pos` whole (MuJoCo, holosoma), root and joints apart (`root_pos`,
`root_rot`, `dof_pos` of GMR), or joints and poses of bodies, the first of which is the root (Isaac Lab). A written file has the
original entries, types and order.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from avatarsim.assets import caps
from avatarsim.assets.models.coordinates import Coordinates
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions import derived, matching
from avatarsim.assets.motions.archive import AnyArray, Archive, npz_bytes
from avatarsim.assets.motions.frame_times import restated, times_of
from avatarsim.assets.motions.motion_file import Notes
from avatarsim.assets.motions.object_poses import at_times, object_note, object_of
from avatarsim.errors import InvalidFile
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array

WHOLE = ("qpos", "joint_pos")
"""Entries that may contain root and joints together."""

ROOT_PLACES, ROOT_TURNS = ("root_pos", "root_trans", "root_translation"), ("root_rot", "root_quat", "root_ori")
JOINTS = ("dof_pos", "dof_positions", "joint_pos", "dof")
"""Entries that contain root and joints apart."""

JOINT_NAMES = ("joint_names", "dof_names")

KEYS = (*WHOLE, *JOINTS)
"""Entries that identify an archive as a trajectory."""


class Store(Protocol):
    """The file around the table of a trajectory."""

    def written(self, changed: "Changed") -> bytes:
        """Return the file with another table."""


@dataclass(frozen=True, eq=False)
class Changed:
    """Changes to write: the table (F, width) before and now, both as motions of the model's avatar, and which of the
    frames `stayed` (F,) as they were; None where the instants are others."""

    model: Model
    before: Motion
    after: Motion
    was: Array
    now: Array
    stayed: Array | None

    @property
    def nothing(self) -> bool:
        """Return True if all is unchanged."""
        return self.stayed is not None and bool(self.stayed.all())


@dataclass(frozen=True, eq=False)
class Trajectory(Notes):
    """A file of rows of generalized coordinates: a MotionFile. times (F,) [s]; table (F, width) in the file's own order."""

    name: str
    format: str
    times: Array
    table: Array
    layout: matching.Layout
    store: Store

    def motion(self, model: Model) -> Motion:
        """Return the motion for this model's avatar; InvalidFile where its joints do not fit, by name."""
        coordinates = matching.coordinates_of_model(self.name, model)
        caps.require_frames(self.name, len(self.times), coordinates.links)
        found = self._motion(coordinates)
        alone = matching.left_alone(self.layout, coordinates)
        if alone:
            self.note(f"{self.name}: left as they are, since the avatar has no such joints: {matching.shortened(alone)}")
        if self.layout.joints is None:
            self.note(f"{self.name}: {matching.by_order(coordinates)}; joints= says names for another order")
        return found

    def _columns(self, coordinates: Coordinates) -> matching.Columns:
        return matching.columns(self.name, self.layout, self.table.shape[1], coordinates)

    def _motion(self, coordinates: Coordinates) -> Motion:
        return matching.motion_of(self.name, matching.columns_of(self.table, self._columns(coordinates)), self.times, coordinates)

    def written(self, motion: Motion, model: Model) -> bytes:
        """Return the file with this motion. Unchanged frames keep the file's own numbers, to the bit."""
        coordinates = matching.coordinates_of_model(self.name, model)
        columns, before = self._columns(coordinates), self._motion(coordinates)
        same_times = len(motion) == len(before) and bool((motion.times == before.times).all())
        near = matching.columns_of(self.table, columns) if same_times else None
        if same_times:
            now = self.table.copy()
        else:
            now = np.stack([np.interp(motion.times, self.times, column) for column in self.table.T], axis=1)
        stayed = (coordinates.rows(motion) == coordinates.rows(before)).all(axis=1) if same_times else None
        moved = columns >= 0
        now[:, columns[moved]] = matching.rows_near(motion, coordinates, near, stayed)[:, moved]
        if stayed is not None:
            now[stayed] = self.table[stayed]
        return self.store.written(Changed(model, before, motion, self.table, now, stayed))


@dataclass(frozen=True)
class Part:
    """Columns `first` up to `end` of a table that lie in an entry; of an entry of bodies, in one `body` of it."""

    key: str
    first: int
    end: int
    body: int | None = None


@dataclass(frozen=True, eq=False)
class ArrayStore:
    """An archive, and the positions of its table's columns in it."""

    archive: Archive
    parts: tuple[Part, ...]

    def written(self, changed: Changed) -> bytes:
        """Return the archive with another table: entries that follow from the pose recomputed, or left out if that fails."""
        archive = self.archive
        if changed.nothing:
            return npz_bytes(archive.arrays, archive.compressed)
        was, now = self._entries(changed.was), self._entries(changed.now)
        anew = derived.written_anew(archive, changed.model, changed.before, changed.after, was, now)
        if changed.stayed is None:
            anew |= restated(archive, changed.after) | at_times(archive, changed.before.times, changed.after.times)
        lasting = None if changed.stayed is None else _lasting(changed.stayed)
        for key, values in anew.items():
            recorded = archive.arrays[key]
            if lasting is None or values.shape != recorded.shape or key not in derived.ALL:
                if key in derived.TURNS:
                    anew[key] = rotation.continuous(values).astype(values.dtype)
                continue
            if key in derived.TURNS:
                values = rotation.with_signs_of(values, recorded, lasting).astype(values.dtype)
            anew[key] = np.where(lasting.reshape(-1, *(1,) * (values.ndim - 1)), recorded, values)
        found = archive.rewritten(now, anew, derived.ALL, len(changed.before) if changed.stayed is None else None)
        return npz_bytes(self._with_root(found, changed.now), archive.compressed)

    def _entries(self, table: Array) -> dict[str, Array]:
        return {part.key: table[:, part.first : part.end] for part in self.parts if part.body is None}

    def _with_root(self, found: dict[str, AnyArray], table: Array) -> dict[str, AnyArray]:
        """Return the entries with the root's pose put among those of bodies."""
        for part in self.parts:
            if part.body is None:
                continue
            if part.key not in found:
                valid = "bodies that are fixed to links of this avatar, since the root's pose lies among them"
                raise InvalidFile(f"{part.key} of {self.archive.name}", "bodies that move against all links", valid)
            values = found[part.key].copy()
            values[:, part.body] = table[:, part.first : part.end]
            found[part.key] = values
        return found


def _lasting(stayed: Array) -> Array:
    """Return frames that stayed and whose neighbours did: speeds there are unchanged too."""
    padded = np.concatenate([stayed[:1], stayed, stayed[-1:]])
    return np.asarray(padded[:-2] & padded[1:-1] & padded[2:])


def of_archive(archive: Archive, rate: float | None, quaternion: str | None, names: tuple[str, ...] | None) -> Trajectory:
    """Return the trajectory in an archive. Raises InvalidFile for invalid entries, and names the missing ones."""
    notes: list[str] = []
    if names is None and (key := archive.first(JOINT_NAMES)):
        names = archive.words(key)
    parts, tables = _parts(archive, names)
    frames = {key: len(values) for key, values in tables.items()}
    if len(set(frames.values())) != 1:
        raise InvalidFile(f"frames of {archive.name}", frames, "as many in each entry")
    apart = any(part.key in ROOT_TURNS for part in parts)
    order = matching.require_order(quaternion or ("xyzw" if apart else "wxyz"))
    if quaternion is None:
        other = next(name for name in matching.ORDERS if name != order)
        notes.append(f'{archive.name}: quaternions taken as {", ".join(order)}; quaternion="{other}" says otherwise')
    notes += matching.pickles_note(archive)
    table = np.concatenate([tables[part.key] for part in parts], axis=1)
    if follow := [key for key in archive.arrays if key in derived.ALL and key not in {part.key for part in parts}]:
        fate = "written anew where this avatar gives what was recorded, else left out"
        notes.append(f"{archive.name}: {matching.shortened(follow)} follow from the pose: {fate}")
    times = times_of(archive, len(table), rate)
    found = object_of(archive, times, order)
    return Trajectory(
        archive.name, "npz", times, table, matching.Layout(names, order), ArrayStore(archive, parts),
        sentences=notes + object_note(archive.name, found), object=found,
    )


def _parts(archive: Archive, names: tuple[str, ...] | None) -> tuple[tuple[Part, ...], Mapping[str, Array]]:
    """Return the columns' positions in the archive, and the entries' numbers."""
    place, turn, joints = archive.first(ROOT_PLACES), archive.first(ROOT_TURNS), archive.first(JOINTS)
    if place and turn and joints:
        tables = {place: archive.table(place, 3), turn: archive.table(turn, 4), joints: archive.table(joints)}
        return (Part(place, 0, 3), Part(turn, 3, 7), Part(joints, 7, 7 + tables[joints].shape[1])), tables
    whole = archive.first(WHOLE)
    placed, turned = archive.first(derived.PLACES), archive.first(derived.TURNS)
    if joints and placed and turned and (joints not in WHOLE or _has_no_root(archive, joints, names)):
        values = archive.table(joints)
        listed = archive.first(derived.BODY_NAMES)
        root = 1 if listed and archive.words(listed)[:1] == ("world",) else 0
        bodies = {key: _one_body(archive, key, width, root) for key, width in ((placed, 3), (turned, 4))}
        parts = Part(placed, 0, 3, root), Part(turned, 3, 7, root), Part(joints, 7, 7 + values.shape[1])
        return parts, {**bodies, joints: values}
    if whole is None:
        valid = "qpos or joint_pos with root and joints; or root_pos, root_rot and dof_pos; or dof_pos with poses of bodies"
        raise InvalidFile(f"entries of {archive.name}", sorted(archive.arrays), valid)
    values = archive.table(whole)
    return (Part(whole, 0, values.shape[1]),), {whole: values}


def _has_no_root(archive: Archive, key: str, names: tuple[str, ...] | None) -> bool:
    """Return True if an entry has as many joints as names, so that their root is elsewhere."""
    return names is not None and archive.table(key).shape[1] == len(names)


def _one_body(archive: Archive, key: str, width: int, body: int) -> Array:
    """Return the poses (F, width) of a body."""
    found = archive.numbers(key)
    if found.ndim != 3 or found.shape[2] != width or not body < found.shape[1] or len(found) == 0:
        raise InvalidFile(f"shape of {key} in {archive.name}", found.shape, f"(frames, bodies, {width})")
    return np.ascontiguousarray(found[:, body])
