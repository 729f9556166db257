"""Most awkward 3,360 of 10,080 stratified pairs: nearly parallel, slivers 1:1000, 1e5 m from the origin (see judged.py)."""

import pytest

from tests.collision.many_pairs import tally
from tests.collision.strata import BATCH

BATCHES = 14


@pytest.mark.parametrize("stratum", ["parallel", "plates", "needles", "far"])
def test_every_awkward_pair_is_right_to_a_billionth_of_its_size(stratum, record_property):
    found = tally(stratum, 0, range(BATCHES), BATCHES * BATCH)
    record_property("worst_error", found.error)
    print(f"{stratum}: {found.pairs} pairs, by {dict(found.oracles)}, worst error {found.error:.2g} of size")
    assert found.failures == []
    assert found.statuses == {} and found.wrong_signs == 0
