"""Method `paper` as the frame sees it: the lower loop, the velocities it leaves for the upper one, impulses coming back."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from avatarsim.coupling.virtual_coupling import give_to_roots, tracked_velocities
from avatarsim.engine import Snapshot
from avatarsim.kernel import kernel
from avatarsim.loops.opened_paper import opened_attraction, opened_coupling, opened_memory, opened_settings
from avatarsim.loops.paper_memory import COUNT_NAMES, STATUS_NAMES, WORKING, make_paper_memory
from avatarsim.loops.paper_rounds import follow_as_printed
from avatarsim.settings import AttractionSettings, CouplingSettings, PaperSettings
from avatarsim.spatial.random import MODULUS
from avatarsim.tally import Tally
from avatarsim.world.arena import opening, packed
from avatarsim.world.geometry import Poses
from avatarsim.world.opened import (
    opened_dynamics,
    opened_geometry,
    opened_poses,
    opened_posture,
    opened_skeleton,
    opened_velocities,
)
from avatarsim.world.pair_filter import OPEN
from avatarsim.world.target import Target
from avatarsim.world.world import World

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@kernel
def follow_printed(world: Index, target: Index, kept: Index, dt: float) -> None:
    """`follow_as_printed` on the arenas of a world, its target and what the loop keeps."""
    o = opening(world)
    geometry, _ = opened_geometry(o), opened_dynamics(o)
    poses, _ = opened_poses(o), opened_velocities(o)
    skeleton, posture = opened_skeleton(o), opened_posture(o)
    tracker = opened_posture(opening(target))
    o = opening(kept)
    settings, coupling, attraction = opened_settings(o), opened_coupling(o), opened_attraction(o)
    follow_as_printed(geometry, skeleton, tracker, dt, settings, coupling, attraction, posture, poses, opened_memory(o))


class PaperLoop:
    """The driven bodies of a world under method `paper`. `seed` settles the order in which chains are treated."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ()
    WRITTEN: ClassVar[tuple[str, ...]] = ("_kept", "_before")
    KEPT: ClassVar[tuple[str, ...]] = ("memory",)
    WORKING: ClassVar[tuple[str, ...]] = WORKING

    def __init__(
        self, world: World, settings: PaperSettings, coupling: CouplingSettings, attraction: AttractionSettings, seed: int
    ) -> None:
        self.world = world
        self._kept, (_, _, _, self.memory) = packed((settings, coupling, attraction, make_paper_memory(world, seed)))
        self._before = Poses(*(array.copy() for array in world.poses))
        self._no_rate = np.zeros_like(self.memory.velocity)

    def ranges(self) -> Mapping[str, tuple[int, int]]:
        """The order of the chains, the state of their generator, and families, which are only compared."""
        return {"order": (0, len(self.memory.order) - 1), "random": (1, MODULUS - 1), "family": (OPEN, len(self.world.centres))}

    def go_on(self, begun: bool) -> None:
        """The memory was replaced, and with it which pairs are looked for: the sweep begins anew."""
        fat = self.memory.overlaps.sweep.fat
        fat[:, :3], fat[:, 3:] = np.inf, -np.inf

    def watch(self, moving: Index) -> None:
        """Nothing: this loop looks at everybody in every frame."""

    def follow(self, target: Target, dt: float) -> None:
        """One frame towards the tracker's posture; links then have the velocity of the way that they were shown to go."""
        world = self.world
        np.copyto(self._before.position, world.poses.position)
        np.copyto(self._before.rotation, world.poses.rotation)
        follow_printed(world.words, target.words, self._kept, dt)
        if world.scene.effects.dynamics:
            tracked_velocities(world.skeleton, self._before, world.poses, self._no_rate, dt, world.velocities)

    def receive(self, impulses: Array, moving: Index, target: Target) -> None:
        """Impulses (nb, 3) [N s] on driven bodies change the velocities that eq. 6 goes on from; nothing moves again."""
        give_to_roots(self.world.skeleton, impulses, self.world.dynamics.inverse_mass, self.memory.velocity)

    def passed(self, time: float) -> tuple[Snapshot, ...]:
        """Nothing: what the rounds pass through on the way overlaps, and is not shown."""
        return ()

    def counts(self) -> Tally:
        """Work done in the last frame."""
        return Tally(COUNT_NAMES, self.memory.counts[: len(COUNT_NAMES)].tobytes())

    def statuses(self) -> dict[str, int]:
        """What did not end well in the last frame, and how often."""
        found = zip(STATUS_NAMES, self.memory.counts[len(COUNT_NAMES) :].tolist(), strict=True)
        return {name: count for name, count in found if count}
