"""A recorded clip on its own skeleton: columns of Cardan angles and places to a motion, and a motion back to those columns.

A column that the motion does not change keeps its number bit for bit; others get the angle nearest the previous one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.skeleton import Skeleton
from avatarsim.assets.motions import euler
from avatarsim.errors import InvalidInput
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Hinge, axes_of
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

SAME = 1e-12
"""Angle [rad] and length [m] within which a joint is unchanged: the rounding of its quaternion, and ten
thousand times less than a millionth of a degree."""

EVEN = 1e-6
"""Share of a step by which steps of a motion may differ: files of this kind have one step for all frames, to six digits."""

UNSAID = 1e-9
"""Length [m] and angle [rad] by which the root may differ from its columns' possible values before that is refused."""


@dataclass(frozen=True)
class Axes:
    """Units of a file's numbers: `scale` [m] of its unit of length, `angle` [rad] of its unit of angle, `up` "y" or "z".

    Vectors of a file with y up are converted by (x, y, z) -> (x, -z, y), a turn that rounds nothing."""

    scale: float
    angle: float
    up: str

    def vectors(self, of_file: Array) -> Array:
        """Return directions and axes (..., 3) with z up; no scale."""
        return of_file if self.up == "z" else np.stack([of_file[..., 0], -of_file[..., 2], of_file[..., 1]], axis=-1)

    def in_file(self, vectors: Array) -> Array:
        """Apply the inverse of `vectors`."""
        return vectors if self.up == "z" else np.stack([vectors[..., 0], vectors[..., 2], -vectors[..., 1]], axis=-1)

    def turned(self, of_file: Array) -> Array:
        """Return quaternions (..., 4) with z up."""
        return np.concatenate([of_file[..., :1], self.vectors(of_file[..., 1:])], axis=-1)

    def turned_in_file(self, quaternions: Array) -> Array:
        """Apply the inverse of `turned`."""
        return np.concatenate([quaternions[..., :1], self.in_file(quaternions[..., 1:])], axis=-1)


@dataclass(frozen=True)
class Track:
    """The columns of one bone. Numbers of columns are -1 where there is none.

    places  columns of x, y, z, in the file's axes
    start   (3,) added to them, 0 where the column alone counts, and the value along an axis without a column; in the file's unit
    turns   (column, axis 0 to 2) of each turn, the outermost first
    frame   the quaternion of the frame, in the file's axes, to which these axes belong"""

    places: tuple[int, int, int]
    start: tuple[float, float, float]
    turns: tuple[tuple[int, int], ...]
    frame: tuple[float, float, float, float] = rotation.IDENTITY

    def place(self, values: Array) -> Array:
        """Return places (F, 3) in the file's unit and axes."""
        found = np.tile(np.array(self.start), (len(values), 1))
        for k, column in enumerate(self.places):
            if column >= 0:
                found[:, k] += values[:, column]
        return found

    def angles(self, values: Array, angle: float) -> Array:
        """Return angles (F, turns) [rad]."""
        return values[:, [column for column, _ in self.turns]] * angle

    @property
    def axes(self) -> tuple[int, ...]:
        """Axis of each turn."""
        return tuple(axis for _, axis in self.turns)

    def turned(self, values: Array, angle: float) -> Array:
        """Return quaternions (F, 4) of all turns together, in the file's axes."""
        own = euler.quaternion(self.axes, self.angles(values, angle))
        if self.frame == rotation.IDENTITY:
            return own
        return rotation.multiply(rotation.multiply(self.frame, own), rotation.conjugate(self.frame))

    def in_frame(self, turned: Array) -> Array:
        """Return quaternions (n, 4), in the file's axes, as turns about the frame's."""
        if self.frame == rotation.IDENTITY:
            return turned
        return rotation.multiply(rotation.multiply(rotation.conjugate(self.frame), turned), self.frame)


