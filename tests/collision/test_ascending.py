"""Sorting and merging against numpy's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.collision.broad_phase import merge_ascending, sort_ascending

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

KEYS = st.lists(st.integers(0, 2**62), max_size=60)


@given(KEYS, st.integers(0, 60))
@settings(deadline=None)
def test_sorts_the_first_keys_and_leaves_the_rest(keys: list[int], count: int) -> None:
    found, count = np.array(keys, dtype=np.int64), min(count, len(keys))
    sort_ascending(found, count)
    assert found.tolist() == sorted(keys[:count]) + keys[count:]


@given(KEYS, KEYS)
@settings(deadline=None)
def test_merges_what_is_new(keys: list[int], more: list[int]) -> None:
    found = np.array(sorted(keys) + [-1] * len(more), dtype=np.int64)
    merge_ascending(found, len(keys), np.array(sorted(more), dtype=np.int64), len(more))
    assert found.tolist() == sorted(keys + more)
