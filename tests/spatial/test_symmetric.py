"""Symmetric matrices against numpy."""

import numpy as np
import pytest

from avatarsim.spatial.vec3 import solved

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


@pytest.mark.parametrize("seed", range(20))
def test_solved_is_that_of_numpy(seed: int) -> None:
    random = np.random.default_rng(seed)
    half, right = random.normal(size=(3, 3)), random.normal(size=3)
    matrix = half @ half.T + 0.1 * np.eye(3)
    a, b, c = (tuple(float(x) for x in column) for column in matrix.T)
    found = solved(a, b, c, tuple(float(x) for x in right))
    assert np.array(found) == pytest.approx(np.linalg.solve(matrix, right), rel=1e-9, abs=1e-12)