@dataclass(frozen=True, eq=False)
class Recording:
    """A clip: its `skeleton`, a track of columns for each bone, `values` (F, columns), one row every `step` [s].

    `above` are the tracks of joints above the skeleton's root that carry it and are not links themselves."""

    thing: str
    skeleton: Skeleton
    tracks: tuple[Track, ...]
    values: Array
    step: float
    axes: Axes
    above: tuple[Track, ...] = ()

    def carrier(self, values: Array) -> tuple[Array, Array]:
        """Return the pose of the joints above the root: places (F, 3) in the file's unit and turns (F, 4), in its axes."""
        place, turned = np.zeros((len(values), 3)), np.tile(rotation.IDENTITY, (len(values), 1))
        for track in self.above:
            place = place + rotation.rotate(turned, track.place(values))
            turned = rotation.multiply(turned, track.turned(values, self.axes.angle))
        return place, turned

    def evenly(self, frames: int) -> list[int]:
        """Return at most so many frames, evenly from the first to the last."""
        return [int(frame) for frame in np.unique(np.linspace(0, len(self.values) - 1, frames).round())]

    def at(self, frames: Sequence[int]) -> "Recording":
        """Return these frames alone, a second apart."""
        return replace(self, values=self.values[list(frames)], step=1.0)

    @cached_property
    def motion(self) -> Motion:
        """Return the clip for the skeleton's own avatar."""
        bones = self.skeleton.bones
        positions = np.zeros((len(self.values), len(bones), 3))
        rotations = np.tile(np.array(rotation.IDENTITY), (len(self.values), len(bones), 1))
        hinges: list[Array] = []
        for k, (bone, track) in enumerate(zip(bones, self.tracks, strict=True)):
            if bone.parent < 0:
                place, carried = self.carrier(self.values)
                place = place + rotation.rotate(carried, track.place(self.values))
                own = rotation.multiply(carried, track.turned(self.values, self.axes.angle))
                positions[:, k] = self.axes.scale * self.axes.vectors(place)
                turned = self.axes.turned(own)
            elif len(track.turns) == 3:
                turned = self.axes.turned(track.turned(self.values, self.axes.angle))
            else:
                hinges.append(track.angles(self.values, self.axes.angle))
                continue
            rotations[:, k] = rotation.continuous(rotation.normalised(turned))
        all_hinges: Array = np.concatenate([np.zeros((len(self.values), 0)), *hinges], axis=1)
        times = np.arange(len(self.values), dtype=np.float64) * self.step
        return Motion(times, positions, rotations, all_hinges)

    def motion_within(self, avatar: Avatar) -> Motion:
        """Return the clip, with hinges on the turn nearest their limits: recordings count whole turns arbitrarily."""
        angles = self.motion.angles.copy()
        for k, hinge in enumerate(axis for link in avatar.links for axis in axes_of(link.joint)):
            if isinstance(hinge, Hinge) and hinge.upper - hinge.lower < 2.0 * np.pi:
                whole = np.round((angles[:, k] - 0.5 * (hinge.lower + hinge.upper)) / (2.0 * np.pi))
                angles[:, k] -= 2.0 * np.pi * whole
        return replace(self.motion, angles=angles)

    def rows(self, motion: Motion) -> tuple[Array, float]:
        """Return the columns (frames, columns) of another motion of this avatar, and its step [s].

        Raises InvalidInput for steps that differ from each other, and for a root pose that no column can represent."""
        step = self._step(motion)
        near = np.zeros(len(motion), dtype=np.int64)
        if self.step > 0.0:
            near = np.clip(np.rint((motion.times - motion.times[0]) / self.step), 0, len(self.values) - 1).astype(np.int64)
        values = self.values[near]
        hinge = 0
        for k, (bone, track) in enumerate(zip(self.skeleton.bones, self.tracks, strict=True)):
            if bone.parent < 0:
                self._write_root(values, motion, near)
            elif len(track.turns) == 3:
                turned = self.axes.turned_in_file(motion.rotations[:, k])
                self._write_turns(values, track, turned, self.axes.turned_in_file(self.motion.rotations[near, k]))
            else:
                for column, _ in track.turns:
                    _write_angle(values, column, motion.angles[:, hinge], self.motion.angles[near, hinge], self.axes.angle)
                    hinge += 1
        return values, step

    def _step(self, motion: Motion) -> float:
        own = self.motion.times
        if len(motion) == 1:
            return self.step
        if len(motion) == len(own) and np.abs(motion.times - motion.times[0] - own).max() <= EVEN * self.step:
            return self.step
        steps = np.diff(motion.times)
        mean = float(motion.times[-1] - motion.times[0]) / len(steps)
        if not np.abs(steps - mean).max() <= EVEN * mean:
            valid = "equal steps, as motion.resampled(rate) makes them"
            raise InvalidInput("steps of a motion [s]", (float(steps.min()), float(steps.max())), valid)
        return mean

    def _write_turns(self, values: Array, track: Track, turned: Array, before: Array) -> None:
        """Write the angles of quaternions `turned` (n, 4), in the file's axes, where they differ from those `before`."""
        moved = np.flatnonzero(away(turned, before) > SAME)[:, None]
        columns = np.array([column for column, _ in track.turns])
        near = values[moved, columns] * self.axes.angle
        a, b, c = track.axes
        values[moved, columns] = euler.cardan((a, b, c), track.in_frame(turned[moved[:, 0]]), near) / self.axes.angle

    def _write_root(self, values: Array, motion: Motion, near: NDArray[np.int64]) -> None:
        bone, track = self.skeleton.bones[0], self.tracks[0]
        place, carried = self.carrier(values)
        moved = np.linalg.norm(motion.positions[:, 0] - self.motion.positions[near, 0], axis=1) > SAME
        wanted = self.axes.in_file(motion.positions[:, 0]) / self.axes.scale - place
        wanted = rotation.rotate(rotation.conjugate(carried), wanted) - np.array(track.start)
        for axis, column in enumerate(track.places):
            if column >= 0:
                values[moved, column] = wanted[moved, axis]
            elif (np.abs(wanted[moved, axis]) * self.axes.scale > UNSAID).any():
                far = float(np.abs(wanted[moved, axis]).max() * self.axes.scale)
                valid = f"0: {self.thing} has no column for it"
                raise InvalidInput(f"way of {bone.name} along {'xyz'[axis]} of the file [m]", far, valid)

        uncarried = rotation.conjugate(carried)
        turned = rotation.multiply(uncarried, self.axes.turned_in_file(motion.rotations[:, 0]))
        before = rotation.multiply(uncarried, self.axes.turned_in_file(self.motion.rotations[near, 0]))
        if len(track.turns) == 3:
            self._write_turns(values, track, turned, before)
        elif (away(turned, before) > UNSAID).any():
            valid = f"0: {self.thing} has no three columns for it"
            raise InvalidInput(f"turn of {bone.name} [rad]", float(away(turned, before).max()), valid)


def _write_angle(values: Array, column: int, angles: Array, before: Array, unit: float) -> None:
    """Write hinge angles (n,) [rad] into a column, where they differ from those `before`, on the turn of the old number."""
    unturned = angles - 2.0 * np.pi * np.round((angles - before) / (2.0 * np.pi))
    moved = np.abs(unturned - before) > SAME
    values[moved, column] = unturned[moved] / unit


def away(a: Array, b: Array) -> Array:
    """Return the angle [rad] from unit quaternions a to b, (..., 4)."""
    left = rotation.multiply(rotation.conjugate(a), b)
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(left[..., 1:], axis=-1), np.abs(left[..., 0])))
