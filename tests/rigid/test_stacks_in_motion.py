"""Stacks and crowds in motion: no overlap stays, no energy appears, time and momentum are kept, and all come to rest."""

from itertools import product

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.rigid.settling import holds_from_rest
from avatarsim.rigid.sleeping import begin, regroup
from avatarsim.rigid.state import (
    CONTACTS,
    DONE,
    OUT_OF_IMPACTS,
    OUT_OF_SEGMENTS,
    SEGMENTS,
    SQUEEZED,
    SUBSTEPS,
    UNSQUEEZED,
    WORK,
)
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.shape import Box, ConvexHull, Piece
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog
from scenarios.catalog.hard import seams
from tests.rigid.upper_world import G, World, ball, slab, thing


def tower(boxes: int, lift: float) -> list:
    """Return boxes of 0.2 m, one on the other, the lowest ``lift`` above the slab."""
    return [thing(f"box_{k}", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + lift + k * (0.2 + 2e-8))) for k in range(boxes)]


def test_a_struck_tower_comes_down() -> None:
    """A ball at 6 m/s: two seconds of impacts, slipping edges and landings; where it halted, bodies had speed and stayed."""
    world = World([slab(), *tower(5, 2e-8), ball("ball", (-0.8, 0.02, 0.5), mass=4.0, velocity=(6.0, 0.0, 0.0))], 0.3, 0.4)
    energy = world.energy()
    for _ in range(120):
        before, fast = world.poses.position.copy(), np.linalg.norm(world.velocities.linear, axis=1) > 0.01
        world.frame()
        still = np.linalg.norm(world.poses.position - before, axis=1) < 1e-9
        assert not (fast & still & (np.linalg.norm(world.velocities.linear, axis=1) > 0.01)).any()
        assert world.energy() <= energy + 1e-9
        energy = world.energy()
        assert world.gap() >= -1e-6
        assert world.memory.counts[WORK] < 400000
    assert world.poses.position[5, 2] < 0.5


@pytest.mark.parametrize("lift", [0.001, 0.01])
def test_a_dropped_tower_rests(lift: float) -> None:
    """Five boxes fall by a millimetre or a centimetre and lie still within two seconds."""
    world = World([slab(), *tower(5, lift)], 0.3, 0.5)
    for _ in range(120):
        world.frame()
        assert world.gap() >= -1e-6
    assert not world.velocities.linear.any() and not world.velocities.angular.any()


def test_a_wall_that_lands_keeps_its_budget() -> None:
    """Sixteen rows of bricks, each a centimetre above the one below: a thousand contacts at once, for which no frame has time."""
    bricks = [
        thing(f"brick_{row}_{k}", Box((0.2, 0.1, 0.1)), (0.202 * (k + 0.5 * row), 0.0, 0.11 * (row + 1) - 0.05), 2.0)
        for row in range(16) for k in range(16 - row)
    ]
    world = World([slab(), *bricks], 0.3, 0.5)
    energy, least, most, contacts = world.energy(), 0.0, 0, 0
    for k in range(24):
        status = world.frame(record=False, sleeping=False)
        assert status in (DONE, OUT_OF_SEGMENTS, OUT_OF_IMPACTS)
        assert world.energy() <= energy + 1e-6 * abs(energy)
        energy, most = world.energy(), max(most, int(world.memory.counts[WORK]))
        contacts = max(contacts, int(world.memory.counts[CONTACTS]))
        least = min(least, world.gap()) if k % 6 == 5 else least
    assert contacts > 1000
    # without a budget of visits it took four millions
    assert most < 700000
    assert least >= -1e-6


