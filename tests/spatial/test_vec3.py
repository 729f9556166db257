"""Vectors as tuples against numpy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.spatial.vec3 import (
    add,
    along,
    cross,
    dot,
    neg,
    norm,
    perpendicular,
    put_row,
    row,
    scale,
    sub,
    unit,
)

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
