"""The compact pair filter against a matrix."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.model.geometry import OPEN, may_meet, pair_filter

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


@given(st.integers(0, 10**6), st.integers(2, 30))
@settings(deadline=None, max_examples=50)
def test_says_what_a_matrix_says(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    family = rng.integers(-1, 3, count)
    skipped = [(int(a), int(b)) for a, b in rng.integers(0, count, (2 * count, 2)) if a != b]
    matrix = (family[:, None] != family) | (family == OPEN)
    for a, b in skipped:
        matrix[a, b] = matrix[b, a] = False
    wanted = pair_filter(family, skipped)
    for a in range(count):
        for b in range(count):
            assert a == b or may_meet(wanted, a, b) == matrix[a, b]


def test_memory_is_linear() -> None:
    wanted = pair_filter([OPEN] * 20000, [(k, k + 1) for k in range(19999)])
    assert sum(array.nbytes for array in wanted) == 8 * (20000 + 20001 + 19999)
    assert not may_meet(wanted, 500, 499) and may_meet(wanted, 500, 498)
