"""The growing surface stays closed, convex and oriented; a torn one is noticed."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from avatarsim.collision.epa import cone_to, find_horizon, lowest_face, start_polytope
from avatarsim.collision.scratch import make_scratch

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def grown(points):
    """The hull of points, grown from the first four, one point at a time."""
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


def test_every_edge_is_shared_by_the_face_said_to_be_across_it():
    scratch, faces = grown(np.random.default_rng(7).normal(size=(30, 3)))
    for f in np.flatnonzero(scratch.alive[:faces] == 1):
        for e in range(3):
            other = scratch.across[f, e]
            assert scratch.alive[other] == 1
            edge = (scratch.corner[f, e], scratch.corner[f, (e + 1) % 3])
            back = [(scratch.corner[other, (i + 1) % 3], scratch.corner[other, i]) for i in range(3)]
            assert edge in back


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
