"""Who is next in the queue of impacts, by looking again only at who was hit, against looking at everybody."""

import numpy as np
import pytest

from avatarsim.impact.contacts import add_contact, make_contacts, weigh
from avatarsim.impact.impact_queue import choose_block, fastest_approach, next_approach
from avatarsim.impact.masses import Masses

BODIES, POINTS = 7, 16


@pytest.mark.nojit
@pytest.mark.boundscheck
@pytest.mark.parametrize("seed", range(20))
def test_only_who_was_hit_is_faster_or_slower_than_before(seed: int) -> None:
    rng = np.random.default_rng(seed)
    contacts, hit = make_contacts(POINTS), np.ones(BODIES, np.int64)
    masses = Masses(np.array([0.0, *rng.uniform(0.5, 2.0, BODIES - 1)]), np.zeros((BODIES, 3, 3)))
    for _ in range(POINTS):
        a, b = rng.choice(BODIES, 2, replace=False)
        n = rng.normal(size=3)
        assert add_contact(contacts, a, b, 0, tuple(n / np.linalg.norm(n)), *map(tuple, rng.normal(size=(2, 3))), 0.0)
    weigh(contacts, masses)
    linear, angular = rng.normal(size=(BODIES, 3)), rng.normal(size=(BODIES, 3))
    linear[0], angular[0] = 0.0, 0.0
    for _ in range(4):
        head, fastest = fastest_approach(contacts, linear, angular)
        first, last, _ = choose_block(contacts, fastest)
        assert first <= head < last
        hit_ones = {b for k in range(first, last) if contacts.target[k] > -np.inf for b in contacts.body[k]} - {0}
        for b in hit_ones:
            linear[b] += rng.normal(size=3)
        found = next_approach(contacts, masses, first, last, linear, angular, hit)
        seen = contacts.approach.copy()
        assert found == fastest_approach(contacts, linear, angular)
        np.testing.assert_array_equal(seen, contacts.approach)
