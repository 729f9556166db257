"""Vectors as tuples, and symmetric systems, against numpy; the minimal standard generator against its published numbers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.spatial.random import MODULUS, draw, seeded
from avatarsim.spatial.vec3 import add, along, cross, dot, neg, norm, perpendicular, put_row, row, scale, solved, sub, unit

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

# Squares below 1e-308 are not numbers any more, and no length in metres is near 1e-154.
number = st.floats(-1e3, 1e3).map(lambda x: x if abs(x) > 1e-100 else 0.0)
vector = st.tuples(number, number, number)


@settings(deadline=None)
@given(vector, vector, number)
def test_each_operation_equals_numpy(a, b, s):
    x, y = np.array(a), np.array(b)
    assert add(a, b) == tuple(x + y)
    assert sub(a, b) == tuple(x - y)
    assert neg(a) == tuple(-x)
    assert scale(a, s) == tuple(x * s)
    np.testing.assert_allclose(along(a, s, b), x + s * y, atol=1e-9)
    np.testing.assert_allclose(dot(a, b), x @ y, atol=1e-9)
    np.testing.assert_allclose(cross(a, b), np.cross(x, y), atol=1e-9)
    np.testing.assert_allclose(norm(a), np.linalg.norm(x), atol=1e-12)


@settings(deadline=None)
@given(vector)
def test_perpendicular_is_a_unit_vector_at_right_angles(a):
    p = perpendicular(a)
    assert abs(norm(p) - 1.0) < 1e-14
    assert abs(dot(p, a)) <= 1e-15 * norm(a)


def test_perpendicular_of_zero_is_still_a_direction():
    assert perpendicular((0.0, 0.0, 0.0)) == (0.0, 0.0, 1.0)


def test_unit_of_zero_is_not_finite_so_that_no_test_passes_it():
    with np.errstate(all="ignore"):
        try:
            result = unit((0.0, 0.0, 0.0))
        except ZeroDivisionError:  # plain Python, without the JIT
            return
    assert not np.isfinite(result).any()


def test_rows_go_in_and_out_of_an_array():
    m = np.zeros((3, 3))
    put_row(m, 1, (1.0, 2.0, 3.0))
    assert row(m, 1) == (1.0, 2.0, 3.0)
    assert m.sum() == 6.0


@pytest.mark.parametrize("seed", range(20))
def test_solved_is_that_of_numpy(seed: int) -> None:
    random = np.random.default_rng(seed)
    half, right = random.normal(size=(3, 3)), random.normal(size=3)
    matrix = half @ half.T + 0.1 * np.eye(3)
    a, b, c = map(tuple, matrix.T.tolist())
    found = solved(a, b, c, tuple(right.tolist()))
    assert np.array(found) == pytest.approx(np.linalg.solve(matrix, right), rel=1e-9, abs=1e-12)


def test_ten_thousandth_number_is_the_published_one() -> None:
    # C++ standard, [rand.predef]: the 10000th invocation of a default minstd_rand gives 399268537
    state = np.array([1], dtype=np.int64)
    numbers = [draw(state, MODULUS) for _ in range(10_000)]
    assert numbers[-1] == 399268537


def test_equal_seeds_give_equal_numbers_and_others_do_not() -> None:
    one, again, other = seeded(1), seeded(1), seeded(2)
    first = [draw(one, 1000) for _ in range(20)]
    assert first == [draw(again, 1000) for _ in range(20)]
    assert first != [draw(other, 1000) for _ in range(20)]


def test_numbers_stay_below_the_bound_and_reach_each() -> None:
    state = seeded(0)
    assert {draw(state, 5) for _ in range(200)} == set(range(5))
