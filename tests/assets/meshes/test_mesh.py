"""Sizes, volumes and parts of meshes with known answers."""

import numpy as np
import pytest

from avatarsim.assets.meshes.mesh import areas, signed_volume
from tests.assets.meshes.solids import cube, ell, mesh, together


def test_area_volume_and_size() -> None:
    thing = mesh(ell())
    assert signed_volume(thing.corners) == pytest.approx(5.0)
    assert signed_volume(thing.corners[:, ::-1]) == pytest.approx(-5.0)
    assert areas(thing.corners).sum() == pytest.approx(2 * 5.0 + 12.0)
    assert thing.size == pytest.approx(np.sqrt(19.0))
    assert signed_volume(np.zeros((0, 3, 3))) == 0.0


def test_a_part_keeps_the_order_of_the_file_and_only_the_vertices_it_uses() -> None:
    both = mesh(together(cube(), cube(2.0, 3.0)))
    part = both.part(np.arange(24) >= 12)
    np.testing.assert_array_equal(part.vertices, cube(2.0, 3.0)[0])
    np.testing.assert_array_equal(part.corners, both.corners[12:])
