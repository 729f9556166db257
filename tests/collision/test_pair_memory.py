"""What is kept of a pair comes back as it was, and only a closed surface around the origin comes back at all."""

from math import inf

import numpy as np
import pytest

from avatarsim.collision.epa import SAME_FACE, deepest_points, epa, lowest_face
from avatarsim.collision.gjk import gjk
from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.warm_start import (
    EDGES,
    POINTS_KEPT,
    deepest_kept,
    lowest_kept,
    make_pair_memory,
    recall_axis,
    recall_differences,
    recall_faces,
    recall_points,
    remember_points,
    remember_polytope,
)
from tests.collision.solids import NO_SEED, as_arrays, box, random_hull

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

UP = (0.0, 0.0, 1.0)


def remembered(shift=(0.1, 0.05, 0.2)):
    """A pair, its memory after a query, and the scratch that the query left, with its points and face slots."""
    rng = np.random.default_rng(51)
    vertices, shapes = as_arrays(box(0.1, 0.1, 0.1), random_hull(rng, 20), random_hull(rng, 20).moved(shift=shift))
    scratch, memory = make_scratch(), make_pair_memory(2)
    count = gjk(vertices, shapes, 1, 2, NO_SEED, inf, scratch)[3]
    _, _, _, points, faces = epa(vertices, shapes, 1, 2, NO_SEED, count, scratch)
    remember_polytope(shapes, 1, 2, UP, points, faces, scratch, memory[1])
    return vertices, shapes, scratch, memory, points, faces


def make_again(vertices, shapes, kept):
    """A fresh scratch with the points of A - B that are kept, and nothing else."""
    scratch = make_scratch()
    assert recall_differences(vertices, shapes, 1, 2, kept, scratch) == kept.used[0]
    return scratch


def planes(scratch, faces):
    """Planes of the living faces, sorted."""
    alive = scratch.alive[:faces] == 1
    found = np.hstack([scratch.normal[:faces][alive], scratch.height[:faces][alive, None]])
    return found[np.lexsort(found.T.round(9))]


def test_a_surface_comes_back_with_the_same_faces():
    vertices, shapes, left, memory, _, faces = remembered()
    scratch = make_scratch()
    points = recall_points(vertices, shapes, 1, 2, memory[1], scratch)
    height, m = lowest_kept(points, memory[1], scratch)
    back = recall_faces(points, memory[1], scratch)
    f, lowest = lowest_face(back, scratch)
    assert height == pytest.approx(lowest, abs=1e-15) and height > 0.0
    np.testing.assert_allclose(m, scratch.normal[f], atol=1e-14)
    ours = deepest_kept(vertices, shapes, 1, 2, m, height, SAME_FACE, memory[1], make_again(vertices, shapes, memory[1]))
    np.testing.assert_allclose(ours, deepest_points(m, height, back, 1.0, scratch), atol=1e-14)
    assert back == (left.alive[:faces] == 1).sum()
    np.testing.assert_allclose(planes(scratch, back), planes(left, faces), atol=1e-14)
    assert (points, back) == tuple(memory.used[1])
    assert back == 2 * points - 4
    for f in range(back):
        for e in range(3):
            edge = (scratch.corner[f, e], scratch.corner[f, (e + 1) % 3])
            g = scratch.across[f, e]
            assert edge in [(scratch.corner[g, (i + 1) % 3], scratch.corner[g, i]) for i in range(3)]
    assert not memory.used[0].any()


def test_every_single_wrong_number_in_the_surface_is_noticed():
    vertices, shapes, _, memory, _, _ = remembered()
    scratch = make_scratch()
    points, faces = (int(k) for k in memory.used[1])
    assert recall_points(vertices, shapes, 1, 2, memory[1], scratch) == points
    for field, bound in ((memory.corner, points), (memory.twin, EDGES * faces)):
        for f in range(faces):
            for e in range(3):
                good = int(field[1, f, e])
                for wrong in {(good + 1) % bound, (good + 4) % bound, 2**16 - 1, bound}:
                    field[1, f, e] = wrong
                    assert recall_faces(points, memory[1], scratch) == 0
                    assert lowest_kept(points, memory[1], scratch)[0] == 0.0
                field[1, f, e] = good
    assert recall_faces(points, memory[1], scratch) == faces


def test_a_surface_beside_the_origin_is_refused():
    vertices, shapes, _, memory, _, _ = remembered()
    scratch = make_scratch()
    vertices[shapes.start[1] : shapes.start[2], 0] += 3.0
    points = recall_points(vertices, shapes, 1, 2, memory[1], scratch)
    assert points > 3
    assert lowest_kept(points, memory[1], scratch)[0] == 0.0
    assert recall_faces(points, memory[1], scratch) == 0


def test_a_number_that_is_no_vertex_is_refused():
    vertices, shapes, _, memory, _, _ = remembered()
    for column, many in ((0, shapes.start[2] - shapes.start[1]), (1, shapes.start[3] - shapes.start[2])):
        good = int(memory.rows[1, 1, column])
        for wrong in (2**32 - 1, many, 10**6):
            memory.rows[1, 1, column] = wrong
            assert recall_points(vertices, shapes, 1, 2, memory[1], make_scratch()) == 0
            assert recall_differences(vertices, shapes, 1, 2, memory[1], make_scratch()) == 0
        memory.rows[1, 1, column] = good
    for count in (0, -1, POINTS_KEPT + 1):
        memory.used[1, 0] = count
        assert recall_points(vertices, shapes, 1, 2, memory[1], make_scratch()) == 0
        assert recall_differences(vertices, shapes, 1, 2, memory[1], make_scratch()) == 0


def test_a_simplex_comes_back_and_so_does_the_axis():
    vertices, shapes, left, memory, _, _ = remembered(shift=(2.0, 0.3, 0.1))
    count = gjk(vertices, shapes, 1, 2, NO_SEED, inf, left)[3]
    remember_points(shapes, 1, 2, UP, count, left, memory[0])
    scratch = make_scratch()
    assert recall_points(vertices, shapes, 1, 2, memory[0], scratch) == count
    np.testing.assert_array_equal(scratch.w[:count], left.w[:count])
    np.testing.assert_array_equal(scratch.rows[:count], left.rows[:count])
    assert recall_axis(memory[0]) == UP


@pytest.mark.parametrize("bad", [np.nan, np.inf, 0.0, 3.0])
def test_an_axis_that_is_no_unit_vector_is_refused(bad):
    memory = make_pair_memory(1)
    memory.axis[0] = (bad, 0.0, 0.0)
    assert recall_axis(memory[0]) == NO_SEED


def test_a_surface_with_too_many_corners_is_forgotten():
    vertices, shapes, scratch, memory, _, faces = remembered()
    many = POINTS_KEPT + 1
    scratch.corner[:many, 0] = np.arange(many)
    scratch.corner[:many, 1:] = 0
    scratch.alive[:many] = 1
    remember_polytope(shapes, 1, 2, UP, many, many, scratch, memory[1])
    assert not memory.used[1].any()
