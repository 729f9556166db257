"""First contacts of two bodies against closed forms: never late, within 1e-9 s, and a status for all that is none."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.collision.conservative_advancement import (
    BROKEN,
    CLEAR,
    IMPACT,
    OVERLAPPING,
    ROUNDS,
    SPENT,
    STAND_OFF,
)
from avatarsim.collision.motion_bounds import earliest_touch
from avatarsim.collision.path import FREE, STILL
from avatarsim.errors import InvalidInput
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from tests.collision.two_bodies import Budget, Found, TwoBodies
from tests.rigid.upper_world import World, ball, first_impact, thing

G = 9.81
LATE = 1e-15
"""Rounding [s] of the closed forms below, relative to 1 s."""


def wall(thick: float = 0.01, x: float = 0.0) -> Body:
    """Return a fixed wall across x."""
    return fixed("wall", (Piece(Box((thick, 20.0, 20.0))),), "m", (x, 0.0, 0.0))


def met(found: Found, expected: float, closing: float) -> None:
    """An impact at `expected`, with the stand-off kept and neither time late."""
    assert found.outcome == IMPACT
    assert found.time <= found.contact <= expected + LATE * (1.0 + expected)
    assert found.time >= expected - 1.2 * STAND_OFF / closing
    assert found.contact >= expected - 3e-11 / closing
    assert found.gap >= STAND_OFF * (1.0 - 1e-6)


@pytest.mark.parametrize("offset", [0.0, 1e-3])
def test_parallel_faces_that_approach(offset: float) -> None:
    """Also when they are exactly above each other, and when the gap is opened by the other body's flight."""
    low, high = thing("low", Box((1.0, 1.0, 0.2)), (0.0, 0.0, 0.0)), thing("high", Box((0.3, 0.3, 0.2)), (offset, 0.0, 1.2))
    pair = TwoBodies(low, high)
    met(pair.first_contact(1.0, acceleration_b=(0.0, 0.0, -G)), np.sqrt(2.0 / G), np.sqrt(2.0 * G))
    both = pair.first_contact(1.0, acceleration_a=(0.0, 0.0, -G), acceleration_b=(0.0, 0.0, -G))
    assert both.outcome == CLEAR and both.time == 1.0


def test_a_slow_graze() -> None:
    """Two balls at 1 mm/s that overlap by a micrometre at the closest: closing along the normal at 3e-6 m/s."""
    one, two = ball("one", (-0.3, 0.0, 0.0), velocity=(1e-3, 0.0, 0.0)), ball("two", (0.0, 0.2 - 1e-6, 0.0))
    found = TwoBodies(one, two).first_contact(400.0)
    way = np.sqrt(0.2**2 - (0.2 - 1e-6) ** 2)
    met(found, (0.3 - way) / 1e-3, 1e-3 * way / 0.2)
    missed = TwoBodies(one, ball("two", (0.0, 0.2 + 1e-6, 0.0))).first_contact(400.0)
    assert missed.outcome == CLEAR
    near = TwoBodies(one, ball("two", (0.0, 0.2 + 1e-8, 0.0))).first_contact(400.0)
    assert near.outcome == IMPACT and near.contact == np.inf, "within the stand-off, but the surfaces do not meet"


@pytest.mark.parametrize(("above", "touches"), [(1e-6, True), (1e-9, True), (0.0, True), (-1e-9, False), (-1e-6, None)])
def test_an_apex_that_just_touches(above: float, touches: bool | None) -> None:
    """A ball thrown at a ceiling; the parabola's top is `above` it: two roots that are nearly one, or one."""
    speed, radius = 2.0, 0.1
    top = speed**2 / (2.0 * G)
    ceiling = fixed("ceiling", (Piece(Box((2.0, 2.0, 0.1))),), "m", (0.0, 0.0, top - above + radius + 0.05))
    found = TwoBodies(ceiling, ball("ball", (0.0, 0.0, 0.0), radius, velocity=(0.0, 0.0, speed))).first_contact(
        0.4, acceleration_b=(0.0, 0.0, -G)
    )
    if touches is None:
        assert found.outcome == CLEAR
    else:
        assert found.outcome == IMPACT
        late = 1e-7 / np.sqrt(above % 1.0) if above else 1e-6
        assert found.time == pytest.approx((speed - np.sqrt(2.0 * G * (above + STAND_OFF))) / G, abs=late)
        first = (speed - np.sqrt(2.0 * G * above)) / G if touches else np.inf
        assert found.contact <= first
        assert found.contact == (pytest.approx(first, abs=1e-5) if touches else np.inf)


