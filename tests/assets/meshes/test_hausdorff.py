"""Bound of the Hausdorff distance compared with a simple twin: dense samples, brute-force distances."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.assets.meshes import hausdorff
from avatarsim.assets.meshes.hausdorff import RESOLUTION, Deviation, deviation
from avatarsim.assets.meshes.hulls import Hull, hull_of
from avatarsim.assets.meshes.mesh_queries import inside_closed, point_triangle
from tests.assets.meshes.solids import Soup, cube, ell, prism, surface_points, together, torus


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Hull:
    corners = cube()[0]
    return hull_of(np.array(low) + corners * (np.array(high) - np.array(low)), "box")


ELL_BOXES = [box((0, 0, 0), (3, 1, 1)), box((0, 0, 0), (1, 3, 1))]


def bounds(hulls: list[Hull], soup: Soup) -> Deviation:
    return deviation(hulls, soup[0][soup[1]], closed=True)


def sampled(hulls: list[Hull], soup: Soup, count: int = 3000) -> tuple[float, float]:
    """Return the largest sampled distances: of the surface from the hulls, and of the hulls' insides from the mesh."""
    corners = soup[0][soup[1]]
    on_mesh = surface_points(soup, count)
    out = np.min([hull.distances(on_mesh) for hull in hulls], axis=0).max()
    rng = np.random.default_rng(1)
    own = [hull.points[hull.used] for hull in hulls]
    within = np.concatenate([rng.dirichlet(np.full(len(points), 0.2), count // len(own)) @ points for points in own])
    free = within[~inside_closed(within, corners)]
    over = max((float(point_triangle(np.tile(p, (len(corners), 1)), corners).min()) for p in free), default=0.0)
    return float(out), over


def test_a_missing_arm_is_uncovered() -> None:
    found = bounds(ELL_BOXES[:1], ell())
    # the far end of the lost arm is 2 above the remaining box
    assert found.uncovered == pytest.approx(2.0, rel=0.05)
    assert found.uncovered >= 2.0 - 1e-12 and found.reached == pytest.approx(2.0, abs=1e-9)


def test_the_hull_of_an_ell_sticks_out_by_its_notchs_circle() -> None:
    found = bounds([hull_of(ell()[0], "ell")], ell())
    # the point of the hull's slope x + y = 4 that is equally far from both arms: (2, 2), one from each
    assert found.uncovered == 0.0
    assert 1.0 <= found.added <= 1.06


def test_a_hollow_that_a_hull_fills_counts() -> None:
    vertices, triangles = together(cube(0.0, 4.0), cube(1.0, 3.0))
    hollow = np.concatenate([triangles[:12], triangles[12:, ::-1]])
    found = bounds([hull_of(vertices, "hollow")], (vertices, hollow))
    # its middle is 1 from the walls, though all of the hull's surface lies on the mesh
    assert 1.0 <= found.added <= 1.06


def test_a_filled_bottle_counts_its_belly_and_not_its_mouth() -> None:
    right = [(4.0, 0.0), (4.0, 4.0), (2.2, 4.0), (2.2, 3.6), (3.6, 3.6), (3.6, 0.4)]
    outline = np.array([(0.0, 0.0), *right, *[(4.0 - x, y) for x, y in right[:1:-1]], (0.0, 4.0)])
    caps = ((0, 1, 6), (0, 6, 7), (1, 2, 5), (1, 5, 6), (2, 3, 4), (2, 4, 5), (0, 7, 8), (0, 8, 11), (8, 9, 11), (9, 10, 11))
    soup = prism(outline, caps, 4.0)
    found = bounds([hull_of(soup[0], "bottle")], soup)
    out, over = sampled([hull_of(soup[0], "bottle")], soup)
    assert found.added >= max(over, 1.59) and found.added < 1.75


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 10_000))
def test_no_sample_exceeds_the_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    soup = torus(1.0, float(rng.uniform(0.1, 0.4)), int(rng.integers(6, 14)), int(rng.integers(4, 8)))
    # hulls of random sectors: they cover some of it, stick out, and overlap
    angle = np.arctan2(soup[0][:, 1], soup[0][:, 0])
    hulls = []
    for _ in range(int(rng.integers(1, 4))):
        turn = (angle - rng.uniform(-np.pi, np.pi)) % (2 * np.pi)
        chosen = soup[0][np.argsort(turn)[: int(rng.integers(12, len(angle)))]]
        hulls.append(hull_of(chosen * rng.uniform(0.8, 1.2), "sector"))
    found, (out, over) = bounds(hulls, soup), sampled(hulls, soup, 600)
    assert out <= found.uncovered + 1e-12 and over <= found.added + 1e-12
    size = float(np.linalg.norm(np.ptp(soup[0], axis=0)))
    assert found.hausdorff - found.reached <= 2.0 * RESOLUTION * size + 0.06 * found.hausdorff


def test_the_bound_of_an_early_stop_is_looser_and_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    hulls, soup = [hull_of(torus()[0], "torus")], torus()
    sharp = bounds(hulls, soup)
    monkeypatch.setattr(hausdorff, "MOST_BOXES", 3)
    monkeypatch.setattr(hausdorff, "MOST_TRIANGLES", 3)
    loose = bounds(hulls, soup)
    assert loose.added > sharp.added >= 0.7
    shrunk = [hull_of(0.9 * torus()[0], "torus")]
    assert bounds(shrunk, soup).uncovered >= sampled(shrunk, soup)[0]
