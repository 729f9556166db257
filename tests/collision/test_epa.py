"""EPA: depths of cores, its first tetrahedron, and its growing surface, against qhull."""

from math import inf

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from avatarsim.collision.epa import cone_to, epa, find_horizon, grow_tetrahedron, lowest_face, start_polytope
from avatarsim.collision.gjk import WHOLE, add_support, gjk
from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.status import CONVERGED, OUT_OF_ITERATIONS
from tests.collision.solids import NO_SEED, SCRATCH, as_arrays, ball, box, capsule, ellipsoid

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def run(a, b, seed=NO_SEED):
    vertices, shapes = as_arrays(a, b)
    _, _, _, count = gjk(vertices, shapes, 0, 1, NO_SEED, inf, SCRATCH)
    return epa(vertices, shapes, 0, 1, seed, count, SCRATCH)


def test_an_origin_outside_gets_a_negative_depth_that_proves_it():
    status, m, depth, _, _ = run(box(0.5, 0.5, 0.5), box(0.5, 0.5, 0.5).moved(shift=(0.0, 0.0, 1.25)))
    assert (status, depth) == (CONVERGED, -0.25)
    assert m[2] == 1.0


@pytest.mark.parametrize("seed", [NO_SEED, (0.0, 1.0, 0.3), (1.0, 0.0, 0.0), (0.0, 0.0, -2.0)])
def test_flat_differences_have_depth_zero_across_them(seed):
    turn = Rotation.from_rotvec([0.0, 0.0, 0.7])
    for a, b, directions in (
        (capsule(0.1, 1.0), capsule(0.1, 1.0).moved(turn), [(1, 0, 0), (0, 1, 0)]),
        (capsule(0.1, 1.0), capsule(0.1, 1.0), [(1, 0, 0)]),
        (ball(0.1), ball(0.1), []),
    ):
        status, m, depth, _, faces = run(a, b, seed)
        assert (status, depth, faces) == (CONVERGED, 0.0, 0)
        assert np.linalg.norm(m) == pytest.approx(1.0, abs=1e-14)
        for d in directions:
            assert abs(np.dot(m, d)) < 1e-14
        assert np.dot(m, seed) <= 1e-15


def test_concentric_round_ellipsoids_run_out_of_iterations():
    status, m, depth, _, _ = run(ellipsoid(0.5, 0.5, 0.5), ellipsoid(0.3, 0.3, 0.3))
    assert status == OUT_OF_ITERATIONS
    assert depth == pytest.approx(0.8, abs=1e-12)
    assert np.linalg.norm(m) == pytest.approx(1.0, abs=1e-14)


def grown(points):
    """Return the hull of points, grown from the first four, one point at a time."""
    scratch = make_scratch()
    points = np.array(points, float)
    if np.linalg.det(points[1:4] - points[0]) > 0.0:
        points[[1, 2]] = points[[2, 1]]
    scratch.w[: len(points)] = points
    assert start_polytope(scratch)
    faces = 4
    for k in range(4, len(points)):
        above = scratch.normal[:faces] @ points[k] - scratch.height[:faces]
        above[scratch.alive[:faces] != 1] = -1.0
        if above.max() > 1e-12:
            edges, marked = find_horizon(int(above.argmax()), tuple(points[k]), 1e-12, scratch)
            whole, faces = cone_to(k, edges, marked, faces, scratch)
            assert whole
    return scratch, faces


@pytest.mark.parametrize("seed", range(5))
def test_grows_to_the_same_hull_as_qhull(seed):
    points = np.random.default_rng(seed).normal(size=(40, 3))
    scratch, faces = grown(points)
    alive = scratch.alive[:faces] == 1
    ours = np.hstack([scratch.normal[:faces][alive], -scratch.height[:faces][alive, None]])
    theirs = ConvexHull(points).equations
    assert len(ours) == len(theirs)
    np.testing.assert_allclose(
        ours[np.lexsort(ours.T.round(9))], theirs[np.lexsort(theirs.T.round(9))], atol=1e-9
    )


@pytest.mark.parametrize("faces", [0, 1, 3, 4, 5, 8, 9, 30])
def test_the_lowest_face_is_the_first_of_the_lowest(faces):
    rng = np.random.default_rng(faces)
    scratch = make_scratch()
    for k in range(20):
        heights = rng.normal(size=faces) if k % 2 else rng.integers(-2, 3, faces).astype(float)
        heights[rng.random(faces) < 0.2] = np.inf
        scratch.height[:] = -9.0  # beyond: never looked at
        scratch.height[:faces] = heights
        found, height = lowest_face(faces, scratch)
        if not np.isfinite(heights).any():
            assert (found, height) == (-1, np.inf)
        else:
            assert (found, height) == (int(heights.argmin()), heights.min())


def test_points_in_line_make_no_face():
    scratch = make_scratch()
    scratch.w[:4] = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, -1]]
    assert not start_polytope(scratch)


def test_a_horizon_that_does_not_close_is_noticed():
    scratch, faces = grown(np.random.default_rng(8).normal(size=(8, 3)))
    apex = (9.0, 9.0, 9.0)
    scratch.w[8] = apex
    above = scratch.normal[:faces] @ np.array(apex) - scratch.height[:faces]
    edges, marked = find_horizon(int(above.argmax()), apex, 1e-12, scratch)
    assert not cone_to(8, edges - 1, marked, faces, scratch)[0]


TURN = Rotation.from_rotvec([0.3, 1.1, -0.4])


def first_tetrahedron(a, b):
    scratch = make_scratch()
    vertices, shapes = as_arrays(a, b)
    add_support(vertices, shapes, 0, 1, (1.0, 0.0, 0.0), WHOLE, 0, scratch)
    size = max(a.size, b.size)
    return grow_tetrahedron(vertices, shapes, 0, 1, WHOLE, 1, size, scratch), scratch.w


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
    assert first_tetrahedron(a, b)[0] == expected


def test_the_fourth_point_is_below_the_first_three():
    for k in range(20):
        turn = Rotation.from_rotvec([0.3 * k, 1.1, -0.4])
        points, w = first_tetrahedron(box(1.0, 0.5, 0.2).moved(turn), ellipsoid(0.3, 0.2, 0.1))
        assert points == 4
        assert np.linalg.det(w[1:4] - w[0]) < -1e-3
