"""Method `default` as the frame sees it: the checked lower loop with its springs."""

from collections.abc import Mapping
from operator import itemgetter
from typing import ClassVar

import numpy as np

from avatarsim.engine import Snapshot
from avatarsim.errors import InvalidSnapshot
from avatarsim.ik.state import make_contacts
from avatarsim.kernel import kernel
from avatarsim.loops.active_rows import list_active
from avatarsim.loops.coupling import give, make_springs, no_springs, pull, strike
from avatarsim.loops.opened_checked import opened_contacts, opened_memory, opened_settings, opened_springs, opened_way
from avatarsim.loops.recorded_events import trail_snapshots
from avatarsim.posture.chain import MODULUS
from avatarsim.posture.follow import follow
from avatarsim.posture.leap_round import seek
from avatarsim.posture.sound import memory_is_sound, way_is_sound
from avatarsim.posture.way_memory import IDLE, MODE, make_way
from avatarsim.posture.workspace import (
    ADOPTED,
    BAD_QUERIES,
    COUNT,
    COUNT_NAMES,
    CROSSINGS,
    DROPPED,
    LEAP,
    LEAPS,
    LED_STEPS,
    RESYNCS,
    ROW_CAP,
    SLOW,
    TRAPPED_FRAMES,
    WALLED_FRAMES,
    WORKING,
    ready_memory,
)
from avatarsim.settings import CouplingSettings, PostureSettings
from avatarsim.tally import Tally
from avatarsim.world.arena import Array, Index, opening, packed, yes
from avatarsim.world.opened import (
    opened_dynamics,
    opened_geometry,
    opened_poses,
    opened_posture,
    opened_skeleton,
    opened_velocities,
)
from avatarsim.world.target import Target
from avatarsim.world.world import World

BAD = (BAD_QUERIES, DROPPED, RESYNCS, TRAPPED_FRAMES, WALLED_FRAMES, CROSSINGS, LED_STEPS, LEAPS)
"""Places of the counts that say that something did not end well, or that an avatar went elsewhere than straight to its user."""

STEPS_KEPT = 256
"""Most steps of one frame whose poses a recording keeps; more are counted. The longest leap takes a hundred, and as many more
along a way round."""

BAD_OF, ALL_WELL = itemgetter(*BAD), (0,) * len(BAD)
"""These of a list of counts, and what they are in nearly every frame."""

MOST = 2**60
"""Largest count in a snapshot: counting on from there takes longer than the Earth is old."""

NOTHING_RECEIVED, NOBODY = np.zeros((0, 3)), np.zeros(0, dtype=np.int64)


@kernel
def follow_opened(world: Index, target: Index, kept: Index, dt: float, answering: bool, received: Array, moving: Index) -> None:
    """One stage of the lower loop on the arenas of a world, its target and what the loop keeps.

    Not answering: springs act for dt [s], then `follow`. Answering to the upper loop: impulses `received` (nb, 3) [N s] go into
    the springs; what stood in the way may have moved on: then `follow` does not wait a frame. `moving` (nb): who moves, or did
    when the upper loop last ran; empty if nobody knows. Both in one kernel, since each kernel that calls `follow` compiles all of
    it again.
    """
    o = opening(world)
    geometry, dynamics = opened_geometry(o), opened_dynamics(o)
    poses, velocities = opened_poses(o), opened_velocities(o)
    skeleton, posture = opened_skeleton(o), opened_posture(o)
    tracker = opened_posture(opening(target))
    o = opening(kept)
    coupled, springs, contacts = yes(o), opened_springs(o), opened_contacts(o)
    if answering:
        if coupled:
            give(skeleton, received, dynamics.inverse_mass, springs.pressed, springs.rate)
        if not moving.any():
            return
    settings, memory = opened_settings(o), opened_memory(o)
    if not answering:
        if coupled:
            list_active(geometry, skeleton, memory, contacts)
            pull(
                geometry, skeleton, dynamics, poses, contacts, memory.goal.inverse_weight, dt, tracker, velocities, springs
            )
        elif springs.mass.shape[0] > 0:
            strike(skeleton, tracker, dt, velocities, springs)
        memory.counts[:] = 0
    elif memory.rows.size[COUNT] == 0 or memory.flags[LEAP] > 0.0:
        # nothing held it, or it went as far as its user leapt, and what is in the way is met in the next frame
        return
    follow(geometry, skeleton, tracker, settings, answering, moving, posture, poses, memory)


@kernel
def seek_opened(world: Index, kept: Index, way: Index) -> None:
    """`seek` on the arenas of a world, of what the loop keeps, and of the search."""
    o = opening(world)
    geometry, _ = opened_geometry(o), opened_dynamics(o)
    poses, _ = opened_poses(o), opened_velocities(o)
    skeleton, posture = opened_skeleton(o), opened_posture(o)
    o = opening(kept)
    yes(o)
    opened_springs(o)
    opened_contacts(o)
    settings, memory = opened_settings(o), opened_memory(o)
    seek(geometry, skeleton, settings, posture, poses, memory, opened_way(opening(way)))


