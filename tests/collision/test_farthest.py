"""The scans of a hull's vertices against numpy: the same row and the same product, ties, and what is no number."""

import numpy as np
import pytest

from avatarsim.collision.support import farthest, largest
from avatarsim.spatial.vec3 import dot

pytestmark = pytest.mark.nojit


@pytest.mark.parametrize("many", [*range(1, 10), 16, 23, 52, 300])
def test_the_lowest_row_of_those_with_the_largest_product(many):
    rng = np.random.default_rng(many)
    rows = rng.normal(size=(many + 9, 3))
    rows[:5], rows[5 + many :] = 1e9, 1e9  # never read
    for k in range(60):
        if k == 30:  # from here on, with ties
            rows[5 : 5 + many] = rows[5 : 5 + many].round()
        d = tuple(float(x) for x in (rng.normal(size=3) if k % 3 else np.eye(3)[k % 9 // 3]))
        products = np.array([dot(tuple(x), d) for x in rows[5 : 5 + many].tolist()])
        assert farthest(rows, 5, 5 + many, d) == 5 + int(products.argmax())
        assert largest(rows, 5, 5 + many, d) == products.max()


@pytest.mark.parametrize("many", [3, 40])
def test_of_nothing_but_nan_the_first_row(many):
    rows = np.full((many, 3), np.nan)
    assert farthest(rows, 0, many, (1.0, 0.0, 0.0)) == 0
    assert farthest(np.ones((many, 3)), 0, many, (np.nan, 0.0, 0.0)) == 0


@pytest.mark.parametrize("many", [1, 2, 3, 40])
def test_a_first_row_that_is_no_number_reaches_the_largest_product(many):
    rows = np.ones((many, 3))
    rows[0] = np.nan
    assert np.isnan(largest(rows, 0, many, (1.0, 0.0, 0.0)))


@pytest.mark.parametrize("many", [3, 4, 40])
def test_infinite_rows_are_farthest(many):
    for where in (many - 2, many - 1):
        rows = np.ones((many, 3))
        rows[where, 1] = np.inf
        assert farthest(rows, 0, many, (0.5, 1.0, 0.5)) == where
        assert largest(rows, 0, many, (0.5, 1.0, 0.5)) == np.inf
