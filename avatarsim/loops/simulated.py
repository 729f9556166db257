"""Upper loop (Schmidl and Lin 2004, Figure 3) as the frame sees it: simulated bodies move, driven ones receive impulses."""

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

from avatarsim.engine import Snapshot
from avatarsim.impact.events import Events, make_events
from avatarsim.jit.arena import opened, packed
from avatarsim.jit.kernel import entry_kernel
from avatarsim.jit.layout import Index
from avatarsim.loops.recorded_events import snapshots
from avatarsim.loops.upper import DONE, STATUS_NAMES, advance
from avatarsim.loops.upper_memory import COUNT_NAMES, WORKING, Memory, Switches, make_memory
from avatarsim.motion.path import HELD, STILL
from avatarsim.tally import Tally
from avatarsim.world.parts import WorldParts
from avatarsim.world.world import World

EVENTS_KEPT = 256
"""Most events of one frame that a recording keeps (two per impact); more are counted."""

MOST = 2**60
"""Largest number of a frame, a segment or a contact in a snapshot: counting on from there takes longer than the Earth is old."""


class UpperParts(NamedTuple):
    """What lies in the arena of the upper loop."""

    memory: Memory
    events: Events
    switches: Switches


@entry_kernel
def advance_opened(world: Index, kept: Index, dt: float) -> int:
    """`advance` on the arenas of a world and of its upper loop."""
    w, own = opened(world, WorldParts), opened(kept, UpperParts)
    return advance(w.geometry, w.dynamics, w.poses, w.velocities, dt, own.memory, own.events, own.switches)


class SimulatedLoop:
    """The simulated bodies of a world, and driven ones that keep `stand_off` [m] from them."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ("status",)
    WRITTEN: ClassVar[tuple[str, ...]] = ("words",)
    KEPT: ClassVar[tuple[str, ...]] = ("memory",)
    WORKING: ClassVar[tuple[str, ...]] = WORKING

    def __init__(self, world: World, *, paper: bool, record: bool, stand_off: float = 0.0) -> None:
        self.world, self.record, self.status = world, record, DONE
        on = world.scene.effects
        switches = Switches(on.gyroscopic, on.continuous, on.sleeping, paper, record)
        memory = make_memory(world.geometry, world.dynamics, world.poses, on.gyroscopic, stand_off)
        events = make_events(len(world.scene.names), EVENTS_KEPT if record else 0)
        self.words, (self.memory, self.events, _) = packed(UpperParts(memory, events, switches))

    def ranges(self) -> Mapping[str, tuple[int, int]]:
        """Flags, bodies, segments of the table of forces, and numbers of frames that are compared and counted on."""
        bodies, flag, number = len(self.memory.moving), (0, 1), (-1, MOST)
        return {
            "moving": flag, "asleep": flag, "held": flag, "owing": flag, "joins": flag, "late": flag, "kind": (STILL, HELD),
            "last.body": (0, bodies - 1), "key": number, "turn": number, "latest": number, "turns": number, "visits": (0, MOST),
            "earliest": number, "charged": number, "spent": (0, MOST), "blocked": number, "clogged": number, "frames": (0, MOST),
        }

    def go_on(self) -> None:
        """The memory was replaced; the broad phase finds by itself that its fat boxes no longer hold."""

    def advance(self, dt: float) -> None:
        """Pass `dt` seconds."""
        self.status = advance_opened(self.world.words, self.words, dt)

    def counts(self) -> Tally:
        """Work done in the last frame."""
        return Tally(COUNT_NAMES, self.memory.counts.tobytes())

    def statuses(self) -> dict[str, int]:
        """What did not end well in the last frame."""
        found = {} if self.status == DONE else {f"motion {STATUS_NAMES[self.status]}": 1}
        if self.record and (lost := int(self.events.kept[0]) - len(self.events.time)) > 0:
            found["events not recorded"] = lost
        return found

    def inside(self, begun: float) -> tuple[Snapshot, ...]:
        """Events of the last frame, which began at `begun` [s], if they are recorded."""
        return snapshots(self.world, self.events, begun) if self.record else ()
