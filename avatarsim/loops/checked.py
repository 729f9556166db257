"""Method `default` as the frame sees it: the checked lower loop with its springs."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.loops.coupling import Coupling
from avatarsim.posture.follow import follow
from avatarsim.posture.workspace import COUNT_NAMES, ready_memory, was_held
from avatarsim.settings import CouplingSettings, PostureSettings
from avatarsim.world.skeleton import Posture
from avatarsim.world.world import World

Array = NDArray[np.float64]


class CheckedLoop:
    """The driven bodies of a world: every state shown was certified from the last one."""

    def __init__(self, world: World, settings: PostureSettings, coupling: CouplingSettings) -> None:
        self.world, self.settings = world, settings
        self.memory = ready_memory(world.geometry, world.skeleton, world.posture, world.poses, settings)
        self.coupling = Coupling(world, coupling) if world.scene.effects.coupling else None

    def follow(self, target: Posture, dt: float) -> None:
        """One frame towards the tracker's posture, which the springs displace by their offsets."""
        if self.coupling is not None:
            self.coupling.pull(target, dt)
        self.memory.counts[:] = 0
        self._step(target)

    def receive(self, impulses: Array, target: Posture, others_move: bool) -> None:
        """Impulses (nb, 3) [N s] go into the springs. What stood in the way may have moved on: then do not wait a frame."""
        if self.coupling is not None:
            self.coupling.receive(impulses)
        if others_move and was_held(self.memory):
            self._step(target)

    def counts(self) -> dict[str, int]:
        """Work done in the last frame."""
        return dict(zip(COUNT_NAMES, self.memory.counts.tolist(), strict=True))

    def statuses(self) -> dict[str, int]:
        """What did not end well in the last frame, and how often."""
        counts = self.counts()
        return {name: counts[name] for name in ("bad_queries", "rows_dropped", "resyncs") if counts[name]}

    def _step(self, target: Posture) -> None:
        world = self.world
        follow(world.geometry, world.skeleton, target, self.settings, world.posture, world.poses, self.memory)
