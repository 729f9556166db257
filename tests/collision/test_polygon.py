"""Hulls and clipping in the plane against scipy and sampling."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from avatarsim.collision.manifold import clip, flat, slope, to_segment, wrap

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def rows(points: np.ndarray, room: int = 40) -> np.ndarray:
    """Points (n, 2) as rows (u, v, 0) with room to grow."""
    out = np.zeros((room, 3))
    out[: len(points), :2] = points
    return out


def area(corners: np.ndarray) -> float:
    """Signed area by the shoelace formula."""
    x, y = corners[:, 0], corners[:, 1]
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def test_wrap_finds_the_corners_that_qhull_finds_counter_clockwise() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        points = rng.normal(size=(12, 2))
        out = np.zeros((40, 3))
        count = wrap(rows(points), len(points), 1e-12, out)
        expected = points[ConvexHull(points).vertices]
        assert {tuple(p) for p in out[:count, :2]} == {tuple(p) for p in expected}
        assert area(out[:count]) == pytest.approx(area(expected))


def test_wrap_leaves_out_points_on_edges_and_copies() -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.25], [0, 0], [0.5, 0.5]], dtype=float)
    out = np.zeros((40, 3))
    assert wrap(rows(square), len(square), 1e-12, out) == 4
    assert area(out[:4]) == pytest.approx(1.0)


def test_clip_has_the_area_that_sampling_finds() -> None:
    rng = np.random.default_rng(2)
    grid = np.stack(np.meshgrid(*[np.linspace(-3, 3, 301)] * 2), axis=-1).reshape(-1, 2)
    for _ in range(10):
        a, b = [p[ConvexHull(p).vertices] for p in (rng.normal(size=(8, 2)), rng.normal(size=(8, 2)))]
        subject = rows(a)
        count = clip(subject, len(a), rows(b), len(b), np.zeros((40, 3)))

        def inside(polygon: np.ndarray) -> np.ndarray:
            edge = np.roll(polygon, -1, axis=0) - polygon
            d = grid[:, None] - polygon
            return np.all(edge[:, 0] * d[..., 1] - edge[:, 1] * d[..., 0] >= 0, axis=1)

        sampled = np.count_nonzero(inside(a) & inside(b)) * 0.02**2
        assert area(subject[:count]) == pytest.approx(sampled, abs=0.05)


def test_clip_of_a_segment_by_another_keeps_the_common_stretch() -> None:
    subject = rows(np.array([[0.0, 0.0], [4.0, 0.0]]))
    assert clip(subject, 2, rows(np.array([[5.0, 0.1], [1.0, 0.1]])), 2, np.zeros((40, 3))) == 2
    assert sorted(subject[:2, 0]) == [1.0, 4.0]


def test_slope_is_the_plane() -> None:
    points = rows(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]))
    points[:4, 2] = 3.0 + 0.5 * points[:4, 0] - 0.25 * points[:4, 1]
    assert slope(points, 4) == pytest.approx((3.0, 0.5, -0.25))
    assert slope(points, 2) == pytest.approx((3.0, 0.5, 0.0))


def test_a_sliver_becomes_a_segment() -> None:
    points = rows(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1e-6], [0.0, 1e-6]]))
    assert flat(points, 4)
    assert to_segment(points, 4) == 2
    assert np.ptp(points[:2, 0]) == 1.0
