"""Certificate of a substep against its twin: signed distances at many instants of the way."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.collision.path import HELD
from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.rigid.substep_state import UNKNOWN
from avatarsim.rigid.swept_certificate import LEAST, certify_pieces, least_between, least_of, measure_motion, pose_at
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Shape, Sphere
from avatarsim.tolerances import JUDGED
from tests.rigid.upper_world import World, thing

H = 1.0 / 240.0
SHAPES: tuple[Shape, ...] = (
    Box((0.1, 0.2, 0.05)), Sphere(0.07), Capsule(0.03, 0.2), Ellipsoid((0.1, 0.1, 0.01)),
    ConvexHull(np.array([(0.0, 0.0, 0.1), (0.1, 0.0, -0.05), (-0.05, 0.09, -0.05), (-0.05, -0.09, -0.05)])),
)


def pair(one: int, other: int) -> World:
    """Return two bodies side by side, as near pair 0 of pieces."""
    world = World([thing("a", SHAPES[one], (0.0, 0.0, 0.0)), thing("b", SHAPES[other], (0.3, 0.0, 0.0))])
    substeps = world.memory.substeps
    substeps.pieces[0], substeps.found[0] = (0, 1), 1
    world.memory.paths.kind[:] = HELD
    return world


def throw(world: World, rng: np.random.Generator, gap: float) -> None:
    """A random way for both, which begins with about this gap."""
    memory, substeps = world.memory, world.memory.substeps
    for b in range(2):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        world.poses.rotation[b] = turn * np.sign(np.linalg.det(turn))
        memory.paths.linear[b] = rng.choice([0.0, 10.0]) * rng.normal(size=3)
        substeps.velocity[b], substeps.turning[b] = 3.0 * rng.normal(size=3), rng.choice([0.0, 1.0, 30.0]) * rng.normal(size=3)
    world.poses.position[0] = 0.0
    towards = rng.normal(size=3)
    world.poses.position[1] = 0.6 * towards / np.linalg.norm(towards)
    for _ in range(3):
        posed(world, 0.0, world.poses)
        found, n = distance(world, world.poses)
        world.poses.position[1] += (found - gap) * n
    substeps.state[0] = UNKNOWN
    posed(world, 0.0, world.poses)
    measured(world)


def posed(world: World, t: float, out) -> None:
    """Both bodies where they are on their way after t seconds."""
    for b in range(2):
        pose_at(world.geometry, world.poses, world.memory, b, t, out)


def measured(world: World) -> None:
    """The end of the way, and its measures."""
    posed(world, H, world.memory.trial)
    for b in range(2):
        measure_motion(world.geometry, world.poses, world.memory, b, H)


def distance(world: World, poses) -> tuple[float, np.ndarray]:
    """Return the signed distance [m] and its direction."""
    _, gap, n, _, _ = signed_distance(poses.vertices, world.geometry.shapes, 0, 1, (0.0, 0.0, 0.0), make_scratch())
    return gap, np.array(n)


@pytest.mark.parametrize("one", range(len(SHAPES)))
@pytest.mark.parametrize("other", range(len(SHAPES)))
def test_a_certified_way_is_free_at_every_instant(one: int, other: int) -> None:
    world, rng, held, free = pair(one, other), np.random.default_rng(10 * one + other), 0, 0
    for _ in range(60):
        throw(world, rng, 10.0 ** rng.uniform(-5.0, -1.5))
        start = distance(world, world.poses)[0]
        holds = certify_pieces(world.geometry, world.poses, world.memory, 0, H).holds
        gaps = []
        for t in np.linspace(0.0, H, 60):
            posed(world, t, world.memory.substeps.low)
            gaps.append(distance(world, world.memory.substeps.low)[0])
        held += holds
        free += min(gaps) > 1e-5
        if holds:
            assert min(gaps) >= least_of(start) - 1e-9
    # a certificate that refuses everything would pass above
    assert held >= 0.9 * free > 10


def test_a_refused_pair_is_as_deep_as_it_says_where_it_says() -> None:
    world, rng, refused = pair(0, 4), np.random.default_rng(3), 0
    for _ in range(200):
        throw(world, rng, 10.0 ** rng.uniform(-5.0, -3.0))
        refusal = certify_pieces(world.geometry, world.poses, world.memory, 0, H)
        if refusal.holds:
            continue
        refused += 1
        posed(world, refusal.at * H, world.memory.substeps.low)
        assert refusal.gap == pytest.approx(distance(world, world.memory.substeps.low)[0], abs=1e-9)
        assert 0.0 < refusal.at <= 1.0
    assert refused > 30


@pytest.mark.parametrize("speed", [0.0, 0.02, 0.3])
def test_crossed_edges_that_dipped_can_still_turn(speed: float) -> None:
    """A box that leans on another's edge, as deep as the exact path leaves it, tilts about the point where they touch."""
    world = pair(0, 0)
    memory, lean = world.memory, np.sqrt(0.5)
    world.poses.rotation[0] = [(1.0, 0.0, 0.0), (0.0, lean, -lean), (0.0, lean, lean)]
    world.poses.rotation[1] = [(lean, 0.0, lean), (0.0, 1.0, 0.0), (-lean, 0.0, lean)]
    corners = world.geometry.local[:8]
    below, above = (corners @ world.poses.rotation[b].T for b in range(2))
    lowest, highest = below[below[:, 2].argmin()], above[above[:, 2].argmax()]
    world.poses.position[:] = (0.0, -lowest[1], -lowest[2] - 2.5e-7), (-highest[0], 0.0, -highest[2])
    memory.moving[:] = (1, 0)
    memory.substeps.turning[:] = (speed, speed, 0.0), (0.0, 0.0, 0.0)
    memory.substeps.velocity[:] = np.cross(memory.substeps.turning, world.poses.position)
    memory.substeps.velocity[1] = 0.0
    posed(world, 0.0, world.poses)
    measured(world)
    assert distance(world, world.poses)[0] == pytest.approx(-2.5e-7, abs=1e-9)
    assert certify_pieces(world.geometry, world.poses, memory, 0, H).holds
    memory.moving[:], memory.substeps.velocity[0] = (1, 0), (0.0, 0.0, -0.01)
    pose_at(world.geometry, world.poses, memory, 0, H, memory.trial)
    assert not certify_pieces(world.geometry, world.poses, memory, 0, H).holds


