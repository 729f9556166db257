"""Eq. 7: v_n = n . v_ab."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.rigid.contact_law import normal_velocity, point_velocity, relative_velocity, tangential_velocity

V = tuple[float, float, float]
vectors = st.tuples(*[st.floats(-10.0, 10.0)] * 3)


@given(vectors, vectors, vectors, vectors, vectors, vectors)
def test_is_the_rate_of_the_gap(va: V, wa: V, ra: V, vb: V, wb: V, rb: V) -> None:
    """The gap of two points along n changes at v_n: finite difference of the motion itself."""
    n = np.array([2.0, -1.0, 2.0]) / 3.0
    h = 1e-6
    moved_a = np.array(ra) + h * (np.array(va) + np.cross(wa, ra))
    moved_b = np.array(rb) + h * (np.array(vb) + np.cross(wb, rb))
    rate = n @ ((moved_a - moved_b) - (np.array(ra) - np.array(rb))) / h
    v_ab = relative_velocity(point_velocity(va, wa, ra), point_velocity(vb, wb, rb))
    assert abs(normal_velocity(tuple(n), v_ab) - rate) < 1e-6
    v_t = np.array(tangential_velocity(tuple(n), v_ab))
    np.testing.assert_allclose(v_t + rate * n, v_ab, atol=1e-6)
    assert abs(v_t @ n) < 1e-12


def test_is_negative_while_the_bodies_approach() -> None:
    """n points out of B into A, so A falling onto B has v_n < 0."""
    assert normal_velocity((0.0, 0.0, 1.0), relative_velocity((0.0, 0.0, -2.0), (0.0, 0.0, 1.0))) == -3.0
