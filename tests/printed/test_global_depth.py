"""Eq. 1 over the pieces of two bodies. Its own facts are in tests/paper/test_equation_1.py."""

import numpy as np
import pytest

from avatarsim.collision.scratch import PIECES_CAP
from avatarsim.collision.status import CANCELLING, CONVERGED, NOT_FINITE, OUT_OF_ITERATIONS, OUT_OF_ROOM
from avatarsim.paper.push_apart import global_depth
from tests.collision.solids import SCRATCH, as_arrays, ball, box, hull_of_ellipsoid

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def run(a_pieces, b_pieces):
    vertices, shapes = as_arrays(*a_pieces, *b_pieces)
    starts = np.array([0, len(a_pieces), len(a_pieces) + len(b_pieces)])
    status, pushed, count = global_depth(vertices, shapes, starts, 0, 1, SCRATCH)
    return status, np.array(pushed), count


def test_one_piece_each_gives_depth_times_normal_into_a():
    status, pushed, count = run([ball(0.5).moved(shift=(0, 0, 1.2))], [box(2.0, 2.0, 1.0)])
    assert (status, count) == (CONVERGED, 1)
    np.testing.assert_allclose(pushed, (0, 0, 0.3), atol=1e-14)


def test_pieces_that_are_apart_do_not_count():
    pieces = [ball(0.5).moved(shift=(0, 0, 1.2)), ball(0.5).moved(shift=(0, 0, 3.0))]
    assert run(pieces, [box(2.0, 2.0, 1.0)])[2] == 1
    status, pushed, count = run(pieces[1:], [box(2.0, 2.0, 1.0)])
    assert (status, count) == (CONVERGED, 0)
    assert not pushed.any()


def test_a_corner_of_two_walls_is_the_sum_of_both():
    walls = [box(0.1, 2.0, 2.0).moved(shift=(-0.5, 0, 0)), box(2.0, 0.1, 2.0).moved(shift=(0, -0.5, 0))]
    status, pushed, count = run([ball(0.5)], walls)
    assert (status, count) == (CONVERGED, 2)
    np.testing.assert_allclose(pushed, (0.05, 0.05, 0.0), atol=1e-14)


def test_between_two_equal_walls_the_pushes_cancel():
    walls = [box(0.1, 2.0, 2.0).moved(shift=(x, 0, 0)) for x in (-0.5, 0.5)]
    status, pushed, count = run([ball(0.5)], walls)
    assert (status, count) == (CANCELLING, 2)
    assert not pushed.any()


def test_the_status_of_a_piece_is_not_lost():
    apart = ball(0.1).moved(shift=(9.0, 9.0, 9.0))
    # Two nearly round hulls about one centre: thousands of ways out, nearly as short as each other.
    dotted, larger = hull_of_ellipsoid((0.3, 0.301, 0.302), 40, 19), hull_of_ellipsoid((0.5, 0.499, 0.498), 37, 17)
    assert run([apart, larger], [dotted, apart])[0] == OUT_OF_ITERATIONS
    broken = ball(0.1).moved(shift=(np.nan, 0.0, 0.0))
    assert run([ball(0.5), broken], [ball(0.5).moved(shift=(0.1, 0.0, 0.0))])[0] == NOT_FINITE


def test_more_pairs_than_fit_is_a_status():
    many = [ball(0.5).moved(shift=(0.001 * k, 0.0, 0.0)) for k in range(PIECES_CAP // 8 + 1)]
    eight = [ball(0.5).moved(shift=(0.0, 0.1 + 0.001 * k, 0.0)) for k in range(8)]
    assert run(many[:-1], eight)[0] == CONVERGED
    assert run(many, eight)[0] == OUT_OF_ROOM
