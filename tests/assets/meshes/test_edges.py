"""Edges: borders, neighbours that face apart, connected parts, bands with one side."""

import numpy as np

from avatarsim.assets.meshes.repairs import edges_of, parts, to_flip
from tests.assets.meshes.solids import cube, ell, together


def test_a_closed_surface_has_no_border_and_is_balanced() -> None:
    edges = edges_of(ell()[1])
    assert edges.open == 0 and edges.unbalanced == 0
    assert not edges.alike.any() and len(edges.pairs) == len(edges.counts)


def test_a_missing_triangle_leaves_three_border_edges() -> None:
    assert edges_of(ell()[1][1:]).open == 3


def test_parts_are_counted() -> None:
    triangles = together(cube(), cube(2.0, 3.0), ell())[1]
    part = parts(len(triangles), edges_of(triangles))
    assert len(set(part.tolist())) == 3
    assert len(set(part[:12].tolist())) == 1 and len(set(part[12:24].tolist())) == 1


def test_triangles_turned_over_are_found() -> None:
    triangles = together(cube(), ell())[1].copy()
    turned = np.isin(np.arange(len(triangles)), [3, 4, 9, 20])
    triangles[turned] = triangles[turned][:, ::-1]
    assert edges_of(triangles).unbalanced > 0
    flips = to_flip(len(triangles), edges_of(triangles))
    assert flips is not None
    # in each part either these or all the others
    for part in (slice(0, 12), slice(12, None)):
        assert (flips[part] == turned[part]).all() or (flips[part] != turned[part]).all()


def test_a_moebius_band_has_one_side() -> None:
    n = 7
    band = [t for i in range(n) for t in ((2 * i, 2 * i + 2, 2 * i + 1), (2 * i + 1, 2 * i + 2, 2 * i + 3))]
    # the last two columns are the first two, upside down
    triangles = np.array([[{2 * n: 1, 2 * n + 1: 0}.get(v, v) for v in t] for t in band])
    assert to_flip(len(triangles), edges_of(triangles)) is None
