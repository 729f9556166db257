"""Islands: which bodies hold together, and which pairs belong to which."""

import numpy as np
import pytest

from avatarsim.rigid.islands import behind, make_islands, part


@pytest.mark.nojit
def test_fixed_bodies_hold_nobody_together_and_driven_ones_do() -> None:
    """0 is fixed, 5 is driven; 1-2 touch each other, 3 and 4 meet only the driven one, 6 flies alone."""
    pairs = np.array([[0, 1], [0, 3], [1, 2], [3, 5], [4, 5], [0, 6]])
    islands = make_islands(7, 10)
    moving = np.array([0, 1, 1, 1, 1, 0, 1])
    joins = np.array([0, 1, 1, 1, 1, 1, 1])
    part(islands, pairs, len(pairs), moving, joins, np.arange(len(moving)))
    assert islands.found[0] == 3
    first, at = islands.first, islands.pair_first
    members = [islands.order[first[i] : first[i + 1]].tolist() for i in range(3)]
    own = [islands.pairs[at[i] : at[i + 1]].tolist() for i in range(3)]
    assert members == [[1, 2], [3, 4, 5], [6]]
    assert own == [[[0, 1], [1, 2]], [[0, 3], [3, 5], [4, 5]], [[0, 6]]]


@pytest.mark.nojit
def test_who_is_behind_goes_first() -> None:
    """Of islands at 0.2, 0.1 and 0.3 s it is the second; once all are at the end it is none."""
    islands = make_islands(3, 1)
    part(islands, np.zeros((0, 2), np.int64), 0, np.ones(3, np.int64), np.ones(3, np.int64), np.arange(3))
    islands.due[:] = (0.2, 0.1, 0.3)
    assert behind(islands, 1.0, 0.0, 2) == 1
    islands.due[:] = 1.0
    assert behind(islands, 1.0, 0.0, 0) == -1
