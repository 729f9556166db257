"""Crowds: islands that advance by certified substeps keep time, overlap nowhere, gain no energy and come to rest."""

import numpy as np
import pytest

from avatarsim.rigid.settling import holds_from_rest
from avatarsim.rigid.sleeping import begin, regroup
from avatarsim.rigid.state import SEGMENTS, SUBSTEPS
from avatarsim.scene.shape import Box, ConvexHull
from tests.rigid.upper_world import World, ball, slab, thing

DT = 1.0 / 60.0


def heap(count: int, seed: int) -> list:
    """Boxes and hulls, one above the other, with random turns: what is round would roll away for ever."""
    rng, bodies = np.random.default_rng(seed), []
    for k in range(count):
        q = rng.normal(size=4)
        corners = rng.normal(size=(12, 3))
        hull = ConvexHull(0.05 * corners / np.linalg.norm(corners, axis=1)[:, None])
        shape = hull if k % 2 else Box(tuple(rng.uniform(0.04, 0.1, 3)))
        place = (*(0.06 * rng.uniform(-1.0, 1.0, 2) + 0.12 * np.array([k % 3 - 1.0, k // 3 % 3 - 1.0])), 0.1 + 0.12 * (k // 9))
        bodies.append(thing(f"o{k}", shape, place, 0.2, orientation=tuple(q / np.linalg.norm(q))))
    return bodies


def time_kept(places: np.ndarray, speeds: np.ndarray) -> float:
    """Way gone over the way that velocities say, over body-frames faster than 2 cm/s at both ends."""
    way, fast = np.linalg.norm(np.diff(places, axis=0), axis=-1), np.linalg.norm(speeds, axis=-1)
    moving = (fast[:-1] > 0.02) & (fast[1:] > 0.02)
    return float(way[moving].sum() / (0.5 * DT * (fast[:-1] + fast[1:]))[moving].sum())


@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_a_heap_falls_in_its_time_and_comes_to_rest(restitution: float) -> None:
    world = World([slab(), *heap(27, 1)], restitution, 0.4)
    energy, places, speeds, substeps = world.energy(), [], [], 0
    for _ in range(150):
        world.frame(record=False)
        substeps += int(world.memory.counts[SUBSTEPS])
        assert world.energy() <= energy + 1e-6 * abs(energy)
        assert world.gap() >= -1e-6
        energy = world.energy()
        places.append(world.poses.position[1:].copy())
        speeds.append(world.velocities.linear[1:].copy())
    assert substeps > 100
    assert time_kept(np.array(places), np.array(speeds)) > 0.97
    assert places[-1][:, 2].mean() < 0.08
    assert world.memory.asleep[1:].all()


def test_dominoes_fall_one_after_the_other() -> None:
    """The wave runs at about a metre a second: 15 dominoes 20 mm apart fall within 0.7 s."""
    first = np.radians(12.0)
    size = (0.0075, 0.024, 0.048)
    row = [thing(f"d{k}", Box(size), (0.02 * k, 0.0, 0.024 + 1e-6), 0.012) for k in range(1, 15)]
    x, z = np.sin(first) * size[2] / 2 - np.cos(first) * size[0] / 2, np.cos(first) * size[2] / 2 + np.sin(first) * size[0] / 2
    lean = thing("d0", Box(size), (x, 0.0, z + 1e-5), 0.012, orientation=(np.cos(first / 2), 0.0, np.sin(first / 2), 0.0))
    world = World([slab(), lean, *row], 0.2, 0.3)
    for _ in range(60):
        world.frame(record=False)
        assert world.gap() >= -1e-6
    up = world.poses.rotation[1:, 2, 2]
    assert (up < np.cos(np.radians(30.0))).all()


def test_a_heap_whose_islands_part_within_a_frame_goes_on() -> None:
    """200 balls in frames of 0.2 s: none goes to and fro between islands without end, and none gets the velocity of others."""
    random, balls = np.random.default_rng(3), []
    for k in range(200):
        at = 0.36 * np.array([k % 6 - 3.0, k // 6 % 6 - 3.0, k // 36]) + (0.0, 0.0, 0.23)
        balls.append(ball(f"ball_{k}", tuple(at), velocity=tuple(random.normal(size=3))))
    world = World([slab(), *balls], 0.4, 0.4)
    energy = world.energy()
    for _ in range(10):
        world.frame(0.2)
        assert world.memory.counts[SEGMENTS] < 6000
        assert world.energy() <= energy * (1.0 + 1e-9)
        energy = world.energy()


def held(bodies: list, friction: float) -> bool:
    """Whether the contacts of these bodies hold all of them from rest."""
    world = World([*bodies], 0.0, friction)
    memory = world.memory
    begin(world.geometry, world.dynamics, world.poses, world.velocities, DT, memory, True)
    regroup(world.geometry, world.dynamics, world.poses, world.velocities, memory, memory.all_bodies, 0.0, DT)
    islands = memory.islands
    assert islands.found[0] == 1
    members = islands.order[: islands.first[1]]
    for b in members:
        for i in range(3):
            for k in range(3):
                memory.inertia[b, i, k] = world.dynamics.inertia[b, i, k]
        memory.hold.inverse_inertia[b] = world.poses.rotation[b] @ world.dynamics.inverse_inertia[b] @ world.poses.rotation[b].T
    return bool(holds_from_rest(
        world.geometry, world.dynamics, world.poses, world.velocities, memory, members, DT / 4.0
    ))


def leaning(angle: float) -> list:
    """A box of 0.1 x 0.1 x 0.4 m on one edge, its centre of mass this angle [rad] before it stands above that edge."""
    balance = np.arctan(0.1 / 0.4) - angle
    lift = 0.05 * np.sin(balance) + 0.2 * np.cos(balance) + 2e-8
    q = (np.cos(balance / 2), 0.0, np.sin(balance / 2), 0.0)
    return [slab(), thing("box", Box((0.1, 0.1, 0.4)), (0.0, 0.0, lift), orientation=q)]


def test_rest_is_what_contacts_hold() -> None:
    stack = [slab(), *(thing(f"b{k}", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + 0.2 * k + (k + 1) * 2e-7)) for k in range(5))]
    assert held(stack, 0.5)
    assert not held(leaning(0.01), 0.5)
    assert not held(leaning(-0.01), 0.5)


@pytest.mark.parametrize(("friction", "rests"), [(1.01, True), (0.99, False)])
def test_a_box_on_a_slope_rests_by_its_friction(friction: float, rests: bool) -> None:
    angle = 0.3
    q = (np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0)
    normal = np.array([np.sin(angle), 0.0, np.cos(angle)])
    ramp = slab((4.0, 4.0, 0.2), position=tuple(-0.1 * normal), orientation=q)
    box = thing("box", Box((0.2, 0.2, 0.1)), tuple((0.05 + 2e-7) * normal), orientation=q)
    assert held([ramp, box], friction * np.tan(angle)) == rests