@pytest.mark.parametrize("ratio", [1.0, 10.0, 1e2, 1e3, 1e4])
@pytest.mark.parametrize("boxes", [1, 3])
def test_a_heavy_box_stands_on_light_ones(ratio: float, boxes: int) -> None:
    """Each begins a millimetre above the one below. At 1e5 to 1 it takes ten seconds to rest; from a million to one on the budget
    of impacts of every frame is spent on rebounds between floor and heavy box, and the light one hangs in the air."""
    tall = [thing(f"box_{k}", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + 0.2 * k + 1e-3 * (k + 1)), 1.0) for k in range(boxes)]
    heavy = thing("heavy", Box((0.2, 0.2, 0.2)), (0.0, 0.0, 0.1 + 0.2 * boxes + 1e-3 * (boxes + 1)), ratio)
    world = World([slab(), *tall, heavy], 0.0, 0.5)
    energy = world.energy()
    for _ in range(300):
        world.frame()
        # contacts that have dipped open by less than a micrometre
        assert world.energy() <= energy + 1e-6 * G * (boxes + ratio)
        energy = world.energy()
        assert world.gap() >= -1e-6
    assert not world.velocities.linear.any() and not world.velocities.angular.any()
    heights = [0.1 + 0.2 * k for k in range(boxes + 1)]
    np.testing.assert_allclose(world.poses.position[1:, 2], heights, rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(world.poses.position[1:, :2], 0.0, rtol=0.0, atol=1e-4)


DEEP = 3e-6
"""Depth [m] of the lowest box in the floor, and of each in the one below, at the start: three times the largest shown."""


def pressed(boxes: int, ratio: float) -> World:
    """Return boxes of 1 kg on one another, and one of ``ratio`` kg on them, all in each other."""
    edges = Box((0.2, 0.2, 0.2))
    masses = [1.0] * boxes + [ratio]
    things = [thing(f"box_{k}", edges, (0.0, 0.0, 0.1 + 0.2 * k - DEEP * (k + 1)), m) for k, m in enumerate(masses)]
    return World([slab(), *things], 0.0, 0.5)


@pytest.mark.parametrize("boxes", [1, 3])
@pytest.mark.parametrize("ratio", [1.0, 1e2, 1e3, 1e4, 1e6])
def test_what_is_held_down_by_a_ton_rises_too(boxes: int, ratio: float) -> None:
    """By mass alone the lowest box would rise into the one above and come down into the floor again, for ever."""
    world = pressed(boxes, ratio)
    status = world.frame()
    assert world.memory.counts[UNSQUEEZED] == 1
    assert status != SQUEEZED
    assert world.gap() >= -7e-7


def test_who_is_light_gives_way_first() -> None:
    """A ball in a heavy one: where mass alone is enough it decides, and the centre of mass stays."""
    heavy, light = ball("heavy", (0.0, 0.0, 0.0), mass=1e3), ball("light", (0.0, 0.0, 0.2 - 2.0 * DEEP))
    world = World([heavy, light], gravity=(0.0, 0.0, 0.0))
    assert world.frame() == DONE
    rise = world.poses.position[1, 2] - (0.2 - 2.0 * DEEP)
    assert rise == pytest.approx(2.0 * DEEP + 2e-8, rel=2e-3)
    assert 1e3 * world.poses.position[0, 2] + rise == pytest.approx(0.0, abs=1e-12)
    assert not world.velocities.linear.any()


def test_a_ball_in_a_slot_too_narrow_for_it_is_squeezed() -> None:
    """No place for it is free, and the frame's status is that, whatever else happens in it."""
    lid = fixed("lid", (Piece(Box((4.0, 4.0, 1.0))),), "m", (0.0, 0.0, 0.7 - 2.0 * DEEP))
    others = [thing(f"box_{k}", Box((0.1, 0.1, 0.1)), (3.0 + k, 0.0, 0.5), angular_velocity=(3.0, 2.0, 1.0)) for k in range(3)]
    world = World([slab(), lid, ball("ball", (0.0, 0.0, 0.1 - DEEP)), *others], 0.3, 0.5)
    assert [world.frame(sleeping=False) for _ in range(30)] == [SQUEEZED] * 30


DT = 1.0 / 60.0


def heap(count: int, seed: int) -> list:
    """Return boxes and hulls, one above the other, with random turns: round bodies would roll away for ever."""
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
    """Return the way gone over the way by velocities, over body-frames faster than 2 cm/s at both ends."""
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
    """Return whether the contacts of these bodies hold all of them from rest."""
    world = World([*bodies], 0.0, friction)
    memory = world.memory
    begin(world.geometry, world.dynamics, world.poses, world.velocities, DT, memory, True)
    regroup(world.geometry, world.dynamics, world.poses, world.velocities, memory, memory.all_bodies, 0.0, DT, False)
    islands = memory.islands
    assert islands.found[0] == 1
    members = islands.order[: islands.first[1]]
    for b in members:
        for i in range(3):
            for k in range(3):
                memory.inertia[b, i, k] = world.dynamics.inertia[b, i, k]
        memory.masses.inverse_inertia[b] = world.poses.rotation[b] @ world.dynamics.inverse_inertia[b] @ world.poses.rotation[b].T
    return bool(holds_from_rest(
        world.geometry, world.dynamics, world.poses, world.velocities, memory, members, DT / 4.0
    ))


def leaning(angle: float) -> list:
    """Return a box of 0.1 x 0.1 x 0.4 m on one edge, its centre of mass this angle [rad] short of the balance above that edge."""
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


CUBE, GAP = 0.1, 5e-5
"""Edge of the cubes, and how far apart they begin [m]: the stand-off of a crowd."""


def blocks(counts: tuple[int, int, int], velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> list[Body]:
    """Return cubes in rows, columns and layers; the first is at the origin, on the ground."""
    found = []
    for i, j, k in product(*map(range, counts)):
        place = (np.array([i, j, k]) + (0.0, 0.0, 0.5)) * CUBE + (k + 1) * np.array([0.0, 0.0, GAP]) + np.array([i, j, 0.0]) * GAP
        found.append(thing(f"cube {i} {j} {k}", Box((CUBE,) * 3), tuple(place), 0.3, velocity=velocity))
    return found


def run_as_crowd(world: World, seconds: float, dt: float = DT) -> float:
    """Advance a world whose bodies are a crowd; returns the largest gain of energy of a frame [J]. Nothing may overlap."""
    energy, gain = world.energy(), 0.0
    for _ in range(round(seconds / dt)):
        world.memory.substeps.crowd[:] = 1
        world.frame(dt, record=False)
        gain, energy = max(gain, world.energy() - energy), world.energy()
    assert world.gap() >= -1e-6
    return gain


def test_momentum_of_groups_that_meet_on_ice_stays() -> None:
    behind = blocks((3, 3, 3), (1.0, 0.0, 0.0))
    ahead = [
        thing(f"{body.name} ahead", Box((CUBE,) * 3), tuple(np.asarray(body.position) + (0.5, 0.02, 0.0)), 0.3)
        for body in blocks((3, 3, 3))
    ]
    world = World([slab(), *behind, *ahead], 0.0, 0.0)
    assert run_as_crowd(world, 1.0) < 1e-9
    assert world.velocities.linear[1:, 0].mean() == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize(("lean", "dt"), [(0.003, 2e-3), (0.003, 1.0 / 60.0), (0.02, 1.0 / 60.0), (0.003, 1.0 / 30.0)])
def test_what_leans_beyond_its_balance_on_a_crowd_at_rest_falls(lean: float, dt: float) -> None:
    angle = np.arctan(0.06 / 0.3) + lean
    height = 0.03 * np.sin(angle) + 0.15 * np.cos(angle)
    edge = 0.03 * np.cos(angle) - 0.15 * np.sin(angle)
    place = (1.5 * CUBE - edge, 1.5 * CUBE, 2.0 * (CUBE + GAP) + height + GAP)
    tall = thing("tall", Box((0.06, 0.06, 0.3)), place, 0.5, orientation=(np.cos(angle / 2.0), 0.0, np.sin(angle / 2.0), 0.0))
    world = World([slab(), *blocks((4, 4, 2)), tall], 0.0, 0.5)
    assert run_as_crowd(world, 1.5, dt) < 1e-9
    assert abs(world.poses.rotation[-1, 2, 2]) < 0.1


def test_a_crowd_on_ice_slides_down_one_degree_as_one_body_does() -> None:
    down = np.radians(1.0)
    world = World([slab(), *blocks((3, 3, 5))], 0.0, 0.0, gravity=(G * np.sin(down), 0.0, -G * np.cos(down)))
    before = world.poses.position[1:, 0].copy()
    run_as_crowd(world, 1.0)
    assert world.velocities.linear[1:, 0].mean() == pytest.approx(G * np.sin(down), rel=2e-3)
    assert (world.poses.position[1:, 0] - before).mean() == pytest.approx(0.5 * G * np.sin(down), rel=0.01)


def test_a_pallet_of_packed_boxes_rests() -> None:
    """144 boxes, each next to four others: more contacts than a wall has."""
    world = World([slab(), *blocks((12, 12, 1))], 0.0, 0.5)
    run_as_crowd(world, 0.5)
    assert world.memory.asleep[1:].all()
    assert (abs(world.poses.position[1:, 2] - 0.5 * CUBE - GAP) < GAP).all()


def test_a_heap_of_bodies_of_many_pieces_falls_to_rest() -> None:
    """12 bodies of 64 pieces: 270,000 pairs of pieces, of which few are near."""
    edge, cells = 0.025, np.arange(4) - 1.5
    pieces = tuple(Piece(Box((edge,) * 3), position=tuple(edge * np.array(at))) for at in product(cells, cells, cells))
    bodies = [
        simulated(f"b{k}", pieces, "m", solid(pieces, 0.5), position=(0.102 * x, 0.102 * y, 0.06 + 0.11 * z))
        for k, (z, y, x) in enumerate(product(range(3), range(2), range(2)))
    ]
    world = World([slab(), *bodies], 0.0, 0.4)
    run_as_crowd(world, 1.5)
    assert world.memory.asleep[1:].all()
    assert world.poses.position[1:, 2].min() == pytest.approx(0.05, abs=1e-4)


def test_crowded_boxes_slide_over_seams_as_over_one_piece() -> None:
    """Straight, leaning and crossed seams, bodies of one piece and of three: v^2 / (2 mu g), to the error of the time steps."""
    scenario = catalog.get("seams")
    scene, engine = scenario.build(), AvatarsimEngine()
    motion = scenario.motion(scene, 0)
    first = engine.load(scene, Settings(), scenario.dt).shown.positions
    for frame in range(60):
        engine._running().upper.memory.substeps.crowd[:] = 1
        shown = engine.advance(motion(frame), scenario.dt).shown
    boxes = [scene.names.index(name) for name in ("straight", "turned", "leaning", "pieces", "askew", "bottom")]
    gone = np.linalg.norm(shown.positions[boxes] - first[boxes], axis=1)
    assert gone == pytest.approx(seams.SPEED**2 / (2.0 * seams.FRICTION * seams.GRAVITY), rel=0.02)
