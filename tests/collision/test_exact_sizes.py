"""1,740 of 10,080 stratified pairs: all scales, unequal sizes, and the large hulls (see judged.py)."""

import pytest

from tests.collision.many_pairs import tally
from tests.collision.strata import BATCH

BATCHES = 14


@pytest.mark.parametrize(("stratum", "batches"), [("scales", BATCHES), ("unequal", BATCHES), ("large", 1)])
def test_every_pair_of_this_size_is_right_to_a_billionth_of_it(stratum, batches, record_property):
    found = tally(stratum, 0, range(batches), batches * BATCH)
    record_property("worst_error", found.error)
    print(f"{stratum}: {found.pairs} pairs, by {dict(found.oracles)}, worst error {found.error:.2g} of size")
    assert found.failures == []
    assert found.statuses == {} and found.wrong_signs == 0
