"""Queries with a memory are equal to cold ones, whatever the memory holds; kept points and surfaces come back."""

from math import inf, nan

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.epa import SAME_FACE, deepest_points, epa, lowest_face
from avatarsim.collision.gjk import gjk
from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.status import CONVERGED, NOT_FINITE
from avatarsim.collision.support import gap_along
from avatarsim.collision.warm_query import signed_distance_coherent
from avatarsim.collision.warm_start import (
    EDGES,
    PAIR,
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
from tests.collision.solids import NO_SEED, SCRATCH, as_arrays, box, capsule, hull_of_ellipsoid, random_hull

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

SAME = 1e-12
"""Relative to the shapes' size: warm and cold answers differ by no more."""


def coherent(a, b, memory, margin=inf):
    """Return the query of two solids with a memory of one pair."""
    vertices, shapes = as_arrays(a, b)
    return signed_distance_coherent(vertices, shapes, 0, 1, margin, SCRATCH, memory, 0)


def check_equals_cold(a, b, memory):
    """Gap equal to the cold one, proved along the normal, witness points that make it."""
    vertices, shapes = as_arrays(a, b)
    status, gap, n, on_a, on_b = coherent(a, b, memory)
    cold = signed_distance(vertices, shapes, 0, 1, NO_SEED, SCRATCH)
    size = max(a.size, b.size)
    assert status == cold[0] == CONVERGED
    assert gap == pytest.approx(cold[1], abs=SAME * size)
    assert gap_along(vertices, shapes, 0, 1, n) == pytest.approx(gap, abs=SAME * size)
    np.testing.assert_allclose(np.subtract(on_a, on_b), gap * np.array(n), atol=1e-11 * size)


def some_pair(kind, rng):
    """Return two solids of one kind of pair."""
    return {
        "hulls": lambda: (random_hull(rng, 20), hull_of_ellipsoid((0.5, 0.3, 0.4), 6, 3)),
        "boxes": lambda: (box(0.5, 0.3, 0.2), box(0.2, 0.6, 0.4)),
        "capsule and hull": lambda: (capsule(0.1, 0.5), random_hull(rng, 12)),
    }[kind]()


def test_garbage_in_the_memory_costs_time_only():
    rng = np.random.default_rng(33)
    for trial in range(60):
        kind = ["hulls", "boxes", "capsule and hull"][trial % 3]
        a, b = some_pair(kind, rng)
        b = b.moved(Rotation.from_quat(rng.normal(size=4)), rng.normal(size=3) * 0.4)
        memory = make_pair_memory(1)
        memory.axis[:] = rng.choice([nan, inf, 0.0, 1e-200, 1e200, -1.0], 3)
        memory.used[0] = rng.integers(-3, 150, 2) if trial % 2 else (rng.integers(1, 6), rng.integers(0, 6))
        memory.rows[:] = rng.integers(-5, 40 if trial % 4 < 2 else 8, memory.rows.shape)
        memory.corner[:] = rng.integers(-5, 70 if trial % 4 < 2 else 4, memory.corner.shape)
        memory.twin[:] = rng.integers(-5, 400 if trial % 4 < 2 else 12, memory.twin.shape)
        with np.errstate(over="ignore", invalid="ignore"):
            for _ in range(2):
                check_equals_cold(a, b, memory)


def test_a_foreign_or_damaged_memory_costs_time_only():
    rng = np.random.default_rng(34)
    for _ in range(40):
        a, b = some_pair("hulls", rng)
        memory = make_pair_memory(1)
        check_equals_cold(a, b.moved(shift=rng.normal(size=3) * 0.1), memory)
        assert memory.used[0, 1] >= 4
        for damaged, bound in ((memory.rows, 8), (memory.corner, memory.used[0, 0]), (memory.twin, 3 * memory.used[0, 1])):
            if rng.random() < 0.5:
                at = tuple(rng.integers(0, [1, min(6, damaged.shape[1]), damaged.shape[2]]))
                damaged[at] = rng.integers(0, bound)
        check_equals_cold(a, b.moved(Rotation.from_rotvec(rng.normal(size=3) * 0.3), rng.normal(size=3) * 0.2), memory)


def test_a_surface_that_does_not_hold_the_origin_is_not_believed():
    """The tetrahedron of one pose, far from the origin in the other, with all else in order."""
    a, b = box(0.5, 0.5, 0.5), box(0.5, 0.5, 0.5)
    memory = make_pair_memory(1)
    check_equals_cold(a, b.moved(shift=(0.1, 0.2, 0.3)), memory)
    for shift in ((0.9, 0.1, 0.3), (-0.9, 0.0, 0.0), (1.5, 0.0, 0.0), (0.1, 0.2, -0.3)):
        check_equals_cold(a, b.moved(shift=shift), memory)


def test_a_standing_pair_is_answered_from_the_memory_alone():
    a, b = hull_of_ellipsoid((0.5, 0.3, 0.4), 6, 3), hull_of_ellipsoid((0.4, 0.3, 0.5), 6, 3)
    for shift in ((0.1, 0.1, 0.0), (2.0, 0.3, 0.1)):
        memory, there = make_pair_memory(1), b.moved(shift=shift)
        first = coherent(a, there, memory)
        kept = memory.copy()
        second = coherent(a, there, memory)
        assert PAIR.names and second[1] == pytest.approx(first[1], abs=1e-15)
        for name in PAIR.names:
            np.testing.assert_allclose(memory[name], kept[name], atol=1e-15)


def test_a_margin_stops_early_with_a_proof():
    a, b = box(0.5, 0.5, 0.5), box(0.5, 0.5, 0.5).moved(shift=(3.0, 4.0, 1.0))
    vertices, shapes = as_arrays(a, b)
    memory, exact = make_pair_memory(1), np.sqrt(2.0**2 + 3.0**2)
    for margin in (0.0, 1.0, inf, 1.0, 0.0, exact + 0.1):
        status, gap, n, _, _ = coherent(a, b, memory, margin=margin)
        assert status == CONVERGED
        assert min(margin, exact) <= gap <= exact + 1e-12
        assert gap_along(vertices, shapes, 0, 1, n) == pytest.approx(gap, abs=1e-12)


@pytest.mark.parametrize("bad", [nan, inf])
def test_a_memory_recovers_from_a_pose_that_is_not_finite(bad):
    a, b = some_pair("hulls", np.random.default_rng(35))
    for shift in ((0.1, 0.0, 0.0), (2.0, 0.0, 0.0)):
        memory = make_pair_memory(1)
        check_equals_cold(a, b.moved(shift=shift), memory)
        with np.errstate(invalid="ignore"):
            assert coherent(a, b.moved(shift=(bad, 0.0, 0.0)), memory)[0] == NOT_FINITE
        check_equals_cold(a, b.moved(shift=shift), memory)


UP = (0.0, 0.0, 1.0)


def remembered(shift=(0.1, 0.05, 0.2)):
    """Return a pair, its memory after a query, and the scratch that the query left, with its points and face slots."""
    rng = np.random.default_rng(51)
    vertices, shapes = as_arrays(box(0.1, 0.1, 0.1), random_hull(rng, 20), random_hull(rng, 20).moved(shift=shift))
    scratch, memory = make_scratch(), make_pair_memory(2)
    count = gjk(vertices, shapes, 1, 2, NO_SEED, inf, scratch)[3]
    _, _, _, points, faces = epa(vertices, shapes, 1, 2, NO_SEED, count, scratch)
    remember_polytope(shapes, 1, 2, UP, points, faces, scratch, memory[1])
    return vertices, shapes, scratch, memory, points, faces


def make_again(vertices, shapes, kept):
    """Return a fresh scratch with the points of A - B that are kept, and nothing else."""
    scratch = make_scratch()
    assert recall_differences(vertices, shapes, 1, 2, kept, scratch) == kept.used[0]
    return scratch


def planes(scratch, faces):
    """Return planes of the living faces, sorted."""
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