class CheckedLoop:
    """The driven bodies of a world: every state shown was certified from the last one."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ("_noticed", "_told")
    WRITTEN: ClassVar[tuple[str, ...]] = ("_kept", "_way")
    KEPT: ClassVar[tuple[str, ...]] = ("springs", "contacts", "memory", "way")
    WORKING: ClassVar[tuple[str, ...]] = (
        *(f"{whose}.{name}" for whose in ("memory", "way.memory") for name in WORKING),
        "springs.mass", "springs.still", "way.spare", "contacts",
    )

    def __init__(
        self, world: World, settings: PostureSettings, coupling: CouplingSettings, seed: int = 0, *, record: bool = False
    ) -> None:
        self.world, self._moving, self._noticed = world, NOBODY, NOBODY
        kept_steps = STEPS_KEPT if record else 0
        memory = ready_memory(world.geometry, world.skeleton, world.posture, world.poses, settings, kept_steps)
        # without dynamics nobody gives back what pressing took, and the spring would run away
        coupled = world.scene.effects.coupling and world.scene.effects.dynamics
        springs = (
            make_springs(world.skeleton, world.dynamics, world.poses, coupling) if world.scene.effects.dynamics
            else no_springs(world.poses, coupling)
        )
        kept = (coupled, springs, make_contacts(ROW_CAP), settings, memory)
        self._kept, (_, self.springs, self.contacts, _, self.memory) = packed(kept)
        way = make_way(world.geometry, world.skeleton, world.posture, world.poses, memory, seed)
        self._way, self.way = packed(way)
        self._search_after, self._told = settings.search_after, 0
        # nobody is slow yet: it does nothing, and no frame has to wait for the compiler
        seek_opened(world.words, self._kept, self._way)

    def follow(self, target: Target, dt: float) -> None:
        """One frame towards the tracker's posture, which the springs displace by their offsets."""
        self._told = 0
        follow_opened(self.world.words, target.words, self._kept, dt, False, NOTHING_RECEIVED, self._noticed)
        # everybody has been looked at once
        self._noticed = self._moving
        if self.way.state.item(MODE) != IDLE or self.memory.flags.item(SLOW) >= self._search_after:
            seek_opened(self.world.words, self._kept, self._way)

    def ranges(self) -> Mapping[str, tuple[int, int]]:
        """Bodies, pieces, nodes of the tree, counts and flags; `posture.sound` says what holds between them."""
        geo, nodes = self.world.geometry, len(self.way.before)
        return {
            "springs.turn": (0, 1), "axis_stamp": (-1, MOST), "nearest_stamp": (-1, MOST), "listed": (0, len(geo.body) - 1),
            "failed": (0, len(geo.body) - 1), "age": (0, MOST), "near": (0, len(geo.first_shape) - 2), "marks": (0, MOST),
            "size": (0, ROW_CAP), "rows.pair": (-MOST, MOST),
            "way.before": (-1, nodes - 1), "leaves": (0, nodes - 1), "way.path": (-1, nodes - 1), "random": (1, MODULUS - 1),
            "state": (-1, MOST),
        }

    def go_on(self, begun: bool) -> None:
        """The memory was replaced by one of which a frame has, or has not, begun; InvalidSnapshot if it contradicts itself."""
        geo, skel = self.world.geometry, self.world.skeleton
        if not memory_is_sound(geo, skel, self.memory):
            raise InvalidSnapshot("memory of the posture", "pairs or bodies that are not there", "places of this scene")
        if not way_is_sound(geo, skel, self.way):
            raise InvalidSnapshot("memory of the search for a way", "nodes that are not there", "a tree, and room for it")
        self._noticed, self._told = self._moving if begun else NOBODY, 0

    def watch(self, moving: Index) -> None:
        """Look from now on only at whom `moving` (nb) names: the upper loop keeps it, who moved in its last frame."""
        self._moving = moving

    def receive(self, impulses: Array, moving: Index, target: Target) -> None:
        """Impulses (nb, 3) [N s] go into the springs; a driven body held by what is `moving` (nb) now goes on."""
        follow_opened(self.world.words, target.words, self._kept, 0.0, True, impulses, moving)

    def passed(self, time: float) -> tuple[Snapshot, ...]:
        """The states after the steps of this frame that were taken since this was last asked, at `time` [s], if the frame is
        recorded: links as they were left then, all else as it is now."""
        told, self._told = self._told, self.memory.counts.item(ADOPTED)
        return trail_snapshots(self.world, self.memory.trail[told : self._told], time)

    def counts(self) -> Tally:
        """Work done in the last frame."""
        return Tally(COUNT_NAMES, self.memory.counts.tobytes())

    def statuses(self) -> dict[str, int]:
        """What did not end well in the last frame, and how often."""
        counts = self.memory.counts.tolist()
        if BAD_OF(counts) == ALL_WELL:
            return {}
        found = {COUNT_NAMES[place]: counts[place] for place in BAD if counts[place]}
        if (kept := len(self.memory.trail)) and (lost := counts[ADOPTED] - kept) > 0:
            found["steps not recorded"] = lost
        return found
