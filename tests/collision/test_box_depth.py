"""Depth of boxes by their fifteen normals against EPA, which knows nothing of them; and what is left to it."""

from math import inf

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.epa import epa
from avatarsim.collision.gjk import gjk
from avatarsim.collision.primitives import are_boxes, box_depth
from avatarsim.collision.status import CONVERGED
from avatarsim.collision.support import gap_along
from tests.collision.solids import NO_SEED, SCRATCH, Solid, as_arrays, box, random_hull

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def inside(point, solid, slack):
    """Whether a point is in a box given by its corners, but for some slack [m]."""
    low, edges = solid.rows[0], solid.rows[[4, 2, 1]] - solid.rows[0]
    shares = np.linalg.solve(edges.T, np.asarray(point) - low)
    return (np.abs(shares - 0.5) <= 0.5 + slack / np.linalg.norm(edges, axis=1).min()).all()


def check(a, b):
    """Depth, normal and points against EPA; returns whether the formula answered."""
    vertices, shapes = as_arrays(a, b)
    assert are_boxes(shapes, 0, 1)
    known, distance, n, on_a, on_b = box_depth(vertices, shapes, 0, 1)
    if not known:
        return False
    size = max(a.size, b.size)
    count = gjk(vertices, shapes, 0, 1, NO_SEED, inf, SCRATCH)[3]
    status, _, depth, _, _ = epa(vertices, shapes, 0, 1, NO_SEED, count, SCRATCH)
    assert status == CONVERGED
    assert distance == pytest.approx(-depth, abs=1e-11 * size)
    assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-14)
    assert gap_along(vertices, shapes, 0, 1, n) == pytest.approx(distance, abs=1e-11 * size)
    np.testing.assert_allclose(np.subtract(on_a, on_b), distance * np.array(n), atol=1e-11 * size)
    assert inside(on_a, a, 1e-8 * size) and inside(on_b, b, 1e-8 * size)
    return True


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_boxes_in_any_position(scale):
    rng = np.random.default_rng(61)
    answered = 0
    for _ in range(60):
        a, b = (
            box(*rng.choice([0.01, 0.2, 0.5, 1.0], 3)).moved(
                Rotation.from_quat(rng.normal(size=4)), rng.normal(size=3) * 0.2 * scale, scale
            )
            for _ in range(2)
        )
        answered += check(a, b)
    assert answered > 25


@pytest.mark.parametrize("angle", [1e-3, 1e-6, 1e-9, 1e-12, 1e-14])
def test_edges_nearly_parallel(angle):
    rng = np.random.default_rng(62)
    for _ in range(20):
        turn = Rotation.from_rotvec(angle * rng.normal(size=3)) * Rotation.from_rotvec([0.7 * rng.normal(), 0.0, 0.0])
        check(box(1.0, 0.3, 0.2), box(0.8, 0.2, 0.3).moved(turn, rng.normal(size=3) * 0.15))


def test_sheared_boxes():
    rng = np.random.default_rng(63)
    shear = np.array([[1.0, 0.0, 0.0], [0.4, 1.0, 0.2], [0.0, 0.3, 1.0]])
    a = Solid(box(0.5, 0.4, 0.3).rows @ shear)
    turned = [box(0.3, 0.4, 0.2).moved(Rotation.from_quat(rng.normal(size=4)), rng.normal(size=3) * 0.2) for _ in range(40)]
    assert sum(check(a, b) for b in turned) > 20


def test_what_is_left_to_the_algorithms():
    bent = box(0.5, 0.4, 0.3)
    bent.rows[6] += (1e-9, 0.0, 0.0)
    a = box(0.5, 0.4, 0.3)
    far, touching, broken = a.moved(shift=(3.0, 0.0, 0.0)), a.moved(shift=(1.0, 0.0, 0.0)), a.moved(shift=(np.nan, 0.0, 0.0))
    for b in (bent, far, touching, broken, box(0.5, 0.4, 0.0)):
        vertices, shapes = as_arrays(a, b)
        assert not box_depth(vertices, shapes, 0, 1)[0]
        assert not box_depth(vertices, shapes, 1, 0)[0]
    assert not are_boxes(as_arrays(a, random_hull(np.random.default_rng(1), 20))[1], 0, 1)
