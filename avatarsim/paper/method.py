"""Lower loop of method `paper` (Schmidl and Lin 2004) as the frame sees it: postures, velocities of links, impulses received."""

from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.counters import Tally
from avatarsim.coupling.tracked_motion import apply_to_roots, tracked_velocities
from avatarsim.engine import Snapshot
from avatarsim.errors import InvalidScene
from avatarsim.jit.arena import pack, view_arena
from avatarsim.jit.kernel import entry_kernel
from avatarsim.model.geometry import Poses
from avatarsim.model.world import Target, TargetParts, World, WorldParts
from avatarsim.paper.algorithm_1 import follow_as_printed
from avatarsim.paper.state import COUNT_NAMES, STATUS_NAMES, PaperMemory, make_paper_memory
from avatarsim.scene.joint import Slide
from avatarsim.scene.scene import Scene
from avatarsim.settings import AttractionSettings, CouplingSettings, PaperSettings

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class PaperParts(NamedTuple):
    """Contents of the arena of the lower loop."""

    settings: PaperSettings
    coupling: CouplingSettings
    attraction: AttractionSettings
    memory: PaperMemory


@entry_kernel
def follow_printed(world: Index, target: Index, lower: Index, dt: float) -> None:
    """Run `follow_as_printed` on the arenas of a world, its target and the memory of the loop."""
    w, own, tracker = view_arena(world, WorldParts), view_arena(lower, PaperParts), view_arena(target, TargetParts).posture
    follow_as_printed(
        w.geometry, w.skeleton, tracker, dt, own.settings, own.coupling, own.attraction, w.posture, w.poses, own.memory
    )


def require_turning_joints(scene: Scene) -> None:
    """Raise InvalidScene for slides and couplings: the method as printed turns joints, each by itself."""
    for avatar in scene.avatars:
        if avatar.couplings:
            raise InvalidScene(f"couplings of avatar {avatar.name}", len(avatar.couplings), "0 with the preset paper")
    for link in scene.links:
        if isinstance(link.joint, Slide):
            raise InvalidScene(f"joint of link {link.name}", "Slide", "Rigid, Hinges, Ball or Free with the preset paper")


class PaperLoop:
    """The driven bodies of a world under method `paper`. `seed` settles the order in which chains are treated."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ()
    WRITTEN: ClassVar[tuple[str, ...]] = ("_words", "_before")

    def __init__(
        self, world: World, settings: PaperSettings, coupling: CouplingSettings, attraction: AttractionSettings, seed: int
    ) -> None:
        require_turning_joints(world.scene)
        self.world = world
        self._words, self._parts = pack(PaperParts(settings, coupling, attraction, make_paper_memory(world, seed)))
        self.memory = self._parts.memory
        self._before = Poses(*(array.copy() for array in world.poses))

    def retained_state(self) -> PaperParts:
        """Return what passes from frame to frame."""
        return self._parts

    def resume(self, begun: bool) -> None:
        """Continue after the memory was replaced, and with it the pair filter: the broad phase begins anew."""
        fat = self.memory.overlaps.sweep.fat
        fat[:, :3], fat[:, 3:] = np.inf, -np.inf

    def set_moving(self, moving: Index) -> None:
        """Do nothing: this loop checks all bodies in every frame."""

    def follow(self, target: Target, dt: float) -> None:
        """Follow the tracker's posture for one frame; the velocities of links are those of their displayed motion."""
        world = self.world
        np.copyto(self._before.position, world.poses.position)
        np.copyto(self._before.rotation, world.poses.rotation)
        follow_printed(world.words, target.words, self._words, dt)
        if world.scene.effects.dynamics:
            tracked_velocities(world.skeleton, self._before, world.poses, dt, world.velocities)

    def receive(self, impulses: Array) -> None:
        """Add impulses (nb, 3) [N s] on driven bodies to the velocities that eq. 6 continues from; nothing moves again."""
        apply_to_roots(self.world.skeleton, impulses, self.world.dynamics.inverse_mass, self.memory.velocity)

    def passed(self, time: float) -> tuple[Snapshot, ...]:
        """Return nothing: states within the rounds overlap, and are not shown."""
        return ()

    def counts(self) -> Tally:
        """Return the work done in the last frame."""
        return Tally(COUNT_NAMES, self.memory.counts[: len(COUNT_NAMES)].tobytes())

    def statuses(self) -> dict[str, int]:
        """Return counts of failures in the last frame, by name."""
        found = zip(STATUS_NAMES, self.memory.counts[len(COUNT_NAMES) :].tolist(), strict=True)
        return {name: count for name, count in found if count}
