"""Triangles through one another: known cases, and any two against a system of equations per edge."""

import numpy as np
import pytest

from avatarsim.assets.meshes import repairs as crossings
from avatarsim.assets.meshes.repairs import crossing_pairs
from tests.assets.meshes.solids import cube, ell, together, torus


def crossing(*triangles: list[tuple[float, float, float]]) -> int:
    vertices = np.array(triangles, dtype=float).reshape(-1, 3)
    return len(crossing_pairs(vertices, np.arange(len(vertices)).reshape(-1, 3)))


FLAT = [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)]


def test_through_beside_touching_and_in_one_plane() -> None:
    assert crossing(FLAT, [(1.0, 1.0, -1.0), (1.0, 1.2, 1.0), (1.3, 1.0, 1.0)]) == 1
    assert crossing(FLAT, [(3.0, 3.0, -1.0), (3.0, 3.2, 1.0), (3.3, 3.0, 1.0)]) == 0
    assert crossing(FLAT, [(1.0, 1.0, 0.0), (1.0, 1.2, 1.0), (1.3, 1.0, 1.0)]) == 0
    assert crossing(FLAT, [(1.0, 1.0, 0.0), (1.0, 1.2, 0.0), (1.3, 1.0, 0.0)]) == 0


@pytest.mark.parametrize("soup", [cube(), ell(), torus(), together(cube(), cube(1.0, 2.0))])
def test_sound_surfaces_do_not_cross_themselves(soup: tuple[np.ndarray, np.ndarray]) -> None:
    assert len(crossing_pairs(*soup)) == 0


def test_two_cubes_through_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    # turned a little, so that no edge lies in a face of the other
    vertices, triangles = cube()
    turn = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    both = together((vertices, triangles), (vertices @ turn.T + [0.3, 0.2, 0.4], triangles))
    pairs = crossing_pairs(*both)
    assert len(pairs) > 0
    assert (np.sort(pairs, axis=1) // 12 == [0, 1]).all()
    # in small portions the answer is the same
    monkeypatch.setattr(crossings, "PAIRS_AT_ONCE", 10)
    assert {tuple(sorted(p)) for p in crossing_pairs(*both).tolist()} == {tuple(sorted(p)) for p in pairs.tolist()}


def test_random_triangles_against_a_system_of_equations_per_edge() -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        one, other = rng.normal(size=(2, 3, 3))
        got = crossing(one.tolist(), other.tolist()) == 1
        assert got == (solved(one, other) or solved(other, one))


def solved(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether a point on an edge of `one`, where the edge passes the plane of `other`, is in `other`, by barycentrics."""
    for k in range(3):
        p, q = one[k], one[(k + 1) % 3]
        columns = np.stack([other[1] - other[0], other[2] - other[0], p - q], axis=1)
        u, v, share = np.linalg.solve(columns, p - other[0])
        if u > 0 and v > 0 and u + v < 1 and 0 < share < 1:
            return True
    return False
