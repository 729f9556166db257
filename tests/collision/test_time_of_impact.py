"""Times of impact against closed forms and fine sampling: never late, and not early by more than the tolerance."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.collision.conservative_advancement import CLEAR, IMPACT, STAND_OFF, TOLERANCE, UNKNOWN, time_of_impact
from avatarsim.collision.motion_bounds import earliest_touch
from avatarsim.collision.path import FREE, STILL
from avatarsim.scene.shape import Box, Ellipsoid, Sphere
from tests.rigid.upper_world import World, ball, slab, thing


@given(st.floats(1e-9, 1.0), st.floats(-10.0, 10.0), st.floats(-20.0, 20.0))
def test_earliest_touch_is_the_first_root(gap: float, v: float, a: float) -> None:
    h = 1.0
    t = earliest_touch(gap, v, a, h)
    roots = [r.real for r in np.roots([0.5 * a, v, gap]) if abs(r.imag) < 1e-12 and 0.0 < r.real <= h]
    assert t <= h
    assert t == pytest.approx(min(roots, default=h), rel=1e-6)
    between = np.linspace(0.0, t, 50)
    assert np.all(gap + v * between + 0.5 * a * between**2 >= -1e-9 * (1.0 + gap))


def search(world: World, h: float) -> tuple[int, float]:
    """First event of the two bodies in free flight within h seconds."""
    m = world.memory
    m.paths.kind[:] = np.where(world.dynamics.role == 1, FREE, 0)
    m.paths.linear[:] = np.where((world.dynamics.role == 1)[:, None], world.dynamics.gravity, 0.0)
    m.paths.time[:] = -1.0
    outcome, t, _ = time_of_impact(
        world.geometry, world.poses, world.velocities.linear, world.velocities.angular, m.paths, m.series, m.reach, 0, 1, 0.0, h,
        UNKNOWN, 1.0, m.trial, m.a_rows, m.b_rows, m.edges, m.scratch,
    )
    return outcome, t


def test_two_spheres_that_graze() -> None:
    """Offset paths: the root of |d + v t| = r1 + r2 (plus the stand-off)."""
    one = ball("one", (-1.0, 0.0, 0.0), velocity=(7.0, 0.0, 0.0))
    world = World([one, ball("two", (0.0, 0.1999, 0.0))], gravity=(0.0, 0.0, 0.0))
    outcome, t = search(world, 1.0)
    expected = (1.0 - np.sqrt((0.2 + STAND_OFF) ** 2 - 0.1999**2)) / 7.0
    assert outcome == IMPACT
    assert t <= expected + 1e-15
    assert t == pytest.approx(expected, abs=1e-7)
    missed = World([one, ball("two", (0.0, 0.2001, 0.0))], gravity=(0.0, 0.0, 0.0))
    assert search(missed, 1.0) == (CLEAR, 1.0)


@pytest.mark.parametrize("shape", [Sphere(0.1), Box((0.2, 0.2, 0.2))])
def test_who_stopped_on_a_path_that_goes_on_is_met_by_who_still_falls(shape: Sphere | Box) -> None:
    """Two bodies that fall together keep their distance; once the lower one has stopped, its acceleration is no body's."""
    gap = 0.01
    bodies = [thing("lower", shape, (0.0, 0.0, 0.5)), thing("upper", shape, (0.0, 0.0, 0.7 + gap))]
    world = World(bodies, gravity=(0.0, 0.0, -10.0))
    m = world.memory
    assert search(world, 0.2) == (CLEAR, 0.2)
    m.paths.kind[0], m.paths.time[:] = STILL, -1.0
    outcome, t, _ = time_of_impact(
        world.geometry, world.poses, world.velocities.linear, world.velocities.angular, m.paths, m.series, m.reach, 0, 1, 0.0,
        0.2, UNKNOWN, 1.0, m.trial, m.a_rows, m.b_rows, m.edges, m.scratch,
    )
    assert outcome == IMPACT
    assert t == pytest.approx(np.sqrt(2.0 * (gap - STAND_OFF) / 10.0), abs=1e-6)


@pytest.mark.parametrize("shape", [Box((0.1, 0.2, 0.3)), Ellipsoid((0.1, 0.2, 0.05))])
@pytest.mark.parametrize("seed", range(4))
def test_a_tumbling_body_meets_the_floor_at_the_first_instant(shape: object, seed: int) -> None:
    """Sampled ten thousand times along its path, the gap is nowhere below the stand-off before, and at it then."""
    rng = np.random.default_rng(seed)
    turn, spin = rng.normal(size=4), tuple(10.0 * rng.normal(size=3))
    body = thing(
        "body", shape, (0.0, 0.0, 0.4), orientation=tuple(turn / np.linalg.norm(turn)), angular_velocity=spin,
        velocity=(0.5, 0.0, -1.0),
    )
    world = World([slab(), body])
    outcome, t = search(world, 0.5)
    assert outcome == IMPACT
    from avatarsim.collision.path import move_along

    m = world.memory

    def gap(at: float) -> float:
        move_along(
            world.geometry, world.poses, world.velocities.linear, world.velocities.angular, m.paths, m.series, 1, at, m.trial
        )
        return float(m.trial.hulls[1, 2])

    assert min(gap(at) for at in np.linspace(0.0, t, 3000)) >= STAND_OFF - 1e-12
    assert gap(t) <= STAND_OFF + 2.0 * TOLERANCE
