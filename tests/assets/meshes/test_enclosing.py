"""Hulls of few vertices contain all of a hull, and add no more than is reported."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.assets.meshes.enclosing import enclosing
from avatarsim.assets.meshes.hulls import Hull, hull_of


def cloud(seed: int, count: int) -> Hull:
    """Return the hull of points on an ellipsoid with noise."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 3))
    points *= rng.uniform(0.8, 1.0, (count, 1)) / np.linalg.norm(points, axis=1, keepdims=True)
    return hull_of(points * rng.uniform(0.02, 1.0, 3), "cloud")


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000), count=st.integers(20, 400), most=st.integers(8, 128))
def test_few_vertices_hold_all_of_the_hull(seed: int, count: int, most: int) -> None:
    hull = cloud(seed, count)
    around, added = enclosing(hull, most, "cloud")
    assert len(around.used) <= max(most, 8)
    assert around.heights(hull.points).max() <= 1e-14
    # no sample of the new hull is farther away than is reported: distance from a convex set is largest at a vertex
    samples = np.random.default_rng(seed).dirichlet(np.full(len(around.used), 0.1), 200) @ around.points[around.used]
    assert hull.distances(samples).max() <= added + 1e-12


@pytest.mark.parametrize("fit", [0.03, 0.01, 1e-9])
def test_fit_takes_as_many_vertices_as_it_needs(fit: float) -> None:
    hull = cloud(3, 500)
    around, added = enclosing(hull, 16, "cloud", fit)
    assert added <= fit and around.heights(hull.points).max() <= 1e-14
    assert len(around.used) > 16


def test_fit_is_found_on_a_hull_of_many_vertices() -> None:
    hull = cloud(5, 20_000)
    around, added = enclosing(hull, 128, "cloud", 0.02)
    assert 0.0 < added <= 0.02 and len(around.used) < 0.5 * len(hull.used)
    assert around.heights(hull.points).max() <= 1e-14


@pytest.mark.parametrize("thickness", [1e-3, 1e-5, 1e-7])
def test_a_thin_hull_is_widened_no_more_than_a_thicker_one(thickness: float) -> None:
    rng = np.random.default_rng(4)
    ball = rng.normal(size=(2000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    added = [enclosing(hull_of(ball * (0.3, 0.2, share), "plate"), 128, "plate")[1] for share in (3e-3, 0.3 * thickness)]
    assert added[1] < 1.5 * added[0]
