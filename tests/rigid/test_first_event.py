"""Islands, near pairs, and pairs out of reach: the quick answers against the search itself."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.conservative_advancement import BROKEN, CLEAR, ROUNDS
from avatarsim.collision.path import FREE, HELD, STILL
from avatarsim.model.geometry import place
from avatarsim.rigid.first_event import ROUND_WORK, SEARCH_WORK, ahead_of, balls_meet, event_of_pair, first_event, out_of_reach
from avatarsim.rigid.islands import make_islands, part
from avatarsim.rigid.near_pairs import MARGIN, NARROW, grow, margin_for, turn_within
from avatarsim.rigid.state import SEARCHES, WORK
from avatarsim.scene.shape import Box
from tests.rigid.upper_world import GRAVITY, World, ball, first_impact, slab, thing

H, TRIALS = 1.0 / 60.0, 300


def world_of(kind: str) -> World:
    """Return two bodies with numbers 0 and 1: balls of different size, a ball and a box, or two boxes."""
    of = {
        "balls": [ball("a", (0.0, 0.0, 0.0)), ball("b", (1.0, 0.0, 0.0), 0.03)],
        "ball and box": [ball("a", (0.0, 0.0, 0.0)), thing("b", Box((0.1, 0.05, 0.2)), (1.0, 0.0, 0.0))],
        "boxes": [thing("a", Box((0.2, 0.1, 0.1)), (0.0, 0.0, 0.0)), thing("b", Box((0.1, 0.05, 0.2)), (1.0, 0.0, 0.0))],
    }
    return World(of[kind])


def throw(world: World, rng: np.random.Generator, touching: bool) -> None:
    """Put both bodies on paths at random, b at some gap from a, or as near as resting bodies."""
    m, direction = world.memory, rng.normal(size=3)
    gap = rng.uniform(-3e-7, 3e-7) if touching else 10.0 ** rng.uniform(-7, 0)
    m.began.position[0] = rng.normal(size=3)
    m.began.position[1] = m.began.position[0] + (m.span.sum() + gap) * direction / np.linalg.norm(direction)
    size = 10.0 ** rng.uniform(-7, 2)
    for b in range(2):
        m.moving[b], m.paths.time[b] = 1, -1.0
        m.paths.kind[b] = rng.choice([STILL, FREE, HELD], p=[0.2, 0.4, 0.4])
        m.islands.linear[b], m.islands.angular[b] = size * rng.normal(size=(2, 3))
        m.paths.linear[b], m.paths.angular[b] = rng.choice([0.0, 1.0, 60.0]) * size * rng.normal(size=(2, 3))
        m.began.rotation[b] = Rotation.random(random_state=rng).as_matrix()
        m.trial.position[b], m.trial.rotation[b] = m.began.position[b], m.began.rotation[b]
        place(world.geometry, m.trial, b)
    if rng.random() < 0.5:
        m.islands.linear[1] = -size * direction


def search(world: World, begin: float) -> tuple[int, float]:
    """Return the search itself."""
    outcome, t, rounds = first_impact(world, world.memory.began, world.memory.islands, begin, H)
    assert 1 <= rounds <= ROUNDS
    return outcome, t


@pytest.mark.nojit
@pytest.mark.boundscheck
@pytest.mark.parametrize("kind", ["balls", "ball and box", "boxes"])
@pytest.mark.parametrize("touching", [False, True])
def test_what_is_out_of_reach_has_no_impact(kind: str, touching: bool) -> None:
    """Free and held paths, bodies at rest, and those that begin within the frame; touching ones too."""
    world, rng, quick, both = world_of(kind), np.random.default_rng(3), 0, 0
    for _ in range(TRIALS):
        throw(world, rng, touching)
        begin = float(rng.choice([0.0, 0.3 * H]))
        near = out_of_reach(world.memory, 0, 1, begin, H)
        outcome, t = search(world, begin)
        assert outcome != BROKEN
        quick, both = quick + near, both + (outcome == CLEAR)
        assert not near or (outcome == CLEAR and t == H)
    # it is worth a query: most pairs that do not meet are answered
    assert kind == "boxes" or touching or 2 * quick > both
    assert both < TRIALS


@pytest.mark.nojit
def test_a_path_that_is_not_finite_is_searched() -> None:
    world = world_of("balls")
    throw(world, np.random.default_rng(0), False)
    world.memory.paths.kind[:] = FREE
    world.memory.islands.linear[1, 1] = np.nan
    assert not out_of_reach(world.memory, 0, 1, 0.0, H)
    assert balls_meet(world.memory, 0, 1, 0.0, H)[0] == BROKEN
    assert search(world, 0.0)[0] == BROKEN


@pytest.mark.nojit
@pytest.mark.boundscheck
@pytest.mark.parametrize("touching", [False, True])
def test_balls_meet_when_the_search_for_any_shapes_finds_it(touching: bool) -> None:
    """The plain twin is the search over poses, planes and supports."""
    world, rng, met = world_of("balls"), np.random.default_rng(5), 0
    for _ in range(TRIALS):
        throw(world, rng, touching)
        begin = float(rng.choice([0.0, 0.3 * H]))
        outcome, t = balls_meet(world.memory, 0, 1, begin, H)
        other, when = search(world, begin)
        assert outcome == other
        # the search is done at any gap within its tolerance
        gap, rate, _ = ahead_of(world.memory, 0, 1, t)
        assert t == pytest.approx(when, abs=1e-15 + 4e-9 / max(1e-9, abs(rate)))
        met += outcome != CLEAR
    assert TRIALS // 10 < met < TRIALS


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_the_first_event_does_not_depend_on_the_order_of_pairs() -> None:
    """Eight balls thrown at each other, and a pair of every number queried first, of none too."""
    rng, met = np.random.default_rng(7), 0
    world = World([ball(str(k), (float(k), 0.0, 0.0)) for k in range(8)])
    m, pairs = world.memory, np.array([(a, b) for a in range(8) for b in range(a)])
    for _ in range(20):
        m.paths.kind[:], m.paths.linear[:], m.paths.time[:] = FREE, 0.0, -1.0
        m.began.position[:] = np.arange(8)[:, None] * (0.4, 0.0, 0.0) + 0.05 * rng.normal(size=(8, 3))
        m.islands.linear[:] = 10.0 * rng.normal(size=(8, 3))
        asked = [first_event(world.geometry, m, pairs, H, likely) for likely in range(-1, len(pairs) + 1)]
        assert len(set(asked)) == 1
        met += asked[0][1] >= 0
    # else there would be nothing to find, or no body to miss
    assert 5 < met < 20


@pytest.mark.nojit
def test_fixed_bodies_hold_nobody_together_and_driven_ones_do() -> None:
    """0 is fixed, 5 is driven; 1-2 touch each other, 3 and 4 meet only the driven one, 6 flies alone."""
    pairs = np.array([[0, 1], [0, 3], [1, 2], [3, 5], [4, 5], [0, 6]])
    islands = make_islands(7, 10)
    moving = np.array([0, 1, 1, 1, 1, 0, 1])
    joins = np.array([0, 1, 1, 1, 1, 1, 1])
    part(islands, pairs, len(pairs), moving, joins, np.arange(len(moving)))
    assert islands.found[0] == 3
    first, at = islands.first, islands.pair_first
    members = [islands.order[first[i] : first[i + 1]].tolist() for i in range(3)]
    own = [islands.pairs[at[i] : at[i + 1]].tolist() for i in range(3)]
    assert members == [[1, 2], [3, 4, 5], [6]]
    assert own == [[[0, 1], [1, 2]], [[0, 3], [3, 5], [4, 5]], [[0, 6]]]


def test_a_grown_box_holds_the_whole_flight() -> None:
    """Tumbling boxes sampled along their frame never leave it."""
    rng = np.random.default_rng(5)
    for scale in (0.1, 3.0, 100.0):
        velocity, spin = tuple(rng.normal(size=3)), tuple(scale * rng.normal(size=3))
        body = thing("box", Box((0.1, 0.2, 0.5)), (0.0, 0.0, 9.0), velocity=velocity, angular_velocity=spin)
        world = World([body])
        box, t = np.zeros((1, 6)), 1.0 / 30.0
        turn = turn_within(float(np.linalg.norm(spin)), t)
        poses = world.poses
        grow(poses.hulls, poses.position, world.memory.span, 0, world.velocities.linear, np.array(GRAVITY), turn, t, MARGIN, box)
        for _ in range(40):
            assert world.frame(t / 40) == 0
            assert np.all(world.poses.hulls[0, :3] >= box[0, :3]) and np.all(world.poses.hulls[0, 3:] <= box[0, 3:])


def test_a_sleeper_wakes_when_a_moving_body_comes_near() -> None:
    resting = ball("resting", (0.0, 0.0, 0.1 + 2e-8))
    world = World([slab(), resting, ball("flier", (2.0, 0.0, 0.1 + 2e-8), velocity=(-3.0, 0.0, 0.0))], 1.0)
    world.run(0.1)
    assert world.memory.asleep[1] == 1
    world.run(0.9)
    assert world.velocities.linear[1, 0] < -2.9


def test_the_margin_follows_small_bodies_where_nobody_is_driven() -> None:
    """From a centimetre on it is MARGIN."""
    span, everybody = np.array([0.3, 0.01, 1e-3]), np.ones(3, np.bool_)
    assert margin_for(span[:2], everybody[:2], False) == MARGIN
    assert margin_for(span, everybody, False) == 0.05 * 1e-3
    assert margin_for(span, everybody, True) == MARGIN
    assert margin_for(span, ~everybody, False) == MARGIN
    assert margin_for(np.array([1e-6]), everybody[:1], False) == NARROW


def test_tiny_balls_in_lanes_are_no_island() -> None:
    """Fifty balls of a hundredth of a millimetre, ten radii apart, fly at a wall at once: every frame is done, all come back."""
    wall = slab(size=(1e-2, 1e-2, 1e-3))
    bodies = [ball(f"b{k}", (1e-4 * (k - 25), 0.0, 1e-5 + 1e-6 * k), radius=1e-5, velocity=(0.0, 0.0, -0.01)) for k in range(50)]
    world = World([wall, *bodies], restitution=1.0, gravity=(0.0, 0.0, 0.0))
    world.run(0.1)
    assert np.array_equal(world.velocities.linear[1:, 2], np.full(50, 0.01))


@pytest.mark.nojit
def test_rounds_of_a_search_are_charged() -> None:
    """A box that tumbles down on another one takes more work the longer the search."""
    world, rng, seen = world_of("boxes"), np.random.default_rng(11), set()
    m = world.memory
    for _ in range(50):
        throw(world, rng, False)
        m.counts[:] = 0
        event_of_pair(world.geometry, m, 0, 1, 0.0, H)
        assert m.counts[WORK] >= SEARCH_WORK * m.counts[SEARCHES]
        assert (m.counts[WORK] - SEARCH_WORK * m.counts[SEARCHES]) % ROUND_WORK == 0
        seen.add(int(m.counts[WORK]))
    assert len(seen) > 3
