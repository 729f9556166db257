"""Contact force warm start: forces of the last segment come back to the points that had them, against a plain dictionary."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.rigid.contacts import Contacts, make_contacts, make_last_forces, recall_forces, remember_forces

BODIES, ROOM = 5, 8
H = 0.01

BODY = st.integers(0, BODIES - 1)
SEGMENTS = st.lists(
    st.dictionaries(st.integers(0, 40), st.tuples(BODY, BODY), min_size=1, max_size=ROOM), min_size=1, max_size=6,
)
"""Of each segment which points there are, and the bodies of each."""


def points(keys: list[int], bodies: list[tuple[int, int]], friction: float) -> Contacts:
    """Contact points of these keys and bodies."""
    contacts = make_contacts(ROOM, bodies=BODIES)
    contacts.used[0] = len(keys)
    contacts.key[: len(keys)], contacts.body[: len(keys)], contacts.friction[:] = keys, bodies, friction
    return contacts


@pytest.mark.nojit
@pytest.mark.boundscheck
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


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_a_point_that_is_only_foreseen_gets_no_force_along_its_tangents() -> None:
    """It touched a segment ago and had friction; that it has none now must not leave it what is not taken back."""
    table = make_last_forces(BODIES, ROOM)
    contacts = points([7], [(1, 2)], 0.5)
    contacts.impulse[0] = 3.0, 2.0, 1.0
    remember_forces(contacts, 1.0, np.array([1, 2]), table)
    for friction, expected in ((0.5, [3.0, 2.0, 1.0]), (0.0, [3.0, 0.0, 0.0])):
        again = points([7], [(1, 2)], friction)
        recall_forces(again, table)
        assert again.impulse[0].tolist() == expected
