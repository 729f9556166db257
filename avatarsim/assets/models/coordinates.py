"""Generalized coordinates of an avatar, in the order of the file it comes from, as in MuJoCo's qpos."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidInput
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.checks import real_array
from avatarsim.scene.joint import Ball, Free, Slide, axes_of
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

WIDTHS = {"free": 7, "ball": 4, "hinge": 1, "slide": 1, "fixed": 1}
"""Numbers of a joint: a free one has its position [m] and quaternion (w first), a ball its quaternion, a hinge its angle [rad], a
slide its displacement [m]; each number of a joint fixed at the file's reference is a slot of its own, `fixed`."""


@dataclass(frozen=True)
class Slot:
    """One joint: its `name` in the file, its `kind` (of WIDTHS), the `link` that it moves, and its angle.
    For a hinge or a slide, `hinge` is its index among the avatar's angles and `rest` the number that the file adds to that angle
    (a model's reference); of a fixed slot, which moves no link (-1), `rest` is written. `speed` is the largest that the file
    states [rad/s, m/s], 0 where it states none."""

    name: str
    kind: str
    link: int
    hinge: int = -1
    rest: float = 0.0
    speed: float = 0.0


@dataclass(frozen=True)
class Coordinates:
    """The joints of an avatar with `links` links and `hinges` hinges and slides, in the file's order."""

    slots: tuple[Slot, ...]
    links: int
    hinges: int

    @property
    def width(self) -> int:
        """Number of coordinates of a posture."""
        return sum(WIDTHS[slot.kind] for slot in self.slots)

    @property
    def names(self) -> tuple[str, ...]:
        """Joint names of the slots."""
        return tuple(slot.name for slot in self.slots)

    def motion(self, q: Array, times: Array) -> Motion:
        """Return the motion of rows q (F, width) at `times` (F,) [s]; quaternions are normalised, fixed numbers are ignored.

        Raises InvalidInput for other shapes, numbers that are not finite and quaternions without length."""
        try:
            q = q if type(q) is np.ndarray and q.dtype == np.float64 else real_array(q)
        except (TypeError, ValueError, OverflowError) as error:
            raise InvalidInput("generalized coordinates", str(error), "an array of real numbers") from error
        if q.ndim != 2 or q.shape[1] != self.width:
            raise InvalidInput("shape of generalized coordinates", q.shape, f"(frames, {self.width}): {', '.join(self.names)}")
        bad = ~np.isfinite(q)
        if bad.any():
            frame, column = (int(k) for k in np.argwhere(bad)[0])
            raise InvalidInput(f"column {column} of frame {frame}", float(q[frame, column]), "a finite number")
        frames = len(q)
        positions = np.zeros((frames, self.links, 3))
        rotations = np.tile(np.array(rotation.IDENTITY), (frames, self.links, 1))
        angles = np.zeros((frames, self.hinges))
        first = 0
        for slot in self.slots:
            if slot.hinge >= 0:
                angles[:, slot.hinge] = q[:, first] - slot.rest
            elif slot.kind != "fixed":
                end = first + WIDTHS[slot.kind]
                rotations[:, slot.link] = _unit(slot.name, q[:, end - 4 : end])
                if slot.kind == "free":
                    positions[:, slot.link] = q[:, first : first + 3]
            first += WIDTHS[slot.kind]
        return Motion(times, positions, rotations, angles)

    def rows(self, motion: Motion) -> Array:
        """Return the rows (F, width) of a motion: the inverse of `motion`, but for fixed numbers.

        Raises InvalidInput for a motion of another avatar."""
        shapes = motion.positions.shape[1], motion.angles.shape[1]
        if shapes != (self.links, self.hinges):
            raise InvalidInput("links and hinges of a motion", shapes, f"{(self.links, self.hinges)}, as these coordinates have")
        columns: list[Array] = []
        for slot in self.slots:
            if slot.hinge >= 0:
                columns.append(motion.angles[:, slot.hinge, None] + slot.rest)
                continue
            if slot.kind == "fixed":
                columns.append(np.full((len(motion), 1), slot.rest))
                continue
            if slot.kind == "free":
                columns.append(motion.positions[:, slot.link])
            columns.append(motion.rotations[:, slot.link])
        return np.concatenate([np.zeros((len(motion), 0)), *columns], axis=1)


def _unit(name: str, quaternions: Array) -> Array:
    """Normalise quaternions (F, 4); InvalidInput for one without length. Those of length 1 stay as they are, to the bit."""
    lengths = np.linalg.norm(quaternions, axis=1)
    if not (lengths > 1e-3).all():
        frame = int(np.argmin(lengths))
        raise InvalidInput(f"quaternion of {name} in frame {frame}", quaternions[frame].tolist(), "a quaternion of length 1")
    return rotation.unit(quaternions)


def coordinates_of(avatar: Avatar) -> Coordinates:
    """Return the coordinates of an avatar that comes from no file: its joints link by link, named by the link that they move.
    Several hinges of a link are `link.0`, `link.1` and so on."""
    slots: list[Slot] = []
    hinge = 0
    for index, link in enumerate(avatar.links):
        if isinstance(link.joint, Free | Ball):
            slots.append(Slot(link.name, "free" if isinstance(link.joint, Free) else "ball", index))
        for k, axis in enumerate(axes := axes_of(link.joint)):
            kind = "slide" if isinstance(axis, Slide) else "hinge"
            slots.append(Slot(f"{link.name}.{k}" if len(axes) > 1 else link.name, kind, index, hinge))
            hinge += 1
    return Coordinates(tuple(slots), len(avatar.links), hinge)
