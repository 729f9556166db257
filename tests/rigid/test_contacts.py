"""Contacts: their queue of approaches, times to close, forces of the last segment and tensors, against plain twins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.rigid.contacts import (
    DRIVEN_A,
    NOT_DRIVEN,
    Contacts,
    Masses,
    add_contact,
    is_diagonal,
    make_contacts,
    make_last_forces,
    recall_forces,
    remember_forces,
    to_world,
    weigh,
)
from avatarsim.rigid.impacts import (
    REST_SPEED,
    TIE,
    chain_by_body,
    choose_block,
    fastest_approach,
    next_approach,
    time_to_close,
    time_to_contact,
)

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
BODIES, POINTS = 7, 16


@pytest.mark.parametrize("seed", range(20))
def test_only_who_was_hit_is_faster_or_slower_than_before(seed: int) -> None:
    rng = np.random.default_rng(seed)
    contacts, newest, older = make_contacts(POINTS), np.full(BODIES, 3), np.full((POINTS, 2), 5)
    masses = Masses(np.array([0.0, *rng.uniform(0.5, 2.0, BODIES - 1)]), np.zeros((BODIES, 3, 3)))
    for _ in range(POINTS):
        a, b = rng.choice(BODIES, 2, replace=False)
        n, arms = rng.normal(size=3), rng.normal(size=(2, 3))
        assert add_contact(contacts, a, b, 0, tuple(n / np.linalg.norm(n)), tuple(arms[0]), tuple(arms[1]), 0.0)
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
    """Return the plain twin of `choose_block`: pair by pair, through all of them."""
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


@given(st.floats(0.0, 1e-6), st.floats(-100.0, -1e-3), st.floats(-50.0, 50.0))
def test_it_is_the_first_root(gap: float, v: float, a: float) -> None:
    t = time_to_close(gap, v, a)
    if v * v >= 2.0 * a * gap:
        assert abs(gap + v * t + 0.5 * a * t * t) <= 1e-14
        assert v + a * t <= 1e-9
    else:
        # never touching: the gap is least there
        assert gap + v * t + 0.5 * a * t * t <= gap - 0.49 * v * v / a + 0.5 * (v + a * t) ** 2 / a


def contact_time(gap: float, driven: int = NOT_DRIVEN, other: float = 1.0) -> float:
    """Two points of the pair (0, 1), `gap` and `other` wide, and one of another pair that closes sooner; A comes at 4 m/s."""
    contacts = make_contacts(4)
    for a, b, width in ((0, 1, gap), (0, 1, other), (0, 2, 1e-12)):
        assert add_contact(contacts, a, b, driven, (0.0, 0.0, 1.0), (0.0, 0.0, -0.1), (0.0, 0.0, 0.1), width)
    linear = np.array([[0.0, 0.0, -4.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    still = np.zeros((3, 3))
    return float(time_to_contact(contacts, 0, linear, still, still, still))


def test_the_pair_s_earliest_point_counts() -> None:
    assert contact_time(2e-8) == pytest.approx(5e-9, rel=1e-12)
    assert contact_time(2e-8, other=1e-8) == pytest.approx(2.5e-9, rel=1e-12)


def test_an_overlap_and_a_driven_body_meet_at_once() -> None:
    assert contact_time(-1e-7) == 0.0
    assert contact_time(1e-4, DRIVEN_A) == 0.0


ROOM = 8
H = 0.01

BODY = st.integers(0, BODIES - 1)
SEGMENTS = st.lists(
    st.dictionaries(st.integers(0, 40), st.tuples(BODY, BODY), min_size=1, max_size=ROOM), min_size=1, max_size=6,
)
"""Of each segment which points there are, and the bodies of each."""


def points(keys: list[int], bodies: list[tuple[int, int]], friction: float) -> Contacts:
    """Return contact points of these keys and bodies."""
    contacts = make_contacts(ROOM, bodies=BODIES)
    contacts.used[0] = len(keys)
    contacts.key[: len(keys)], contacts.body[: len(keys)], contacts.friction[:] = keys, bodies, friction
    return contacts


@given(SEGMENTS)
def test_a_point_begins_with_the_force_that_it_had(segments: list[dict[int, tuple[int, int]]]) -> None:
    """Forces of a point are known as long as one of its bodies has had no other segment since."""
    table = make_last_forces(BODIES, ROOM)
    known: dict[int, tuple[int, tuple[int, int], np.ndarray]] = {}
    latest = dict.fromkeys(range(BODIES), 0)
    for turn, segment in enumerate(segments, start=1):
        contacts = points(list(segment), list(segment.values()), 0.5)
        recall_forces(contacts, table)
        for k, key in enumerate(segment):
            then, bodies, force = known.get(key, (0, (0, 0), np.zeros(3)))
            fresh = key in known and latest[bodies[0]] == then
            np.testing.assert_array_equal(contacts.impulse[k], force if fresh else np.zeros(3))
        contacts.impulse[: len(segment)] = H * (np.arange(3.0 * len(segment)).reshape(-1, 3) + turn)
        members = np.unique([body for pair in segment.values() for body in pair])
        remember_forces(contacts, H, members, table)
        for k, (key, pair) in enumerate(segment.items()):
            known[key] = turn, pair, contacts.impulse[k] * (1.0 / H)
        latest.update(dict.fromkeys(members.tolist(), turn))


def test_a_foreseen_point_gets_no_tangential_force() -> None:
    """It touched a segment ago and had friction; without friction now, no part of that force may stay with it."""
    table = make_last_forces(BODIES, ROOM)
    contacts = points([7], [(1, 2)], 0.5)
    contacts.impulse[0] = 3.0, 2.0, 1.0
    remember_forces(contacts, 1.0, np.array([1, 2]), table)
    for friction, expected in ((0.5, [3.0, 2.0, 1.0]), (0.0, [3.0, 0.0, 0.0])):
        again = points([7], [(1, 2)], friction)
        recall_forces(again, table)
        assert again.impulse[0].tolist() == expected


def turns(seed: int) -> np.ndarray:
    """Return rotations at random."""
    drawn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(BODIES, 3, 3)))
    return np.ascontiguousarray(drawn * np.linalg.det(drawn)[:, None, None])


@pytest.mark.parametrize("seed", range(5))
def test_diagonal_or_not_it_is_the_product_of_three(seed: int) -> None:
    rng, turn = np.random.default_rng(seed), turns(seed)
    half = rng.normal(size=(BODIES, 3, 3))
    tensors = half @ half.transpose(0, 2, 1)
    for b in range(0, BODIES, 2):
        tensors[b] = np.diag(rng.uniform(0.1, 3.0, 3))
    found = np.zeros_like(tensors)
    for b in range(BODIES):
        assert is_diagonal(tensors, b) == (b % 2 == 0)
        to_world(tensors, turn, b, found)
    np.testing.assert_allclose(found, turn @ tensors @ turn.transpose(0, 2, 1), rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("at", [(0, 1), (0, 2), (1, 2), (1, 0), (2, 0), (2, 1)])
def test_one_number_beside_the_diagonal_is_seen(at: tuple[int, int]) -> None:
    tensors = np.tile(np.eye(3), (1, 1, 1))
    assert is_diagonal(tensors, 0)
    tensors[0][at] = 1e-300
    assert not is_diagonal(tensors, 0)
