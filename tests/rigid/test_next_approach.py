"""The next contact in the queue of impacts, updated only for bodies that were hit, against a search over all."""

import numpy as np
import pytest

from avatarsim.rigid.contacts import Masses, add_contact, make_contacts, weigh
from avatarsim.rigid.impacts import REST_SPEED, TIE, chain_by_body, choose_block, fastest_approach, next_approach

BODIES, POINTS = 7, 16


@pytest.mark.nojit
@pytest.mark.boundscheck
@pytest.mark.parametrize("seed", range(20))
def test_only_who_was_hit_is_faster_or_slower_than_before(seed: int) -> None:
    rng = np.random.default_rng(seed)
    contacts, newest, older = make_contacts(POINTS), np.full(BODIES, 3), np.full((POINTS, 2), 5)
    masses = Masses(np.array([0.0, *rng.uniform(0.5, 2.0, BODIES - 1)]), np.zeros((BODIES, 3, 3)))
    for _ in range(POINTS):
        a, b = rng.choice(BODIES, 2, replace=False)
        n = rng.normal(size=3)
        assert add_contact(contacts, a, b, 0, tuple(n / np.linalg.norm(n)), *map(tuple, rng.normal(size=(2, 3))), 0.0)
    weigh(contacts, masses)
    linear, angular = rng.normal(size=(BODIES, 3)), rng.normal(size=(BODIES, 3))
    linear[0], angular[0] = 0.0, 0.0
    chain_by_body(contacts, masses, newest, older)
    for _ in range(4):
        head, fastest = fastest_approach(contacts, linear, angular)
        first, last, _ = choose_block(contacts, fastest)
        assert first <= head < last
        hit_ones = {b for k in range(first, last) if contacts.target[k] > -np.inf for b in contacts.body[k]} - {0}
        for b in hit_ones:
            linear[b] += rng.normal(size=3)
        found = next_approach(contacts, first, last, linear, angular, newest, older)
        seen = contacts.approach.copy()
        assert found == fastest_approach(contacts, linear, angular)
        assert found == (int(np.argmin(seen)), seen.min())
        np.testing.assert_array_equal(seen, contacts.approach)


def whole_table(contacts, fastest: float) -> tuple[int, int, int]:
    """The dumb twin of `choose_block`: pair by pair, through all of them."""
    count, start, chosen = int(contacts.used[0]), 0, []
    while start < count:
        pair = [k for k in range(start, count) if (contacts.body[start : k + 1] == contacts.body[start]).all()]
        tied = any(contacts.approach[k] <= fastest * (1.0 - TIE) for k in pair)
        for k in pair:
            v = contacts.approach[k]
            target = -contacts.restitution[k] * v if v < 0.0 else 0.0
            contacts.target[k] = -np.inf if not tied else target if target > REST_SPEED else 0.0
        chosen += pair if tied else []
        start = pair[-1] + 1
    return min(chosen), max(chosen) + 1, len(chosen)


@pytest.mark.nojit
@pytest.mark.boundscheck
@pytest.mark.parametrize("seed", range(20))
def test_a_block_is_all_pairs_that_tie(seed: int) -> None:
    rng = np.random.default_rng(seed)
    contacts = make_contacts(POINTS)
    for k in range(POINTS):
        assert add_contact(contacts, 1 + k // 3, 0, 0, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)
    contacts.approach[:] = rng.choice([-1.0, -0.5, -1e-3, 0.2], POINTS)
    contacts.approach[int(rng.integers(POINTS))] = -1.0
    contacts.restitution[:] = rng.choice([0.0, 0.5], POINTS)
    first, last, points = choose_block(contacts, -1.0)
    targets = contacts.target[first:last].copy()
    assert (first, last, points) == whole_table(contacts, -1.0)
    np.testing.assert_array_equal(targets, contacts.target[first:last])