def test_a_certified_way_that_dipped_stays_within_the_bound() -> None:
    world, rng, held = pair(0, 4), np.random.default_rng(6), 0
    world.memory.moving[:] = 1
    for _ in range(300):
        throw(world, rng, -2e-7)
        world.memory.substeps.turning[:] *= 1e-3
        world.memory.substeps.velocity[:] *= 1e-4
        world.memory.paths.linear[:] = 0.0
        measured(world)
        if not certify_pieces(world.geometry, world.poses, world.memory, 0, H).holds:
            continue
        held += 1
        for t in np.linspace(0.0, H, 20):
            posed(world, t, world.memory.substeps.low)
            assert distance(world, world.memory.substeps.low)[0] >= -JUDGED
    assert held > 30


@given(before=st.floats(-1.0, 1.0), after=st.floats(-1.0, 1.0), bulge=st.floats(0.0, 1.0))
@settings(max_examples=200)
def test_the_least_height_of_a_way_is_that_of_many_instants(before: float, after: float, bulge: float) -> None:
    s = np.linspace(0.0, 1.0, 2001)
    sampled = (before + (after - before) * s - 4.0 * bulge * s * (1.0 - s)).min()
    assert sampled - 1e-6 <= least_between(before, after, bulge) <= sampled + 1e-12


@pytest.mark.parametrize("gap", [1e-3, 2.0 * LEAST, 2e-8, -2e-7, -1e-3])
def test_to_stand_still_is_certified(gap: float) -> None:
    world, rng = pair(0, 4), np.random.default_rng(4)
    throw(world, rng, gap)
    world.memory.substeps.velocity[:], world.memory.substeps.turning[:], world.memory.paths.linear[:] = 0.0, 0.0, 0.0
    measured(world)
    assert certify_pieces(world.geometry, world.poses, world.memory, 0, H).holds
