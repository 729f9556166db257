"""How crowds move: groups keep their momentum, what leans falls, what slides on ice goes on, at any frame time."""

from itertools import product

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.body import Body, simulated, solid
from avatarsim.scene.shape import Box, Piece
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog
from scenarios.catalog.hard import seams
from tests.rigid.upper_world import G, World, slab, thing

DT = 1.0 / 60.0
CUBE, GAP = 0.1, 5e-5
"""Edge of the cubes, and how far apart they begin [m]: the stand-off of a crowd."""


def blocks(counts: tuple[int, int, int], velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> list[Body]:
    """Cubes in rows, columns and layers; the first is at the origin, on the ground."""
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


def test_a_group_that_slides_on_ice_keeps_its_momentum() -> None:
    world = World([slab(), *blocks((3, 3, 7), (1.0, 0.0, 0.0))], 0.0, 0.0)
    assert run_as_crowd(world, 1.0) < 1e-9
    assert world.velocities.linear[1:, 0].mean() == pytest.approx(1.0, abs=1e-3)


def test_momentum_of_groups_that_meet_on_ice_stays() -> None:
    behind = blocks((3, 3, 3), (1.0, 0.0, 0.0))
    ahead = [
        thing(f"{body.name} ahead", Box((CUBE,) * 3), tuple(np.asarray(body.position) + (0.5, 0.02, 0.0)), 0.3)
        for body in blocks((3, 3, 3))
    ]
    world = World([slab(), *behind, *ahead], 0.0, 0.0)
    assert run_as_crowd(world, 1.0) < 1e-9
    assert world.velocities.linear[1:, 0].mean() == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("dt", [1e-3, 1.0 / 60.0, 1.0 / 30.0])
@pytest.mark.parametrize("lean", [0.003, 0.02])
def test_what_leans_beyond_its_balance_on_a_crowd_at_rest_falls(lean: float, dt: float) -> None:
    angle = np.arctan(0.06 / 0.3) + lean
    height = 0.03 * np.sin(angle) + 0.15 * np.cos(angle)
    edge = 0.03 * np.cos(angle) - 0.15 * np.sin(angle)
    place = (1.5 * CUBE - edge, 1.5 * CUBE, 3.0 * (CUBE + GAP) + height + GAP)
    tall = thing("tall", Box((0.06, 0.06, 0.3)), place, 0.5, orientation=(np.cos(angle / 2.0), 0.0, np.sin(angle / 2.0), 0.0))
    world = World([slab(), *blocks((4, 4, 3)), tall], 0.0, 0.5)
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
    """144 boxes, each beside four others: more contacts than a wall has."""
    world = World([slab(), *blocks((12, 12, 1))], 0.0, 0.5)
    run_as_crowd(world, 0.5)
    assert world.memory.asleep[1:].all()
    assert (abs(world.poses.position[1:, 2] - 0.5 * CUBE - GAP) < GAP).all()


def test_a_heap_of_bodies_of_many_pieces_falls_to_rest() -> None:
    """27 bodies of 64 pieces: 1.4 million pairs of pieces, of which few are near."""
    edge, cells = 0.025, np.arange(4) - 1.5
    pieces = tuple(Piece(Box((edge,) * 3), position=tuple(edge * np.array(at))) for at in product(cells, cells, cells))
    bodies = [
        simulated(f"b{k}", pieces, "m", solid(pieces, 0.5), position=(0.102 * x, 0.102 * y, 0.06 + 0.11 * z))
        for k, (z, y, x) in enumerate(product(range(3), range(3), range(3)))
    ]
    world = World([slab(), *bodies], 0.0, 0.4)
    run_as_crowd(world, 1.5)
    assert world.memory.asleep[1:].all()
    assert world.poses.position[1:, 2].min() == pytest.approx(0.05, abs=1e-4)


def test_boxes_in_a_crowd_slide_over_seams_as_far_as_over_one_piece() -> None:
    """Straight, leaning and crossed seams, bodies of one piece and of three: v^2 / (2 mu g), to the error of the time steps."""
    scenario = catalog.get("seams")
    scene, engine = scenario.build(), AvatarsimEngine()
    motion = scenario.motion(scene, 0)
    first = engine.load(scene, Settings(), scenario.dt).shown.positions
    for frame in range(60):
        engine._frames.upper.memory.substeps.crowd[:] = 1
        shown = engine.advance(motion(frame), scenario.dt).shown
    boxes = [scene.names.index(name) for name in ("straight", "turned", "leaning", "pieces", "askew", "bottom")]
    gone = np.linalg.norm(shown.positions[boxes] - first[boxes], axis=1)
    assert gone == pytest.approx(seams.SPEED**2 / (2.0 * seams.FRICTION * seams.GRAVITY), rel=0.02)
