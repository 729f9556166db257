"""Coordinates of hinges and slides, measured from the poses of the bodies that they join, for engines that state poses alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Hinge, Slide
from avatarsim.spatial import rotation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Joined:
    """A hinge or a slide between two bodies, by their rows: `anchor` [m] and `rest` of the joint in the upper one's frame."""

    above: int
    below: int
    anchor: Array
    rest: Array
    axis: Hinge | Slide


class JointAngles:
    """Angles [rad] of hinges, each followed over turns from its `first`, and ways [m] of slides."""

    def __init__(self, joints: Sequence[Joined], first: Array) -> None:
        self._angles = np.array(first, dtype=np.float64)
        self._above, self._below = (np.array([getattr(one, at) for one in joints], dtype=np.int64) for at in ("above", "below"))
        self._anchors = np.array([one.anchor for one in joints], dtype=np.float64).reshape(-1, 3)
        self._rests = np.array([one.rest for one in joints], dtype=np.float64).reshape(-1, 4)
        self._axes = np.array([one.axis.axis for one in joints], dtype=np.float64).reshape(-1, 3)
        self._slides = np.array([isinstance(one.axis, Slide) for one in joints], dtype=np.bool_)

    def measured(self, positions: Array, orientations: Array) -> Array:
        """Return the coordinates at poses (bodies, 3) [m] and (bodies, 4)."""
        if len(self._angles) == 0:
            return self._angles
        upper = orientations[self._above]
        frames = rotation.multiply(upper, self._rests)
        turned = rotation.multiply(rotation.conjugate(frames), orientations[self._below])
        angles = 2.0 * np.arctan2((turned[:, 1:] * self._axes).sum(axis=1), turned[:, 0])
        angles += 2.0 * np.pi * np.round((self._angles - angles) / (2.0 * np.pi))
        away = positions[self._below] - positions[self._above] - rotation.rotate(upper, self._anchors)
        self._angles = np.where(self._slides, (away * rotation.rotate(frames, self._axes)).sum(axis=1), angles)
        return self._angles
