"""Speculative contacts: bodies that would meet in an inelastic fallback step come as near as that allows, and lose no time."""

import numpy as np
import pytest

from avatarsim.collision.path import FREE, HELD
from avatarsim.rigid.budget_fallback import look_ahead, of_balls
from avatarsim.rigid.clocks import depart, go_back
from avatarsim.rigid.contact_generation import FOUND, NO_ROOM, find_contacts
from avatarsim.rigid.island_step import change_back, spend
from avatarsim.rigid.islands import part
from avatarsim.rigid.response import change_at_once, note_change
from avatarsim.rigid.resting import aim_at_once
from avatarsim.rigid.sleeping import begin, regroup
from avatarsim.rigid.state import PLASTIC, SEGMENTS
from avatarsim.scene.shape import Box
from tests.rigid.upper_world import G, World, ball, slab, thing

H = 1.0 / 60.0


def foreseen(bodies: list, pairs: list, h: float = H) -> World:
    """A world after `look_ahead` with no bodies in touch."""
    world = World(bodies, 0.0, 0.5)
    world.memory.moving[:] = [name != "slab" for name in (body.name for body in bodies)]
    world.memory.contacts.used[0] = 0
    near = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    look_ahead(world.geometry, world.dynamics, world.poses, world.velocities, near, world.memory, h)
    return world


@pytest.mark.nojit
@pytest.mark.boundscheck
@pytest.mark.parametrize(("speed", "found"), [(0.0, 0), (0.5, 0), (0.7, 1), (30.0, 1)])
def test_only_who_comes_near_enough_is_foreseen(speed: float, found: int) -> None:
    """Two balls a centimetre apart side by side: 0.6 m/s close that in a frame, whatever gravity does."""
    bodies = [slab(), ball("a", (0.0, 0.0, 1.0), velocity=(speed, 0.0, 0.0)), ball("b", (0.21, 0.0, 1.0))]
    world = foreseen(bodies, [[1, 2]])
    contacts = world.memory.contacts
    assert contacts.used[0] == found
    if found:
        assert contacts.gap[0] == pytest.approx(0.01) and contacts.friction[0] == 0.0


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_a_body_may_fall_on_one_that_is_held() -> None:
    """Both fall alike until the floor holds the lower one, which `look_ahead` does not know: gravity counts for one of them."""
    for gap, found in ((0.5 * G * H * H, 1), (2.0 * G * H * H, 0)):
        bodies = [slab(), ball("low", (0.0, 0.0, 5.0)), ball("high", (0.0, 0.0, 5.2 + gap))]
        assert foreseen(bodies, [[1, 2]]).memory.contacts.used[0] == found


def test_a_box_is_foreseen_by_balls_alone() -> None:
    box = thing("box", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.11), velocity=(0.0, 0.0, -1.0))
    comer = ball("ball", (0.21, 0.0, 0.11), velocity=(-1.0, 0.0, 0.0))
    contacts = foreseen([slab(), box, comer], [[0, 1], [1, 2]]).memory.contacts
    assert contacts.used[0] == 1 and contacts.body[0].tolist() == [1, 2]
    assert contacts.gap[0] == pytest.approx(0.01)


def test_a_table_that_is_full_is_said() -> None:
    world = World([slab(), ball("a", (0.0, 0.0, 1.0)), ball("b", (0.2, 0.0, 1.0), velocity=(-1.0, 0.0, 0.0))], 0.0)
    memory, pairs = world.memory, np.array([[1, 2]])
    memory.moving[1:] = 1
    outcomes = []
    for used in (memory.contacts.gap.shape[0], 0):
        memory.contacts.used[0] = used
        outcomes.append(look_ahead(world.geometry, world.dynamics, world.poses, world.velocities, pairs, memory, H))
    assert outcomes == [NO_ROOM, FOUND]


def test_only_balls_take_one_solve() -> None:
    world = foreseen([slab(), ball("a", (0.0, 0.0, 0.1)), thing("box", Box((0.2, 0.2, 0.2)), (1.0, 0.0, 0.1))], [])
    for pairs, found in (([[0, 1]], True), ([[0, 1], [0, 2]], False)):
        find_contacts(world.geometry, world.dynamics, world.poses, world.velocities, np.array(pairs), world.memory)
        assert world.memory.contacts.used[0] > 0 and of_balls(world.memory) == found


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_straight_ways_close_no_gap() -> None:
    """What a contact is asked for brings it to touch at the end of the step, and not before, however it bends."""
    world = foreseen([slab(), ball("ball", (0.0, 0.0, 0.11), velocity=(0.0, 0.0, -2.0))], [[0, 1]])
    contacts, v = world.memory.contacts, world.velocities
    sign = float(contacts.frame[0, 0, 2])
    for bend in (-3.0, 0.0, 3.0):
        contacts.bend[0] = (0.0, 0.0, sign * bend)
        aim_at_once(contacts, H, v.linear, v.angular)
        t = np.linspace(0.0, H, 50)
        gaps = contacts.gap[0] + contacts.target[0] * t + 0.5 * bend * t * t
        assert gaps.min() > 0.0
        assert gaps[-1] < 1e-6 + max(0.0, 0.5 * bend * H * H)


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_velocities_change_at_once_for_who_is_held_and_back_again() -> None:
    world = World([slab(), ball("a", (0.0, 0.0, 1.0)), ball("b", (0.0, 0.0, 2.0))], 0.0)
    memory, v = world.memory, world.velocities.linear
    memory.paths.kind[1:] = HELD, FREE
    v[1:], memory.linear_end[1:] = 1.0, 2.0
    before, members = v.copy(), np.array([1, 2])
    change_at_once(world.velocities, memory, members)
    assert v[:, 0].tolist() == [0.0, 2.0, 1.0]
    change_at_once(world.velocities, memory, members)
    np.testing.assert_array_equal(v, before)


