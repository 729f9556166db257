"""Eq. 4, p' = p - (a . (p - o)) a: projection onto the joint plane. (The printed equation calls a by n in one place.)"""

import numpy as np
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from avatarsim.paper.ccd_ik import projected

coordinate = st.floats(-2.0, 2.0)
point = st.tuples(coordinate, coordinate, coordinate)


@given(point, point, point.filter(lambda a: np.linalg.norm(a) > 0.1))
@hypothesis_settings(deadline=None)
def test_it_drops_exactly_the_part_along_the_axis(p, origin, axis):
    a = np.array(axis) / np.linalg.norm(axis)
    found = np.array(projected(p, origin, tuple(a)))
    # the plain twin: the projection matrix
    dumb = np.array(origin) + (np.eye(3) - np.outer(a, a)) @ (np.array(p) - origin)
    np.testing.assert_allclose(found, dumb, atol=1e-14)
    assert abs(a @ (found - origin)) <= 1e-14
    np.testing.assert_allclose(projected(tuple(found), origin, tuple(a)), found, atol=1e-14)


def test_the_equation_as_printed_would_not_project():
    """With some other vector n in the dot product the point does not land in the plane: why the mend is needed."""
    p, axis, other = np.array([1.0, 0.0, 0.5]), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    assert (p - (other @ p) * axis) @ axis == -0.5
    assert projected((1.0, 0.0, 0.5), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)) == (1.0, 0.0, 0.0)
