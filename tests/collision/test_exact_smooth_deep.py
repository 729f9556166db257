"""Ellipsoids deep in everything else: 840 pairs of every outline and size, concentric ones among them (see judged.py)."""

from tests.collision.many_pairs import tally
from tests.collision.strata import BATCH

BATCHES = 14


def test_every_ellipsoid_deep_in_something_is_right_to_a_billionth_of_its_size():
    found = tally("smooth-deep", 0, range(BATCHES), BATCHES * BATCH)
    print(f"{found.pairs} pairs, by {dict(found.oracles)}, worst error {found.error:.2g} of size")
    assert found.failures == []
    assert found.statuses == {} and found.wrong_signs == 0
