"""Triangles close round the volume that the shape has, and face outwards."""

import math

import numpy as np
import pytest

from reports.drawing import mesh


def volume(found: mesh.Mesh) -> float:
    """Signed volume [m^3] that triangles enclose: positive when they face outwards."""
    a, b, c = (found[0][found[1][:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


PLACE = {"position": [0.3, -0.2, 0.1], "orientation": [math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0]}
CUBE = [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 2.0)]
EXPECTED = (
    ({"kind": "box", "size": [1.0, 2.0, 3.0]}, 6.0, 1e-12),
    ({"kind": "hull", "vertices": [*CUBE, [0.5, 0.5, 0.5]]}, 2.0, 1e-12),
    # polyhedra inside round shapes are a little smaller
    ({"kind": "sphere", "radius": 0.5}, 4.0 / 3.0 * math.pi * 0.125, 0.05),
    ({"kind": "ellipsoid", "radii": [1.0, 2.0, 0.5]}, 4.0 / 3.0 * math.pi, 0.05),
    ({"kind": "capsule", "radius": 0.5, "length": 2.0}, 4.0 / 3.0 * math.pi * 0.125 + math.pi * 0.5, 0.05),
)


@pytest.mark.parametrize(("piece", "expected", "less"), EXPECTED)
def test_volume(piece: dict[str, object], expected: float, less: float) -> None:
    found = volume(mesh.body([piece | PLACE]))
    assert expected * (1.0 - less) - 1e-12 <= found <= expected * (1.0 + 1e-12)


def test_pieces_of_a_body_are_where_they_are_put() -> None:
    cube, tower = {"kind": "box", "size": [2.0, 2.0, 2.0]}, {"kind": "box", "size": [1.0, 1.0, 4.0]}
    corners, faces = mesh.body([cube | PLACE, tower | PLACE])
    assert corners.min(axis=0) == pytest.approx([-0.7, -2.2, -0.9]) and corners.max(axis=0) == pytest.approx([1.3, 1.8, 1.1])
    assert faces.max() == len(corners) - 1 and len(faces) == 24 and [len(part) for part in mesh.body([])] == [0, 0]