@pytest.mark.parametrize("gap", [0.0, 1e-13, 1e-9, 1e-8])
@pytest.mark.parametrize("shape", [Sphere(0.1), Box((0.2, 0.2, 0.2))])
def test_pieces_that_start_within_the_stand_off(shape: Sphere | Box, gap: float) -> None:
    floor = fixed("floor", (Piece(Box((2.0, 2.0, 1.0))),), "m", (0.0, 0.0, -0.5))

    def search(up: float, sideways: float = 0.0, pull: float = 0.0) -> Found:
        body = thing("body", shape, (0.0, 0.0, 0.1 + gap), velocity=(sideways, 0.0, up))
        return TwoBodies(floor, body).first_contact(0.5, acceleration_b=(0.0, 0.0, pull))

    assert search(1.0).outcome == CLEAR, "they part"
    assert search(1e-9).outcome == CLEAR, "they part slowly"
    assert search(0.0).outcome == CLEAR, "nothing moves"
    assert search(0.0, 0.7).outcome == CLEAR, "they slide"
    meets = search(-2.0)
    assert meets.outcome == IMPACT
    assert 0.0 <= meets.time <= meets.contact <= gap / 2.0 + 1e-13
    assert meets.contact >= gap / 2.0 - 2e-11
    back = search(1.0, 0.0, -G)
    assert back.outcome == IMPACT and back.gap >= 0.99 * STAND_OFF, "it comes back, and the stand-off holds again"
    expected = (1.0 + np.sqrt(1.0 + 2.0 * G * gap)) / G
    assert back.time <= back.contact <= expected + 1e-14
    assert back.contact >= expected - 1e-10


def test_overlap_at_the_start_is_a_status() -> None:
    found = TwoBodies(wall(0.2), ball("ball", (0.15, 0.0, 0.0), velocity=(5.0, 0.0, 0.0))).first_contact(1.0)
    assert found.outcome == OVERLAPPING and found.time == 0.0
    assert found.gap == pytest.approx(-0.05, abs=1e-12)


@pytest.mark.parametrize("speed", [0.0, 5e-324, 1e-300, 1e-12])
def test_hardly_any_motion(speed: float) -> None:
    found = TwoBodies(wall(), ball("ball", (0.5, 0.0, 0.0), velocity=(-speed, 0.0, 0.0))).first_contact(1.0)
    assert found.outcome == CLEAR and found.time == 1.0 and found.rounds <= 3


def test_a_spin_of_many_turns_costs_little_until_it_matters() -> None:
    """1e4 rad/s, 26 turns in the frame: past the wall in a few rounds; into it at the instant that the ball around it gives."""
    rod = Capsule(0.005, 0.19)
    flier = thing("rod", rod, (0.2, 0.0, 0.0), velocity=(-5.0, 0.0, 0.0), angular_velocity=(0.0, 1e4, 0.0))
    past = TwoBodies(wall(), flier, gyroscopic=False)
    found = past.first_contact(1.0 / 60.0)
    assert found.outcome == CLEAR and found.rounds <= 5
    into = past.first_contact(0.05)
    # the tip comes round every 310 microseconds, so the first touch is at most that later than the ball around the rod
    ball_meets = (0.2 - 0.1 - 0.005) / 5.0
    assert into.outcome == IMPACT and ball_meets - 1e-8 <= into.time <= ball_meets + 3.2e-4


