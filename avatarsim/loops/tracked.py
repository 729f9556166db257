"""Lower loop without overlap removal, for scenes that switch it off: the tracker's posture is shown as it is."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from avatarsim.engine import Snapshot
from avatarsim.jit.layout import Array, Index
from avatarsim.tally import Tally
from avatarsim.world.kinematics import forward
from avatarsim.world.target import Target
from avatarsim.world.world import World


class TrackedLoop:
    """The driven bodies of a world at the tracker's posture, whatever they overlap."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ()
    WRITTEN: ClassVar[tuple[str, ...]] = ("_still", "_axes")
    KEPT: ClassVar[tuple[str, ...]] = ()
    WORKING: ClassVar[tuple[str, ...]] = ()

    def __init__(self, world: World) -> None:
        self.world = world
        degrees = int(world.skeleton.first_dof[-1])
        self._still, self._axes = np.zeros(degrees), np.zeros((degrees, 3))

    def ranges(self) -> Mapping[str, tuple[int, int]]:
        """Nothing is kept."""
        return {}

    def go_on(self, begun: bool) -> None:
        """Nothing: every frame is the first."""

    def watch(self, moving: Index) -> None:
        """Nothing: this loop checks no body."""

    def follow(self, target: Target, dt: float) -> None:
        """Take the tracker's posture over."""
        world = self.world
        for mine, theirs in zip(world.posture, target.posture, strict=True):
            np.copyto(mine, theirs)
        forward(world.geometry, world.skeleton, world.posture, self._still, world.poses, self._axes)

    def receive(self, impulses: Array, moving: Index, target: Target) -> None:
        """Impulses (nb, 3) [N s] change nothing: the tracker does not yield."""

    def passed(self, time: float) -> tuple[Snapshot, ...]:
        """Nothing: there is one step."""
        return ()

    def counts(self) -> Tally:
        """No work worth counting."""
        return Tally()

    def statuses(self) -> dict[str, int]:
        """Nothing can fail."""
        return {}
