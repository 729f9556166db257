"""States between two postures, and bisection among them."""

import numpy as np
import pytest

from avatarsim.model.skeleton import Posture
from avatarsim.paper.walk_back import interpolate, narrowed
from avatarsim.spatial import rotation
from tests.worlds.arms import arm, ball_hand, limited_ball, planar, world_of

pytestmark = [pytest.mark.nojit]

AVATARS = (ball_hand(0.1), arm((0.4, 0.3), [limited_ball(), planar((-0.5, 2.0))[0]], at=(3.0, 0.0, 0.0)))
ALL = np.ones(3, dtype=np.bool_)


def some_posture(world, seed):
    rng = np.random.default_rng(seed)
    q = rotation.normalised(rng.normal(size=(3, 4)))
    return Posture(rng.normal(size=(3, 3)), rotation.to_matrix(q), rng.uniform(-0.5, 2.0, len(world.posture.angle))), q


@pytest.mark.parametrize("fraction", [0.25, 0.5, 0.9])
def test_hinges_and_places_go_straight_and_rotations_on_the_great_circle(fraction):
    world = world_of(AVATARS)
    (a, qa), (b, qb) = some_posture(world, 1), some_posture(world, 2)
    interpolate(world.skeleton, a, b, fraction, ALL, world.posture)
    hinge = len(world.posture.angle) - 1
    assert world.posture.angle[hinge] == pytest.approx((1 - fraction) * a.angle[hinge] + fraction * b.angle[hinge])
    np.testing.assert_allclose(world.posture.root[0], (1 - fraction) * a.root[0] + fraction * b.root[0], atol=1e-15)
    for link in (0, 1):
        # the dumb twin works on quaternions
        np.testing.assert_allclose(
            world.posture.turn[link], rotation.to_matrix(rotation.slerp(qa[link], qb[link], fraction)), atol=1e-12
        )


def test_the_ends_are_the_ends_bit_for_bit_and_nothing_of_the_other_one():
    world = world_of(AVATARS)
    (a, _), (b, _) = some_posture(world, 1), some_posture(world, 2)
    broken = Posture(*(np.full_like(array, np.nan) for array in b))
    interpolate(world.skeleton, a, broken, 0.0, ALL, world.posture)
    assert (world.posture.root[0] == a.root[0]).all()
    assert (world.posture.turn[:2] == a.turn[:2]).all()
    assert world.posture.angle[-1] == a.angle[-1]
    interpolate(world.skeleton, broken, b, 1.0, ALL, world.posture)
    assert (world.posture.root[0] == b.root[0]).all()
    assert (world.posture.turn[:2] == b.turn[:2]).all()
    assert world.posture.angle[-1] == b.angle[-1]


def test_links_that_are_not_chosen_keep_the_present_posture():
    world = world_of(AVATARS)
    (a, _), (b, _) = some_posture(world, 1), some_posture(world, 2)
    interpolate(world.skeleton, a, b, 0.0, np.array([False, True, False]), world.posture)
    assert (world.posture.root[0] == b.root[0]).all()
    assert (world.posture.turn[1] == a.turn[1]).all()
    assert world.posture.angle[-1] == b.angle[-1]


@pytest.mark.parametrize("edge", [0.0, 1e-5, 0.3, 0.7853981, 0.999])
def test_bisection_finds_the_edge_to_a_millionth_from_the_free_side(edge):
    low, high = 0.0, 1.0
    while high - low > 1e-6:
        low, high = narrowed(low, high, 0.5 * (low + high) <= edge)
    assert low <= edge <= low + 1e-6
