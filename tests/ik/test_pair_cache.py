"""The hash table of pairs against a dict that forgets nothing."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.ik.state import PROBES, axis_at, keep_axis, make_pair_cache, slot_of

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
PIECES = 5000
PAIRS = st.tuples(st.integers(0, PIECES - 1), st.integers(0, PIECES - 1))


@given(st.lists(st.tuples(PAIRS, st.booleans(), st.booleans()), max_size=400))
def test_what_is_known_of_a_pair_is_what_was_kept_or_nothing(asked: list[tuple[tuple[int, int], bool, bool]]) -> None:
    cache, known = make_pair_cache(1, PIECES), dict[tuple[int, int], tuple[float, float, float]]()
    for k, (pair, keeps, is_next_step) in enumerate(asked):
        cache.step[0] += is_next_step
        at = slot_of(cache, *pair)
        assert cache.key[at] == pair[0] * PIECES + pair[1] and (cache.key == cache.key[at]).sum() == 1
        assert axis_at(cache, at) in (known.get(pair, (0.0, 0.0, 0.0)), (0.0, 0.0, 0.0))
        if keeps:
            known[pair] = (float(k), 1.0, -1.0)
            keep_axis(cache, at, known[pair])
            assert cache.axis_step[at] == -1


@given(st.sets(PAIRS, max_size=PROBES), st.integers(1, 40))
def test_as_many_pairs_as_are_looked_at_are_all_remembered(pairs: set[tuple[int, int]], driven: int) -> None:
    cache = make_pair_cache(driven, PIECES)
    for k, pair in enumerate(sorted(pairs)):
        keep_axis(cache, slot_of(cache, *pair), (float(k), 0.0, 1.0))
    for k, pair in enumerate(sorted(pairs)):
        assert axis_at(cache, slot_of(cache, *pair)) == (float(k), 0.0, 1.0)


def test_a_pair_that_is_asked_for_in_every_step_is_never_forgotten() -> None:
    cache, rng = make_pair_cache(1, PIECES), np.random.default_rng(1)
    keep_axis(cache, slot_of(cache, 3, 7), (0.0, 0.0, 1.0))
    for step in range(500):
        cache.step[0] = step
        slot_of(cache, *rng.integers(PIECES, size=2).tolist())
        assert axis_at(cache, slot_of(cache, 3, 7)) == (0.0, 0.0, 1.0)
