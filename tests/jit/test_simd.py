"""The vector code of `farthest` against its Python, bit for bit, and what it makes of ties and of what is no number."""

import numpy as np
import pytest

from avatarsim.jit.kernel import kernel
from avatarsim.jit.simd import LANES, MANY, farthest

pytestmark = pytest.mark.nojit


@kernel
def compiled(vertices: np.ndarray, first: int, last: int, d: tuple[float, float, float]) -> int:
    """As kernels call it; under NUMBA_DISABLE_JIT the Python itself."""
    return farthest(vertices, first, last, d)


@pytest.mark.parametrize("many", [1, 2, LANES - 1, LANES, LANES + 1, MANY - 1, MANY, MANY + 1, 23, 24, 25, 52, 300])
def test_the_same_row_as_one_after_the_other(many):
    rng = np.random.default_rng(many)
    rows = rng.normal(size=(many + 9, 3))
    rows[:5], rows[5 + many :] = 1e9, 1e9  # never read
    for k in range(60):
        if k == 30:  # from here on, with ties
            rows[5 : 5 + many] = rows[5 : 5 + many].round()
        d = tuple(float(x) for x in (rng.normal(size=3) if k % 3 else np.eye(3)[k % 9 // 3]))
        found = compiled(rows, 5, 5 + many, d)
        assert found == farthest(rows, 5, 5 + many, d) == 5 + int((rows[5 : 5 + many] @ d).argmax())


@pytest.mark.parametrize("many", [3, 40])
def test_of_nothing_but_nan_the_first_row(many):
    rows = np.full((many, 3), np.nan)
    assert compiled(rows, 0, many, (1.0, 0.0, 0.0)) == 0
    assert compiled(np.ones((many, 3)), 0, many, (np.nan, 0.0, 0.0)) == 0


@pytest.mark.parametrize("many", [3, 40])
def test_infinite_rows_are_farthest(many):
    rows = np.ones((many, 3))
    rows[many - 2, 1] = np.inf
    assert compiled(rows, 0, many, (0.5, 1.0, 0.5)) == many - 2
