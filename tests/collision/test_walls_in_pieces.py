"""Eq. 1 on whole bodies: corners of walls pass by pass, and one wall cut into 1 to 64 pieces, slivers among them.

Pieces at the rim of an overlap are less deep, or have their shortest way out sideways. So a cut may shorten one pass (to 65 %
of the depth below) and let the body drift (by 16 %); a sliver at the body's own edge is a corner of two walls, whose rest halves
with every pass (30 %). No cut makes a pass go too far, and passes end at the height of the uncut wall.
"""

import numpy as np
import pytest

from avatarsim.collision.status import CONVERGED
from avatarsim.paper.push_apart import global_depth
from tests.collision.solids import SCRATCH, as_arrays, ball, box, hull_of_ellipsoid

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

DEPTH = 0.05
BODIES = {"cube": box(0.2, 0.2, 0.2), "ball": ball(0.2), "hull": hull_of_ellipsoid((0.3, 0.2, 0.2), 8, 3)}


def push(body, pieces):
    """Status and PD_g of one body in the pieces of another."""
    vertices, shapes = as_arrays(body, *pieces)
    starts = np.array([0, 1, 1 + len(pieces)])
    status, pushed, count = global_depth(vertices, shapes, starts, 0, 1, SCRATCH)
    return status, np.array(pushed), count


def wall(cuts):
    """A wall 1 m thick with its surface at z = 0, cut at right angles to x."""
    return [
        box(0.5 * (high - low), 1.0, 0.5).moved(shift=(0.5 * (low + high), 0.0, -0.5))
        for low, high in zip(cuts, cuts[1:], strict=False)
    ]


def sunk(name, x):
    """A body DEPTH deep in the wall."""
    body = BODIES[name]
    return body.moved(shift=(x, 0.0, -body.rows[:, 2].min() + body.radius - DEPTH))


def cleared(body, pieces, most):
    """Passes until less than a micrometre is left, and how far the body went."""
    way = np.zeros(3)
    for passes in range(most + 1):
        status, pushed, _ = push(body.moved(shift=way), pieces)
        assert status == CONVERGED
        if np.linalg.norm(pushed) < 1e-6:
            return passes, way
        way += pushed
    raise AssertionError(f"still {np.linalg.norm(pushed)} m after {most} passes")


EVEN = [list(np.linspace(-1.0, 1.0, count + 1)) for count in (1, 2, 3, 4, 8, 13, 16, 32, 64)]
SLIVERS = [[-1.0, at - 0.5 * width, at + 0.5 * width, 1.0] for width in (1e-2, 1e-4, 1e-6) for at in (0.0, 0.2)]


@pytest.mark.parametrize("cuts", [*EVEN[:7], *SLIVERS[::2]])
@pytest.mark.parametrize("x", [0.0, 0.0137])
def test_a_cut_or_a_sliver_under_the_flat_face_changes_nothing(cuts, x):
    status, pushed, _ = push(sunk("cube", x), wall(cuts))
    assert status == CONVERGED
    np.testing.assert_allclose(pushed, (0.0, 0.0, DEPTH), atol=1e-12)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("x", [0.0, 0.0137])
@pytest.mark.parametrize(("cuts", "least", "drift", "passes", "drift_in_all"), [
    *((cuts, 0.66, 0.12, 6, 0.12) for cuts in EVEN), *((cuts, 0.64, 0.16, 16, 0.3) for cuts in SLIVERS),
])
def test_no_cut_goes_too_far_and_few_passes_end_where_the_uncut_wall_does(name, x, cuts, least, drift, passes, drift_in_all):
    status, pushed, _ = push(sunk(name, x), wall(cuts))
    assert status == CONVERGED
    assert least * DEPTH < pushed[2] < DEPTH + 1e-12
    assert abs(pushed[0]) < drift * DEPTH and abs(pushed[1]) < 1e-12
    taken, way = cleared(sunk(name, x), wall(cuts), passes)
    assert taken >= 1
    np.testing.assert_allclose(way[2], DEPTH, atol=2e-6)
    assert abs(way[0]) < drift_in_all * DEPTH


def test_a_sliver_at_the_edge_of_a_cube_is_a_corner_of_two_walls():
    pieces, way, left = wall([-1.0, 0.2 - 1e-6, 0.2 + 1e-6, 1.0]), np.zeros(3), []
    for _ in range(10):
        pushed = push(sunk("cube", 0.0137).moved(shift=way), pieces)[1]
        left.append(np.linalg.norm(pushed))
        way += pushed
    np.testing.assert_allclose(np.divide(left[3:], left[2:-1]), 0.5, atol=0.01)
