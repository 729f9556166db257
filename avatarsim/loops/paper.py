"""Method `paper` as the frame sees it: the lower loop, the velocities it leaves for the upper one, impulses coming back."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.loops.coupling import give_to_roots, tracked_velocities
from avatarsim.loops.paper_memory import COUNT_NAMES, STATUS_NAMES, make_paper_memory
from avatarsim.loops.paper_rounds import follow_as_printed
from avatarsim.settings import AttractionSettings, CouplingSettings, PaperSettings
from avatarsim.world.geometry import Poses
from avatarsim.world.target import Target
from avatarsim.world.world import World

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class PaperLoop:
    """The driven bodies of a world under method `paper`. `seed` settles the order in which chains are treated."""

    def __init__(
        self, world: World, settings: PaperSettings, coupling: CouplingSettings, attraction: AttractionSettings, seed: int
    ) -> None:
        self.world, self.settings, self.coupling, self.attraction = world, settings, coupling, attraction
        self.memory = make_paper_memory(world, seed)
        self._before = Poses(*(array.copy() for array in world.poses))
        self._no_rate = np.zeros_like(self.memory.velocity)

    def watch(self, moving: Index) -> None:
        """Nothing: this loop looks at everybody in every frame."""

    def follow(self, target: Target, dt: float) -> None:
        """One frame towards the tracker's posture; links then have the velocity of the way that they were shown to go."""
        world = self.world
        np.copyto(self._before.position, world.poses.position)
        np.copyto(self._before.rotation, world.poses.rotation)
        follow_as_printed(
            world.geometry, world.skeleton, target.posture, dt, self.settings, self.coupling, self.attraction,
            world.posture, world.poses, self.memory,
        )
        if world.scene.effects.dynamics:
            tracked_velocities(world.skeleton, self._before, world.poses, self._no_rate, dt, world.velocities)

    def receive(self, impulses: Array, moving: Index, target: Target) -> None:
        """Impulses (nb, 3) [N s] on driven bodies change the velocities that eq. 6 goes on from; nothing moves again."""
        give_to_roots(self.world.skeleton, impulses, self.world.dynamics.inverse_mass, self.memory.velocity)

    def counts(self) -> dict[str, int]:
        """Work done in the last frame."""
        return dict(zip(COUNT_NAMES, self.memory.counts[: len(COUNT_NAMES)].tolist(), strict=True))

    def statuses(self) -> dict[str, int]:
        """What did not end well in the last frame, and how often."""
        found = zip(STATUS_NAMES, self.memory.counts[len(COUNT_NAMES) :].tolist(), strict=True)
        return {name: count for name, count in found if count}
