"""Bodies whose poses a recording gives, such as a box that is carried: infinitely heavy, and never entered by avatars."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from avatarsim.errors import InvalidInput
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.checks import instance
from avatarsim.scene.joint import Free
from avatarsim.scene.motion import Motion


@dataclass(frozen=True, eq=False)
class Carried:
    """A moving body and its recorded poses.

    Attributes:
        body: as `moving` makes it, of one link with a `Free` joint.
        motion: its poses at the times of the avatar's motion, as of an avatar of one link.

    Raises:
        InvalidInput: for another kind of avatar or another number of links in the motion.
    """

    body: Avatar
    motion: Motion

    def __post_init__(self) -> None:
        instance("carried body", self.body, Avatar, "a body as `moving` makes it", InvalidInput)
        instance(f"motion of {self.body.name}", self.motion, Motion, "a Motion", InvalidInput)
        if not self.body.moves or len(self.body.links) != 1 or not isinstance(self.body.links[0].joint, Free):
            raise InvalidInput("carried body", self.body.name, "a body as `moving` makes it, without hinges")
        if self.motion.positions.shape[1:] != (1, 3) or self.motion.angles.shape[1] != 0:
            shape = self.motion.positions.shape, self.motion.angles.shape
            raise InvalidInput(f"shapes of the motion of {self.body.name}", shape, "positions (F, 1, 3) and no angles")

    def resampled(self, rate: float) -> "Carried":
        """Return the body with its poses at another rate [1/s], as `Motion.resampled`."""
        return Carried(self.body, self.motion.resampled(rate))


def joined(motion: Motion, carried: Sequence[Carried]) -> Motion:
    """Return a motion of an avatar and of the bodies it carries, in this order. Raises InvalidInput for other times."""
    if not carried:
        return motion
    for one in carried:
        if not np.array_equal(one.motion.times, motion.times):
            valid = f"the {len(motion)} of the avatar's motion"
            raise InvalidInput(f"times of {one.body.name}", f"{len(one.motion)} frames", valid)
    parts = (motion, *(one.motion for one in carried))
    names = ("positions", "rotations", "angles")
    return Motion(motion.times, *(np.concatenate([getattr(part, name) for part in parts], axis=1) for name in names))


def of_avatar(motion: Motion, avatar: Avatar) -> Motion:
    """Return the part of a motion that is the first avatar's."""
    links = len(avatar.links)
    if motion.positions.shape[1] == links:
        return motion
    return Motion(motion.times, motion.positions[:, :links], motion.rotations[:, :links], motion.angles[:, : avatar.hinge_count])
