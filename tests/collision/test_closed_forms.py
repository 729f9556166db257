"""Distances by formula against GJK and EPA, which know nothing of them; and what the formulas leave to those."""

from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.collision.primitives import (
    BOX_AND_POINT,
    POINT_AND_BOX,
    TWO_POINTS,
    TWO_SEGMENTS,
    UNKNOWN,
    between_points,
    between_segments,
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
    """What the queries do: the answer of the formula that there is for this pair."""
    kind = form(shapes, a, b)
    if kind == BOX_AND_POINT:
        known, distance, n, on_b, on_a = point_and_box(vertices, shapes, b, a)
        return known, distance, tuple(-x for x in n), on_a, on_b
    formulas = {TWO_POINTS: between_points, TWO_SEGMENTS: between_segments, POINT_AND_BOX: point_and_box}
    return formulas[kind](vertices, shapes, a, b) if kind in formulas else UNKNOWN


def segment(p, q, radius=0.0):
    """A capsule between two points."""
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
@settings(deadline=None, max_examples=200)
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


def test_a_sheared_box_is_answered_inside_only_and_everywhere_rightly():
    b = Solid(box(0.5, 0.4, 0.3).rows @ np.array([[1.0, 0.0, 0.0], [0.3, 1.0, 0.1], [0.0, 0.0, 1.0]]))
    rng = np.random.default_rng(42)
    for mirrored in (b, Solid(b.rows * (1.0, -1.0, 1.0))):
        known = [check_against_generic(ball(0.1).moved(shift=rng.uniform(-0.6, 0.6, 3)), mirrored) for _ in range(60)]
        assert 5 < sum(known) < 55


def test_what_is_left_to_the_algorithms():
    moved = Rotation.from_rotvec([0.3, 0.2, 0.1])
    bent = box(0.5, 0.4, 0.3)
    bent.rows[6] += (1e-9, 0.0, 0.0)
    for a, b in (
        (ball(0.1), ball(0.2)),
        (capsule(0.1, 1.0), capsule(0.2, 1.0).moved(moved)),
        (ball(0.1).moved(shift=(0.5, 0.0, 0.0)), box(0.5, 0.5, 0.5)),
        (ball(0.1), bent),
        (ball(0.1), box(0.5, 0.5, 0.0)),
        (ball(0.1), random_hull(np.random.default_rng(1), 20)),
        (capsule(0.1, 1.0), box(0.5, 0.4, 0.3)),
        (ball(0.1), ellipsoid(0.5, 0.4, 0.3)),
        (ball(0.1).moved(shift=(np.nan, 0.0, 0.0)), ball(0.1)),
        (ball(0.1).moved(shift=(0.0, np.nan, 0.0)), box(0.5, 0.4, 0.3)),
    ):
        vertices, shapes = as_arrays(a, b)
        assert not closed_form(vertices, shapes, 0, 1)[0]
        assert not closed_form(vertices, shapes, 1, 0)[0]
