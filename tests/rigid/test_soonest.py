"""The order of near pairs by time of impact against a search over all, and the pairs of a body against a search."""

import numpy as np
import pytest

from avatarsim.rigid.islands import NONE, build_tree, changed, make_soonest, next_of

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


@pytest.mark.parametrize("count", [1, 2, 3, 7, 21])
def test_the_soonest_is_that_of_a_search_through_all(count: int) -> None:
    rng = np.random.default_rng(count)
    everybody = [(a, b) for a in range(7) for b in range(a)]
    pairs = np.array([everybody[k] for k in rng.permutation(len(everybody))[:count]])
    # few different times, so that several pairs tie
    when = rng.integers(0, 5, count).astype(np.float64)
    when[rng.integers(0, count)] = np.inf
    soonest = make_soonest(7, 21)
    build_tree(soonest, pairs, when)
    for _ in range(40):
        assert soonest.tree[1] == int(np.argmin(when))
        p = int(rng.integers(0, count))
        when[p] = rng.choice([np.inf, float(rng.integers(0, 5))])
        changed(soonest, when, p, count)


def test_the_pairs_of_a_body_are_all_that_name_it_in_order() -> None:
    pairs = np.array([(0, 3), (1, 3), (2, 0), (3, 2), (1, 0)])
    soonest = make_soonest(5, 8)
    # what was there before does not matter
    build_tree(soonest, pairs[:, ::-1].copy(), np.zeros(5))
    build_tree(soonest, pairs, np.zeros(5))
    for b in range(4):
        found, p = [], int(soonest.head[b])
        while p != NONE:
            found.append(p)
            p = next_of(soonest, pairs, p, b)
        assert found == [k for k, pair in enumerate(pairs) if b in pair]
    assert soonest.head[4] == NONE


def test_who_never_meets_is_a_pair_of_nobody() -> None:
    pairs, soonest = np.array([(0, 1), (0, 2), (1, 2)]), make_soonest(3, 3)
    build_tree(soonest, pairs, np.array([0.5, np.inf, 0.2]))
    assert (soonest.head[0], soonest.head[2]) == (0, 2) and soonest.tree[1] == 2
    assert next_of(soonest, pairs, 0, 0) == NONE and next_of(soonest, pairs, 0, 1) == 2