def test_a_spent_budget_is_a_status_and_its_time_is_safe() -> None:
    """A disc that spins flat over the floor at 1e4 rad/s never comes nearer, but no bound proves it: the budget ends."""
    angle = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    ring = np.stack([0.2 * np.cos(angle), 0.2 * np.sin(angle), np.full(12, 0.05)], axis=1)
    disc = thing("disc", ConvexHull(np.vstack([ring, ring * [1, 1, -1]])), (0.0, 0.0, 0.06), angular_velocity=(0.0, 0.0, 1e4))
    floor = fixed("floor", (Piece(Box((2.0, 2.0, 1.0))),), "m", (0.0, 0.0, -0.5))
    found = TwoBodies(floor, disc).first_contact(1.0, budget=Budget(rounds=50))
    assert found.outcome == SPENT and 0.0 < found.time < 1.0 and found.contact == np.inf
    assert found.rounds <= 51


@pytest.mark.parametrize("speed", [2.0, 100.0])
def test_a_hundred_kilometres_from_the_origin(speed: float) -> None:
    """The stand-off grows to 2.2e-8 m there, a thousand roundings; contact is still found to 1e-9 s."""
    x = 1e5
    found = TwoBodies(wall(0.01, x), ball("ball", (x + 0.3, 0.0, 0.0), 0.01, velocity=(-speed, 0.0, 0.0))).first_contact(1.0)
    expected = ((x + 0.3) - x - 0.015) / speed
    assert found.outcome == IMPACT and found.gap > 2e-8
    assert found.time < found.contact <= expected + 2e-10
    assert found.contact == pytest.approx(expected, abs=1e-9)


def test_the_earliest_of_several_pieces() -> None:
    """A dumb-bell whose far end is thicker; a wall of two slabs, the nearer one named by its number."""
    pieces = (Piece(Sphere(0.02), (0.0, 0.0, -0.2)), Piece(Sphere(0.05), (0.0, 0.0, 0.2)))
    bell = simulated("bell", pieces, "m", solid(pieces, 1.0), (1.0, 0.0, 0.0), velocity=(-3.0, 0.0, 0.0))
    slabs = (Piece(Box((0.1, 1.0, 1.0)), (0.0, 0.0, -0.5)), Piece(Box((0.1, 1.0, 1.0)), (0.02, 0.0, 0.5)))
    found = TwoBodies(fixed("slabs", slabs, "m"), bell).first_contact(1.0)
    met(found, (1.0 - 0.05 - 0.05 - 0.02) / 3.0, 3.0)
    assert (found.piece_a, found.piece_b) == (1, 3)


