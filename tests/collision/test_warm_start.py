"""Queries with a memory are equal to cold ones, whatever the memory holds; kept points and surfaces come back."""

from math import inf, nan

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.status import CONVERGED, NOT_FINITE
from avatarsim.collision.support import gap_along
from avatarsim.collision.warm_query import signed_distance_coherent
from avatarsim.collision.warm_start import (
    PAIR,
    make_pair_memory,
)
from tests.collision.solids import NO_SEED, SCRATCH, as_arrays, ball, box, capsule, ellipsoid, hull_of_ellipsoid, random_hull

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

SAME = 1e-12
"""Relative to the shapes' size: warm and cold answers differ by no more."""


def coherent(a, b, memory, pair=0, margin=inf):
    """The query of two solids with the memory of one pair."""
    vertices, shapes = as_arrays(a, b)
    return signed_distance_coherent(vertices, shapes, 0, 1, margin, SCRATCH, memory, pair)


def check_equals_cold(a, b, memory, pair=0):
    """Gap equal to the cold one, proved along the normal, witness points that make it; returns the gap."""
    vertices, shapes = as_arrays(a, b)
    status, gap, n, on_a, on_b = coherent(a, b, memory, pair)
    cold = signed_distance(vertices, shapes, 0, 1, NO_SEED, SCRATCH)
    size = max(a.size, b.size)
    smooth = a.kind + b.kind > 0
    assert status == cold[0] == CONVERGED
    assert gap == pytest.approx(cold[1], abs=(2e-9 if smooth else SAME) * size)
    assert gap_along(vertices, shapes, 0, 1, n) == pytest.approx(gap, abs=(2e-9 if smooth else SAME) * size)
    np.testing.assert_allclose(np.subtract(on_a, on_b), gap * np.array(n), atol=(2e-9 if smooth else 1e-11) * size)
    return gap


def some_pair(kind, rng):
    """Two solids of one kind of pair."""
    return {
        "hulls": lambda: (random_hull(rng, 20), hull_of_ellipsoid((0.5, 0.3, 0.4), 6, 3)),
        "boxes": lambda: (box(0.5, 0.3, 0.2), box(0.2, 0.6, 0.4)),
        "capsule and hull": lambda: (capsule(0.1, 0.5), random_hull(rng, 12)),
        "ball and box": lambda: (ball(0.3), box(0.4, 0.3, 0.2)),
        "ellipsoid and box": lambda: (ellipsoid(0.3, 0.4, 0.5), box(0.4, 0.3, 0.2)),
    }[kind]()


@pytest.mark.parametrize("kind", ["hulls", "boxes", "capsule and hull", "ball and box", "ellipsoid and box"])
def test_equals_the_cold_query_along_motions_with_jumps(kind):
    rng = np.random.default_rng(31)
    memory, signs = make_pair_memory(2), set()
    for _ in range(3):
        a, b = some_pair(kind, rng)
        spin, start, way = rng.normal(size=3), rng.normal(size=3) * 0.3, rng.normal(size=3)
        for t in np.linspace(0.0, 1.0, 12):
            jump = rng.normal(size=3) * (rng.random() < 0.15)
            there = b.moved(Rotation.from_rotvec(spin * 0.2 * t), start + way * 0.7 * t + jump)
            signs.add(check_equals_cold(a, there, memory, 1) > 0.0)
    assert signs == {True, False}
    assert not memory.used[0].any()


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


def test_the_memory_of_another_pair_or_of_a_damaged_surface_costs_time_only():
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
        assert second[1] == pytest.approx(first[1], abs=1e-15)
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
def test_a_pose_that_is_not_finite_is_a_status_and_the_memory_recovers(bad):
    a, b = some_pair("hulls", np.random.default_rng(35))
    for shift in ((0.1, 0.0, 0.0), (2.0, 0.0, 0.0)):
        memory = make_pair_memory(1)
        check_equals_cold(a, b.moved(shift=shift), memory)
        with np.errstate(invalid="ignore"):
            assert coherent(a, b.moved(shift=(bad, 0.0, 0.0)), memory)[0] == NOT_FINITE
        check_equals_cold(a, b.moved(shift=shift), memory)
