"""Eq. 1, PD_g = sum(pd^2 n) / |sum pd|: its effects and its limits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from avatarsim.collision.status import CANCELLING, CONVERGED, NOT_FINITE
from avatarsim.paper.push_apart import global_penetration_depth


def eq1(depths, normals):
    status, pushed = global_penetration_depth(
        np.array(depths, float), np.array(normals, float).reshape(-1, 3), len(depths)
    )
    return status, np.array(pushed)


depth = st.floats(1e-4, 1.0)


@given(depth, st.integers(1, 20))
@hypothesis_settings(deadline=None)
def test_equal_pieces_with_one_normal_give_exactly_their_depth(d, count):
    status, pushed = eq1([d] * count, [(0.0, 0.6, 0.8)] * count)
    assert status == CONVERGED
    np.testing.assert_allclose(pushed, (0.0, 0.6 * d, 0.8 * d), rtol=1e-14)


@pytest.mark.parametrize("walls", [1, 2, 3])
def test_a_corner_of_n_walls_loses_one_nth_of_its_depth(walls):
    start = 0.3
    depths = np.full(walls, start)
    for passes in range(1, 8):
        status, pushed = eq1(depths, np.eye(3)[:walls])
        assert status == CONVERGED
        assert np.linalg.norm(pushed) == pytest.approx(depths[0] / np.sqrt(walls), rel=1e-13)
        depths = depths - pushed[:walls]
        np.testing.assert_allclose(depths, start * (1.0 - 1.0 / walls) ** passes, atol=1e-14)
        if walls == 1:
            break


@given(depth, st.floats(0.0, 1.0))
@hypothesis_settings(deadline=None)
def test_unequal_depths_along_one_normal_fall_short_as_stated(d, ratio):
    _, pushed = eq1([d, ratio * d], [(0.0, 0.0, 1.0)] * 2)
    shortfall = d - pushed[2]
    assert shortfall == pytest.approx(d * ratio * (1.0 - ratio) / (1.0 + ratio), abs=1e-14)
    assert shortfall <= 0.17158 * d


def test_the_worst_shortfall_is_17_16_percent():
    shortfalls = {r: 1.0 - eq1([1.0, r], [(0.0, 0.0, 1.0)] * 2)[1][2] for r in np.linspace(0.0, 1.0, 2001)}
    worst = max(shortfalls, key=shortfalls.__getitem__)
    assert worst == pytest.approx(np.sqrt(2.0) - 1.0, abs=1e-3)
    assert shortfalls[worst] == pytest.approx(0.1716, abs=5e-5)


@pytest.mark.parametrize("off", [0.0, 1e-12, -1e-9])
def test_equal_opposite_normals_are_a_status_and_not_a_zero_push(off):
    status, pushed = eq1([0.5, 0.5 + off], [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)])
    assert status == CANCELLING
    assert not pushed.any()


def test_no_overlap_no_push_and_nan_is_a_status():
    for depths, normals, left in (([], [], 0.0), ([0.5, 0.2], [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)], 0.3)):
        status, pushed = eq1(depths, normals)
        assert status == CONVERGED
        np.testing.assert_allclose(pushed, (left, 0.0, 0.0), atol=1e-15)
    assert eq1([np.nan], [(0.0, 0.0, 1.0)])[0] == NOT_FINITE
    assert eq1([0.1], [(np.nan, 0.0, 1.0)])[0] != CONVERGED