def test_a_heap_whose_islands_part_in_a_plastic_step_goes_on() -> None:
    """200 balls, looked at every 0.2 s: one that goes on at once may leave its island or join another, and neither changes to and
    fro without end, nor gives one the velocities of others."""
    random = np.random.default_rng(3)
    balls = []
    for k in range(200):
        random.integers(1), random.uniform()
        random.normal(size=4)
        at = 0.36 * np.array([k % 6 - 3.0, k // 6 % 6 - 3.0, k // 36]) + (0.0, 0.0, 0.23)
        balls.append(ball(f"ball_{k}", tuple(at), velocity=tuple(random.normal(size=3)),
                          angular_velocity=tuple(4.0 * random.normal(size=3))))
    world = World([slab(), *balls], 0.4, 0.4)
    energy = world.energy()
    for _ in range(15):
        world.frame(0.2)
        assert world.memory.counts[SEGMENTS] < 2000
        assert world.energy() <= energy * (1.0 + 1e-12)
        energy = world.energy()


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_islands_formed_anew_give_nobody_the_velocities_of_others() -> None:
    """A ball leaves an island that went on at once: that is undone for both, and not for the one in its place."""
    world = World([slab(), *(ball(name, (float(k), 0.0, 1.0)) for k, name in enumerate("abcd"))], 0.0)
    memory, v = world.memory, world.velocities.linear
    islands = memory.islands
    memory.paths.kind[1:], memory.moving[1:], memory.joins[1:] = HELD, 1, 1
    v[1:], memory.linear_end[1:] = 1.0, 2.0
    before = v.copy()
    part(islands, np.array([[1, 3]]), 1, memory.moving, memory.joins)
    members = islands.order[:2]
    memory.counts[SEGMENTS] = 7
    spend(memory, members, 1)
    change_at_once(world.velocities, memory, members)
    assert v[:, 0].tolist() == [0.0, 2.0, 1.0, 2.0, 1.0]
    part(islands, np.zeros((0, 2), np.int64), 0, memory.moving, memory.joins)
    assert members.tolist() == [1, 2]
    change_back(world.velocities, memory)
    np.testing.assert_array_equal(v, before)
    # the number of a segment of the last frame is not taken for one of this
    begin(world.geometry, world.dynamics, world.poses, world.velocities, 1.0 / 60.0, memory, True)
    assert not islands.charged.any()


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_who_goes_back_gains_no_energy() -> None:
    """A ball that got all gravity of a step at once and is called back half way has had half of it."""
    world = World([slab(), ball("ball", (0.0, 0.0, 1.0), velocity=(0.5, 0.0, 0.0))], 0.0)
    energy, memory, members = world.energy(), world.memory, np.array([1])
    before = world.velocities.linear[1].copy()
    memory.moving[1] = 1
    memory.paths.kind[1], memory.paths.time[1] = HELD, -1.0
    memory.linear_end[1] = before - (0.0, 0.0, G * H)
    change_at_once(world.velocities, memory, members)
    depart(world.poses, world.velocities, memory, members, 0.0)
    note_change(memory, members)
    memory.islands.due[1] = H
    go_back(world.geometry, world.poses, world.velocities, memory, 1, 0.5 * H)
    np.testing.assert_allclose(world.velocities.linear[1], before - (0.0, 0.0, 0.5 * G * H))
    assert world.energy() <= energy
    go_back(world.geometry, world.poses, world.velocities, memory, 1, 0.0)
    np.testing.assert_allclose(world.velocities.linear[1], before)
    assert world.energy() == pytest.approx(energy, abs=1e-12)


def test_who_went_ahead_is_called_back_at_the_start_of_a_frame() -> None:
    """A body that comes near is where the frame begins; an island whose first body has gone to its end would leave it there."""
    world = World([slab(), ball("a", (0.0, 0.0, 1.0)), ball("b", (0.3, 0.0, 1.0), velocity=(-20.0, 0.0, 0.0))], 0.0)
    memory = world.memory
    begin(world.geometry, world.dynamics, world.poses, world.velocities, 1.0 / 60.0, memory, True)
    memory.islands.due[1], memory.paths.time[:] = H, -1.0
    regroup(world.geometry, world.dynamics, world.poses, world.velocities, memory, memory.all_bodies, 0.0, H)
    assert memory.islands.label[1] == memory.islands.label[2]
    assert memory.islands.due.tolist() == [0.0, 0.0, 0.0]


def heap(side: int) -> list:
    """A lattice of balls, sheared by a hair, a little above the floor."""
    spots = [(i, j, k) for k in range(side) for j in range(side) for i in range(side)]
    places = [(0.2002 * i + 0.004 * k, 0.2002 * j + 0.002 * k, 0.101 + 0.2002 * k) for i, j, k in spots]
    return [ball(f"ball_{n}", place) for n, place in enumerate(places)]


def test_a_heap_that_topples_loses_little_time() -> None:
    """Five layers of balls come down at 60 Hz nearly as at 960 Hz, though their frames end in plastic steps."""
    heights = []
    for rate in (60, 960):
        world, plastic = World([slab(), *heap(5)], 0.3, 0.3), 0
        energy = world.energy()
        for _ in range(rate):
            world.frame(1.0 / rate, record=False)
            plastic += int(world.memory.counts[PLASTIC])
            assert world.energy() <= energy + 1e-9 * abs(energy)
            energy = world.energy()
        assert plastic > 20 and world.gap() >= -1e-6
        heights.append(world.poses.position[1:, 2].mean())
    assert abs(heights[0] - heights[1]) < 0.05
