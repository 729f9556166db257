"""Clips that are in the room in every frame: their depth, and the constant lift that frees them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.cleaning.chords import Chords
from avatarsim.cleaning.foot_contact import lowered_gaps
from avatarsim.cleaning.result import OVERLAP
from avatarsim.scene.motion import Motion

Array = NDArray[np.float64]

LOOKS = 16
"""Times that a posture is lifted by its depth in the room: once suffices on level ground, furniture needs more."""


@dataclass(frozen=True, eq=False)
class Ground:
    """Lifts (F,) [m] that take the avatar out of the room in each frame, at the margin from it; infinite where none was found."""

    lifts: Array
    margin: float

    @property
    def is_off(self) -> bool:
        """Return True if every frame is in the room, and can be lifted out of it."""
        return bool(len(self.lifts) > 0 and self.lifts.min() > self.margin + OVERLAP and np.isfinite(self.lifts).all())

    @property
    def usual(self) -> float:
        """Median of the lifts [m], by which a clip is raised that is in the room in every frame."""
        return float(np.median(self.lifts))

    @property
    def free(self) -> float:
        """The constant lift [m] that takes every frame out of the room."""
        return float(self.lifts.max())

    @property
    def note(self) -> str:
        """Return a sentence on a clip that is in the room in every frame."""
        least, most = (1e3 * (lift - self.margin) for lift in (self.lifts.min(), self.lifts.max()))
        return (
            f"every frame is in the room, by {least:.0f} to {most:.0f} mm; a constant lift of {1e3 * self.free:.0f} mm takes it "
            f"out. The ground of the recording may be at {self.margin - self.usual:.3f} m"
        )


def ground_of(chords: Chords, motion: Motion, margin: float) -> Ground:
    """Find by how much each frame has to be lifted out of the fixed bodies; an avatar whose root does not move is not lifted."""
    lifts = np.zeros(len(motion))
    if not chords.free_roots.size:
        return Ground(lifts, margin)
    links = range(len(chords.scene.avatars[0].links))
    for _ in range(LOOKS):
        gaps = lowered_gaps(chords, motion, links, margin - lifts).min(axis=1)
        lifts = lifts + np.maximum(0.0, -gaps)
        if (gaps >= -OVERLAP).all():
            return Ground(lifts, margin)
    return Ground(np.where(gaps >= -OVERLAP, lifts, np.inf), margin)


def raised(motion: Motion, chords: Chords, lifts: Array | float) -> Motion:
    """Return the motion with the root of the avatar higher by lifts (F,) [m]; where these are 0 it stays, to the bit."""
    lift = np.broadcast_to(lifts, len(motion))
    positions, away = motion.positions.copy(), np.flatnonzero(lift != 0.0)
    positions[away[:, None], chords.free_roots, 2] += lift[away, None]
    return Motion(motion.times, positions, motion.rotations, motion.angles)
