"""Pairs called out of reach have no time of impact in the frame: the quick answer against the search itself."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.conservative_advancement import BROKEN, CLEAR, ROUNDS, UNKNOWN, time_of_impact
from avatarsim.collision.path import FREE, HELD, STILL
from avatarsim.model.geometry import place
from avatarsim.rigid.first_event import (
    ROUND_WORK,
    SEARCH_WORK,
    ahead_of,
    balls_meet,
    event_of_pair,
    first_event,
    out_of_reach,
)
from avatarsim.rigid.state import SEARCHES, WORK
from avatarsim.scene.shape import Box
from tests.rigid.upper_world import World, ball, thing

H, TRIALS = 1.0 / 60.0, 300


def world_of(kind: str) -> World:
    """Two bodies with numbers 0 and 1: balls of different size, a ball and a box, or two boxes."""
    of = {
        "balls": [ball("a", (0.0, 0.0, 0.0)), ball("b", (1.0, 0.0, 0.0), 0.03)],
        "ball and box": [ball("a", (0.0, 0.0, 0.0)), thing("b", Box((0.1, 0.05, 0.2)), (1.0, 0.0, 0.0))],
        "boxes": [thing("a", Box((0.2, 0.1, 0.1)), (0.0, 0.0, 0.0)), thing("b", Box((0.1, 0.05, 0.2)), (1.0, 0.0, 0.0))],
    }
    return World(of[kind])


def throw(world: World, rng: np.random.Generator, touching: bool) -> None:
    """Put both bodies on paths at random, b at some gap from a, or as near as what rests."""
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
    """The search itself."""
    m = world.memory
    outcome, t, rounds = time_of_impact(
        world.geometry, m.began, m.islands.linear, m.islands.angular, m.paths, m.series, m.reach, 0, 1, begin, H,
        UNKNOWN, 1.0, m.trial, m.a_rows, m.b_rows, m.edges, m.scratch,
    )
    assert 1 <= rounds <= ROUNDS
    return outcome, t


@pytest.mark.nojit
@pytest.mark.boundscheck
@pytest.mark.parametrize("kind", ["balls", "ball and box", "boxes"])
@pytest.mark.parametrize("touching", [False, True])
def test_what_is_out_of_reach_has_no_impact(kind: str, touching: bool) -> None:
    """Free and held paths, bodies that stand, and those that begin within the frame; touching ones too."""
    world, rng, quick, both = world_of(kind), np.random.default_rng(3), 0, 0
    for _ in range(TRIALS):
        throw(world, rng, touching)
        begin = float(rng.choice([0.0, 0.3 * H]))
        near = out_of_reach(world.memory, 0, 1, begin, H)
        outcome, t = search(world, begin)
        assert outcome != BROKEN
        quick, both = quick + near, both + (outcome == CLEAR)
        assert not near or (outcome == CLEAR and t == H)
    # it is worth asking: most pairs that do not meet are answered
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
    """The dumb twin is the search over poses, planes and supports."""
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
def test_whichever_pair_is_asked_first_the_first_event_is_the_same() -> None:
    """Eight balls thrown at each other, and a pair of every number asked first, of none too."""
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
