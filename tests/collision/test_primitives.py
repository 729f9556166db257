"""Distances and depths by formula against GJK and EPA; and the pairs that the formulas leave to those."""

from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.collision.epa import epa
from avatarsim.collision.gjk import gjk
from avatarsim.collision.primitives import (
    BOX_AND_POINT,
    POINT_AND_BOX,
    TWO_POINTS,
    TWO_SEGMENTS,
    UNKNOWN,
    are_boxes,
    between_points,
    between_segments,
    box_depth,
    form,
    point_and_box,
)
from avatarsim.collision.signed_distance import core_distance
from avatarsim.collision.status import CONVERGED
from avatarsim.collision.support import gap_along
from tests.collision.solids import NO_SEED, SCRATCH, Solid, as_arrays, ball, box, capsule, ellipsoid, random_hull

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

coordinate = st.one_of(st.integers(-2, 2).map(float), st.floats(-1.5, 1.5, allow_subnormal=False))
point = st.tuples(coordinate, coordinate, coordinate)


def closed_form(vertices, shapes, a, b):
    """Return the answer of the formula for this pair, as the queries compute it."""
    kind = form(shapes, a, b)
    if kind == BOX_AND_POINT:
        known, distance, n, on_b, on_a = point_and_box(vertices, shapes, b, a)
        return known, distance, tuple(-x for x in n), on_a, on_b
    formulas = {TWO_POINTS: between_points, TWO_SEGMENTS: between_segments, POINT_AND_BOX: point_and_box}
    return formulas[kind](vertices, shapes, a, b) if kind in formulas else UNKNOWN


def segment(p, q, radius=0.0):
    """Return a capsule between two points."""
    return Solid(np.array([p, q]), radius)


def check_against_generic(a, b):
    """Distance, proof and points; returns whether a formula answered."""
    vertices, shapes = as_arrays(a, b)
    known, distance, n, on_a, on_b = closed_form(vertices, shapes, 0, 1)
    if not known:
        return False
    status, generic, _, _, _, _, _ = core_distance(vertices, shapes, 0, 1, NO_SEED, inf, SCRATCH)
    size = max(a.size, b.size)
    assert status == CONVERGED
    assert distance == pytest.approx(generic, abs=1e-12 * size)
    assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-13)
    assert gap_along(vertices, shapes, 0, 1, n) + a.radius + b.radius == pytest.approx(distance, abs=1e-10 * size)
    np.testing.assert_allclose(np.subtract(on_a, on_b), distance * np.array(n), atol=1e-12 * size)
    return True


@given(point, point, point, point)
@settings(deadline=None, max_examples=100)
def test_segments_and_points_in_any_position(p, q, r, s):
    a, b = segment(p, q, 0.1), segment(r, s, 0.2)
    check_against_generic(a, b)
    check_against_generic(a, Solid(np.array([r]), 0.1))
    check_against_generic(Solid(np.array([p]), 0.1), b)


@pytest.mark.parametrize("angle", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1.0])
@pytest.mark.parametrize("gap", [1e-9, 1e-6, 1e-3, 1.0])
def test_segments_nearly_parallel_and_nearly_touching(angle, gap):
    a, answered = capsule(0.1, 1.0), 0
    for start in (-2.5, -1.0, 0.0, 0.4):
        b = capsule(0.1, 0.7).moved(Rotation.from_rotvec([0.0, 0.0, angle]), (start, 0.0, gap))
        answered += check_against_generic(a, b)
        answered += check_against_generic(b, a)
    assert answered >= 4


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_a_point_and_a_box_outside_and_inside(scale):
    rng = np.random.default_rng(41)
    for _ in range(40):
        turn = Rotation.from_quat(rng.normal(size=4))
        b = box(*rng.choice([0.001, 0.1, 0.5, 1.0], 3)).moved(turn, rng.normal(size=3) * scale, scale)
        inside = rng.normal(size=3) * 0.3
        a = ball(0.2).moved(shift=b.rows.mean(axis=0) + inside * scale, scale=scale)
        assert check_against_generic(a, b)
        assert check_against_generic(b, a)


def test_answers_a_sheared_box_inside_only_and_rightly():
    b = Solid(box(0.5, 0.4, 0.3).rows @ np.array([[1.0, 0.0, 0.0], [0.3, 1.0, 0.1], [0.0, 0.0, 1.0]]))
    rng = np.random.default_rng(42)
    for mirrored in (b, Solid(b.rows * (1.0, -1.0, 1.0))):
        known = [check_against_generic(ball(0.1).moved(shift=rng.uniform(-0.6, 0.6, 3)), mirrored) for _ in range(60)]
        assert 5 < sum(known) < 55


def inside(point, solid, slack):
    """Return whether a point is in a box given by its corners, but for some slack [m]."""
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


BENT = box(0.5, 0.4, 0.3)
BENT.rows[6] += (1e-9, 0.0, 0.0)


@pytest.mark.parametrize(("a", "b"), [
    (ball(0.1), ball(0.2)),
    (capsule(0.1, 1.0), capsule(0.2, 1.0).moved(Rotation.from_rotvec([0.3, 0.2, 0.1]))),
    (ball(0.1).moved(shift=(0.5, 0.0, 0.0)), box(0.5, 0.5, 0.5)),
    (ball(0.1), BENT),
    (ball(0.1), box(0.5, 0.5, 0.0)),
    (ball(0.1), random_hull(np.random.default_rng(1), 20)),
    (capsule(0.1, 1.0), box(0.5, 0.4, 0.3)),
    (ball(0.1), ellipsoid(0.5, 0.4, 0.3)),
    (ball(0.1).moved(shift=(np.nan, 0.0, 0.0)), ball(0.1)),
    (ball(0.1).moved(shift=(0.0, np.nan, 0.0)), box(0.5, 0.4, 0.3)),
    (box(0.5, 0.4, 0.3), BENT),
    (box(0.5, 0.4, 0.3), box(0.5, 0.4, 0.0)),
    (box(0.5, 0.4, 0.3), box(0.5, 0.4, 0.3).moved(shift=(3.0, 0.0, 0.0))),
    (box(0.5, 0.4, 0.3), box(0.5, 0.4, 0.3).moved(shift=(1.0, 0.0, 0.0))),
    (box(0.5, 0.4, 0.3), box(0.5, 0.4, 0.3).moved(shift=(np.nan, 0.0, 0.0))),
])
def test_pairs_that_are_left_to_the_algorithms(a, b):
    for one, two in ((a, b), (b, a)):
        vertices, shapes = as_arrays(one, two)
        assert not (box_depth if are_boxes(shapes, 0, 1) else closed_form)(vertices, shapes, 0, 1)[0]
    assert not are_boxes(as_arrays(box(0.5, 0.4, 0.3), random_hull(np.random.default_rng(1), 20))[1], 0, 1)
