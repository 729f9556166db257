"""Ellipsoids against whatever there is: a search over all directions, both orders, hard places; always an answer."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance_up_to
from avatarsim.collision.status import CONVERGED
from avatarsim.collision.support import gap_along
from avatarsim.collision.warm_query import signed_distance_coherent
from avatarsim.collision.warm_start import make_pair_memory
from tests.collision.solids import as_arrays, ask, ball, box, capsule, dumb_ellipsoid_gap, ellipsoid, random_hull

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

EXACT = 1e-9
"""Relative to the shapes' size: the bar."""


def some_turn(rng):
    """A random rotation."""
    return Rotation.from_quat(rng.normal(size=4))


def dumb_smooth_and_cornered_gap(smooth, points, count=60_000):
    """Signed gap of an ellipsoid and a polytope from a fine net of directions: an upper bound of the depth, close above it."""
    k = np.arange(count) + 0.5
    polar, turn = np.arccos(1.0 - 2.0 * k / count), np.pi * (1.0 + 5.0**0.5) * k
    net = np.c_[np.cos(turn) * np.sin(polar), np.sin(turn) * np.sin(polar), np.cos(polar)]
    reach = net @ smooth.rows[0] + np.linalg.norm(net @ smooth.rows[1:].T, axis=1)
    return -(reach + (-(points.rows @ net.T)).max(axis=0) + points.radius).min()


def check(a, b):
    """Status, proof along the normal, witness points, and both orders; returns the gap."""
    status, gap, n, on_a, on_b = ask(a, b)
    size = max(a.size, b.size)
    vertices, shapes = as_arrays(a, b)
    assert status == CONVERGED
    assert gap_along(vertices, shapes, 0, 1, tuple(n)) == pytest.approx(gap, abs=EXACT * size)
    np.testing.assert_allclose(on_a - on_b, gap * n, atol=EXACT * size)
    other = ask(b, a)
    assert other[0] == CONVERGED
    assert other[1] == pytest.approx(gap, abs=EXACT * size)
    return gap


@pytest.mark.parametrize("spread", [0.05, 0.4, 1.5])
def test_two_ellipsoids_or_a_ball_equal_the_best_of_a_search(spread):
    rng = np.random.default_rng(61)
    for k in range(8):
        a = ellipsoid(*rng.uniform(0.2, 0.6, 3)).moved(some_turn(rng))
        b = (ellipsoid(*rng.uniform(0.2, 0.6, 3)) if k % 2 else ball(0.2)).moved(some_turn(rng), rng.normal(size=3) * spread)
        assert check(a, b) == pytest.approx(dumb_ellipsoid_gap(a, b, 12), abs=EXACT)


@pytest.mark.parametrize("spread", [0.05, 0.3, 1.5])
def test_no_direction_of_a_net_does_better_than_the_answer_for_cornered_shapes(spread):
    rng = np.random.default_rng(62)
    for k in range(9):
        a = ellipsoid(*rng.uniform(0.2, 0.6, 3)).moved(some_turn(rng))
        b = [box(*rng.uniform(0.1, 0.5, 3)), random_hull(rng, 15), capsule(0.1, 0.4)][k % 3]
        b = b.moved(some_turn(rng), rng.normal(size=3) * spread)
        gap, net = check(a, b), dumb_smooth_and_cornered_gap(a, b)
        # The nearest direction of the net is at most 0.015 rad off, and the gap changes by the diameter per radian.
        assert net - 1e-12 <= gap <= net + 0.02 * max(a.size, b.size) if gap < 0.0 else gap >= net - 1e-12


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (1e-10, 2e-10, 0.0), (1e-4, 0.0, 1e-5)])
def test_concentric_and_nearly_so(shift, scale):
    for a, b, depth in (
        (ellipsoid(0.5, 0.5, 0.5), ellipsoid(0.3, 0.3, 0.3), 0.8),
        (ellipsoid(0.5, 0.49, 0.48), ellipsoid(0.3, 0.31, 0.31), 0.79),
        (ellipsoid(0.5, 0.3, 0.2), ellipsoid(0.5, 0.3, 0.2), 0.4),
        (ellipsoid(0.5, 0.4, 0.3), ball(0.1), 0.4),
        (ellipsoid(0.5, 0.5, 0.5), box(0.3, 0.2, 0.1), 0.6),
        (ellipsoid(0.5, 0.5, 0.5), capsule(0.1, 0.2), 0.6),
    ):
        gap = check(a.moved(scale=scale), b.moved(scale=scale, shift=np.array(shift) * scale)) / scale
        assert gap == pytest.approx(-depth, abs=EXACT + 2.0 * np.linalg.norm(shift))


def test_needles_and_plates():
    for a, b, depth in (
        (ellipsoid(1.0, 1e-3, 1e-3), ellipsoid(1e-3, 1.0, 1e-3), 2e-3),
        (ellipsoid(1.0, 1.0, 1e-3), ellipsoid(1e-3, 1.0, 1.0), 1.001),
        (ellipsoid(1.0, 1.0, 1e-3), box(1.0, 1.0, 1e-3), 2e-3),
    ):
        assert check(a, b) == pytest.approx(-depth, abs=EXACT)


@pytest.mark.parametrize("exponent", range(-15, -2))
def test_grazing_gaps(exponent):
    rng = np.random.default_rng(63)
    a = ellipsoid(0.5, 0.3, 0.2).moved(some_turn(rng))
    for b in (ellipsoid(0.4, 0.3, 0.3), ball(0.3), box(0.3, 0.2, 0.4), random_hull(rng, 15)):
        b = b.moved(some_turn(rng), (1.1, 0.2, 0.1))
        _, gap, n, _, _ = ask(a, b)
        for wanted in (10.0**exponent, -(10.0**exponent)):
            found = check(a.moved(shift=n * (wanted - gap)), b)
            assert found == pytest.approx(wanted, abs=1e-11)
            if exponent > -11:
                assert found * wanted > 0.0


@pytest.mark.parametrize("distance", [1e-6, 1e-3, 0.02, 0.3])
def test_a_gap_beyond_the_margin_is_proved_by_its_normal(distance):
    rng = np.random.default_rng(64)
    scratch, memory, no_seed = make_scratch(), make_pair_memory(1), (0.0, 0.0, 0.0)
    for k in range(8):
        a = ellipsoid(*rng.uniform(0.2, 0.6, 3)).moved(some_turn(rng))
        b = [ellipsoid(0.4, 0.3, 0.3), box(0.3, 0.2, 0.4), random_hull(rng, 15), capsule(0.1, 0.4)][k % 4]
        b = b.moved(some_turn(rng), rng.normal(size=3))
        _, gap, n, _, _ = ask(a, b)
        vertices, shapes = as_arrays(a.moved(shift=n * (distance - gap)), b)
        for share in (0.0, 0.5, 0.9, 0.99, 1.0 - 1e-6, 1.0 + 1e-6, 1.01, 1.5):
            margin = share * distance
            answers = [signed_distance_up_to(vertices, shapes, 0, 1, no_seed, margin, scratch)]
            answers += [signed_distance_coherent(vertices, shapes, 0, 1, margin, scratch, memory, 0) for _ in range(2)]
            for status, bound, along, _, _ in answers:
                assert status == CONVERGED
                assert gap_along(vertices, shapes, 0, 1, along) >= bound - 1e-15
                assert bound == pytest.approx(distance, abs=1e-11) if share > 1.0 else margin < bound <= distance + 1e-11
