"""The first tetrahedron: never flat where A - B is not, oriented, and honest about flat A - B."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.epa import grow_tetrahedron
from avatarsim.collision.gjk import WHOLE, add_support
from avatarsim.collision.scratch import make_scratch
from tests.collision.solids import as_arrays, ball, box, capsule, ellipsoid

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def grown(a, b):
    scratch = make_scratch()
    vertices, shapes = as_arrays(a, b)
    add_support(vertices, shapes, 0, 1, (1.0, 0.0, 0.0), WHOLE, 0, scratch)
    size = max(a.size, b.size)
    return grow_tetrahedron(vertices, shapes, 0, 1, WHOLE, 1, size, scratch), scratch.w


TURN = Rotation.from_rotvec([0.3, 1.1, -0.4])


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [
        (ball(1.0), ball(0.5), 1),
        (ball(1.0), capsule(0.5, 1.0).moved(TURN), 2),
        (capsule(0.1, 0.5).moved(TURN), capsule(0.5, 1.0).moved(TURN), 2),
        (capsule(0.1, 0.5), capsule(0.5, 1.0).moved(TURN), 3),
        (box(1.0, 1.0, 0.0).moved(TURN), ball(0.1), 3),
        (capsule(0.1, 0.5), box(1.0, 1.0, 1e-3).moved(TURN), 4),
        (ellipsoid(0.5, 0.4, 0.3), ball(0.1), 4),
    ],
)
def test_counts_the_dimensions_of_the_difference(a, b, expected):
    assert grown(a, b)[0] == expected


def test_the_fourth_point_is_below_the_first_three():
    for k in range(20):
        turn = Rotation.from_rotvec([0.3 * k, 1.1, -0.4])
        points, w = grown(box(1.0, 0.5, 0.2).moved(turn), ellipsoid(0.3, 0.2, 0.1))
        assert points == 4
        assert np.linalg.det(w[1:4] - w[0]) < -1e-3
