"""Frames through the arenas against the same kernels called one by one on plain arrays: every bit is the same."""

import numpy as np
import pytest

from avatarsim.ik.state import make_contacts
from avatarsim.impact.events import make_events
from avatarsim.loops.active_rows import list_active
from avatarsim.loops.checked import NOBODY, CheckedLoop
from avatarsim.loops.coupling import give, make_springs, pull
from avatarsim.loops.simulated import SimulatedLoop
from avatarsim.loops.upper import advance
from avatarsim.loops.upper_memory import Switches
from avatarsim.loops.upper_memory import make_memory as make_upper_memory
from avatarsim.posture.follow import follow
from avatarsim.posture.leap_round import seek
from avatarsim.posture.way_memory import IDLE, MODE, make_way
from avatarsim.posture.workspace import COUNT, LEAP, ROW_CAP, SLOW, ready_memory
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import Chosen
from avatarsim.world.target import Target
from avatarsim.world.world import build, posture_of
from scenarios import catalog
from tests.world.test_arena import leaves

CHOSEN = Chosen()


class Plain:
    """The frame of method `default` on arrays that stand alone."""

    def __init__(self, scene: Scene) -> None:
        self.world = world = build(scene)
        self.geo, self.skel, self.dyn = plain(world.geometry), plain(world.skeleton), plain(world.dynamics)
        self.poses, self.velocities, self.posture = plain(world.poses), plain(world.velocities), plain(world.posture)
        on = scene.effects
        self.coupled = on.coupling
        self.lower = ready_memory(self.geo, self.skel, self.posture, self.poses, CHOSEN.posture)
        self.way = make_way(self.geo, self.skel, self.posture, self.poses, self.lower, 0)
        self.springs = make_springs(self.skel, self.dyn, self.poses, CHOSEN.coupling)
        self.contacts = make_contacts(ROW_CAP)
        self.upper = make_upper_memory(self.geo, self.dyn, self.poses, on.gyroscopic)
        self.events = make_events(len(scene.names), 64)
        self.switches = Switches(on.gyroscopic, on.continuous, on.sleeping, False, True)

    def frame(self, sample: TrackerSample, dt: float) -> None:
        """One frame."""
        target = posture_of(self.skel, self.world.hinges, sample)
        if self.coupled:
            list_active(self.geo, self.skel, self.lower, self.contacts)
            weight = self.lower.goal.inverse_weight
            pull(self.geo, self.skel, self.dyn, self.poses, self.contacts, weight, dt, target, self.velocities, self.springs)
        self.lower.counts[:] = 0
        follow(self.geo, self.skel, target, CHOSEN.posture, False, NOBODY, self.posture, self.poses, self.lower)
        if self.way.state[MODE] != IDLE or self.lower.flags[SLOW] >= CHOSEN.posture.search_after:
            seek(self.geo, self.skel, CHOSEN.posture, self.posture, self.poses, self.lower, self.way)
        advance(self.geo, self.dyn, self.poses, self.velocities, dt, self.upper, self.events, self.switches)
        if self.coupled:
            give(self.skel, self.upper.received, self.dyn.inverse_mass, self.springs.pressed, self.springs.rate)
            if self.upper.moving.any() and self.lower.rows.size[COUNT] > 0 and self.lower.flags[LEAP] == 0.0:
                follow(self.geo, self.skel, target, CHOSEN.posture, True, NOBODY, self.posture, self.poses, self.lower)


def plain(tree: tuple) -> tuple:
    """Nested tuples over copies of the arrays; nothing in a world is an alias."""
    parts = [plain(b) if isinstance(b, tuple) else b.copy() if isinstance(b, np.ndarray) else b for b in tree]
    return type(tree)(*parts)


@pytest.mark.parametrize(
    ("name", "first", "last"), [("hand_over_table", 455, 500), ("hand_over_table", 780, 880), ("mocap_walk_wall", 40, 90)]
)
def test_frames_through_arenas_are_the_same_to_the_last_bit(name: str, first: int, last: int) -> None:
    scenario = catalog.get(name)
    scene = scenario.build()
    motion = (scenario.short_motion or scenario.motion)(scene, 0)
    apart, world = Plain(scene), build(scene)
    target, lower = Target(world), CheckedLoop(world, CHOSEN.posture, CHOSEN.coupling)
    upper = SimulatedLoop(world, paper=False, record=True)
    # the plain one looks at everybody in every frame
    lower.watch(upper.memory.moving)
    worked = 0
    for k in range(first, last):
        sample = motion(k)
        apart.frame(sample, scenario.dt)
        target.read(sample)
        lower.follow(target, scenario.dt)
        upper.advance(scenario.dt)
        if scene.effects.coupling:
            lower.receive(upper.memory.received, upper.memory.moving, target)
        mine = (world.poses, world.velocities, world.posture, lower.memory, lower.way, upper.memory)
        theirs = (apart.poses, apart.velocities, apart.posture, apart.lower, apart.way, apart.upper)
        for a, b in zip(leaves(mine), leaves(theirs), strict=True):
            assert a.tobytes() == b.tobytes()
        worked += int(lower.memory.counts.sum())
    assert worked > 0
