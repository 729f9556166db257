"""How long a gap takes to close, against the parabola's roots."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.rigid.contacts import DRIVEN_A, NOT_DRIVEN, add_contact, make_contacts
from avatarsim.rigid.impacts import time_to_close, time_to_contact

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


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