@pytest.mark.parametrize("what", range(4))
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_not_finite_is_a_status(what: int, value: float) -> None:
    pair = TwoBodies(wall(), thing("box", Box((0.1, 0.2, 0.3)), (0.5, 0.0, 0.0)))
    state: list[list[list[float]]] = [
        [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]], [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]],
        [[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    ]
    state[what][1][1] = value
    with np.errstate(invalid="ignore"):
        pair.set_state(*state)
    with np.errstate(all="ignore"):
        assert pair.first_contact(1.0).outcome == BROKEN


def test_questions_that_mean_nothing_are_refused() -> None:
    pair = TwoBodies(wall(), ball("ball", (0.5, 0.0, 0.0)))
    for seconds in (-1.0, np.nan, np.inf):
        with pytest.raises(InvalidInput, match="horizon"):
            pair.first_contact(seconds)
    for budget in (Budget(0.0), Budget(np.nan), Budget(rounds=0)):
        with pytest.raises(InvalidInput, match="budget"):
            pair.first_contact(1.0, budget=budget)
    with pytest.raises(InvalidInput, match="acceleration"):
        pair.first_contact(1.0, acceleration_b=(0.0, np.nan, 0.0))


WILD = st.one_of(st.floats(-1e3, 1e3), st.sampled_from([0.0, 1e-300, -1e-12, 1e8, -1e30, 1e150, 5e-324]))
SOLIDS: list[Shape] = [Sphere(0.1), Box((0.1, 0.2, 0.3)), Capsule(0.05, 0.2), Ellipsoid((0.1, 0.2, 0.3)), Box((1e-4, 1.0, 1.0))]


@pytest.fixture(scope="module")
def pairs() -> list[TwoBodies]:
    return [TwoBodies(thing("a", one, (0.0, 0.0, 0.0)), thing("b", two, (1.0, 0.0, 0.0))) for one, two in product(SOLIDS, SOLIDS)]


@given(st.integers(0, len(SOLIDS) ** 2 - 1), st.lists(WILD, min_size=9, max_size=9), st.floats(0.0, 1e6))
def test_any_finite_input_ends(pairs: list[TwoBodies], which: int, values: Sequence[float], seconds: float) -> None:
    still = [0.0, 0.0, 0.0]
    pair = pairs[which]
    with np.errstate(all="ignore"):
        pair.set_state([still, list(values[:3])], [[1.0, 0.0, 0.0, 0.0]] * 2, [still, values[3:6]], [values[6:9], still])
        found = pair.first_contact(seconds)
    assert 0.0 <= found.time <= seconds
    assert found.rounds <= 2 * ROUNDS + 1
    assert found.outcome in (CLEAR, IMPACT, BROKEN, SPENT, OVERLAPPING)


@given(st.floats(1e-9, 1.0), st.floats(-10.0, 10.0), st.floats(-20.0, 20.0))
def test_earliest_touch_is_the_first_root(gap: float, v: float, a: float) -> None:
    h = 1.0
    t = earliest_touch(gap, v, a, h)
    roots = [r.real for r in np.roots([0.5 * a, v, gap]) if abs(r.imag) < 1e-12 and 0.0 < r.real <= h]
    assert t <= h
    assert t == pytest.approx(min(roots, default=h), rel=1e-6)
    between = np.linspace(0.0, t, 50)
    assert np.all(gap + v * between + 0.5 * a * between**2 >= -1e-9 * (1.0 + gap))


@pytest.mark.parametrize("shape", [Sphere(0.1), Box((0.2, 0.2, 0.2))])
def test_a_body_that_stopped_is_met_by_one_that_falls(shape: Sphere | Box) -> None:
    """Two bodies that fall together keep their distance; once the lower one has stopped, its acceleration is no body's."""
    gap = 0.01
    bodies = [thing("lower", shape, (0.0, 0.0, 0.5)), thing("upper", shape, (0.0, 0.0, 0.7 + gap))]
    world = World(bodies, gravity=(0.0, 0.0, -10.0))
    paths = world.memory.paths
    paths.kind[:], paths.linear[:], paths.time[:] = FREE, world.dynamics.gravity, -1.0
    assert first_impact(world, world.poses, world.velocities, 0.0, 0.2)[:2] == (CLEAR, 0.2)
    paths.kind[0], paths.time[:] = STILL, -1.0
    outcome, t, _ = first_impact(world, world.poses, world.velocities, 0.0, 0.2)
    assert outcome == IMPACT
    assert t == pytest.approx(np.sqrt(2.0 * (gap - STAND_OFF) / 10.0), abs=1e-6)


@pytest.mark.nojit
@pytest.mark.parametrize("gap", [1e-18, 1e-16, 1e-12, 1e-6])
def test_a_body_thrown_up_comes_back_in_time(gap: float) -> None:
    """From 0.05 m/s the way back takes 2 v / g; a gap of rounding size made it 7 microseconds late."""
    v, g = 0.04893894, 9.81
    expected = (v + (v * v + 2.0 * g * gap) ** 0.5) / g
    assert earliest_touch(gap, v, -g, 1.0) == pytest.approx(expected, rel=1e-14)


def test_a_horizon_of_nothing() -> None:
    assert TwoBodies(wall(), ball("ball", (0.2, 0.0, 0.0), velocity=(-1.0, 0.0, 0.0))).first_contact(0.0).outcome == CLEAR
