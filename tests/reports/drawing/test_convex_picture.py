"""Projections agree with what sampling the surface gives, and what is nearer to the eye is drawn later."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from reports.drawing import mesh
from reports.drawing.convex_picture import Piece, flat_hull, order, placed
from reports.drawing.mesh import Array

PIECES: dict[str, dict[str, Any]] = {
    "sphere": {"kind": "sphere", "radius": 0.3},
    "capsule": {"kind": "capsule", "radius": 0.1, "length": 0.6},
    "ellipsoid": {"kind": "ellipsoid", "radii": [0.1, 0.2, 0.4]},
    "box": {"kind": "box", "size": [0.2, 0.4, 0.6]},
    "hull": {"kind": "hull", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]},
}
OWN: dict[str, Any] = {"position": [0.1, -0.2, 0.3], "orientation": [0.8, 0.0, 0.6, 0.0]}
AXES = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])
TOWARDS = np.cross(AXES[0], AXES[1])
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def area(outline: Array) -> float:
    shifted = np.roll(outline, -1, axis=0)
    return 0.5 * abs(float(np.sum(outline[:, 0] * shifted[:, 1] - outline[:, 1] * shifted[:, 0])))


def made(kind: str, position: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Piece:
    return placed(PIECES[kind] | OWN, np.array(position), UPRIGHT)


@pytest.mark.parametrize("kind", PIECES)
def test_an_outline_is_that_of_the_triangles(kind: str) -> None:
    triangles, _ = mesh.body([PIECES[kind] | OWN])
    own, expected = made(kind).outline(AXES), flat_hull(triangles @ AXES.T)
    assert area(own) == pytest.approx(area(expected), rel=1e-9) and own.min(axis=0) == pytest.approx(expected.min(axis=0))


def test_faces_of_one_plane_are_one() -> None:
    found = made("box")
    assert sorted(len(face) for face in found.faces) == [4] * 6
    middle = found.corners.mean(axis=0)
    for face, normal in zip(found.faces, found.normals, strict=True):
        assert normal @ (found.corners[face].mean(axis=0) - middle) > 0.0
    assert sorted(len(face) for face in made("hull").faces) == [3, 3, 3, 3] and not made("sphere").faces


def middle(piece: Piece) -> float:
    """Coordinate [m] of the middle towards the eye."""
    return float(piece.corners.mean(axis=0) @ TOWARDS)


def drawn(pieces: list[Piece]) -> list[int]:
    return order(pieces, [piece.outline(AXES) for piece in pieces], TOWARDS, 1.0)


def box(size: tuple[float, float, float], position: np.ndarray, turn: np.ndarray = UPRIGHT) -> Piece:
    return placed({"kind": "box", "size": size, "position": (0.0, 0.0, 0.0), "orientation": UPRIGHT.tolist()}, position, turn)


def test_a_ball_before_a_large_wall_is_drawn_after_it() -> None:
    """The wall's centre is nearer to the eye than the ball's, and still the ball covers it."""
    wall = box((4.0, 4.0, 0.1), np.array([0.0, -1.5, 0.0]))
    below, above = (placed(PIECES["sphere"] | OWN, np.array([0.0, 0.0, height]), UPRIGHT) for height in (-0.9, 0.2))
    assert middle(below) < middle(above)
    assert drawn([above, wall, below]) == [2, 1, 0]


def test_a_stack_is_drawn_from_below_and_a_ring_still_is_drawn_whole() -> None:
    assert drawn([box((0.3, 0.3, 0.3), np.array([0.0, 0.0, 0.3 * k])) for k in (3, 0, 2, 1)]) == [1, 3, 2, 0]
    spokes = []
    for turn in (0.0, 2.0, 4.0):
        tilt = np.array([np.cos(0.2), 0.2 * np.cos(turn), 0.2 * np.sin(turn), 0.0])
        place = np.array([0.25 * np.cos(turn), 0.25 * np.sin(turn), 0.0])
        spokes.append(box((1.0, 0.1, 0.1), place, tilt / np.linalg.norm(tilt)))
    assert sorted(drawn(spokes)) == [0, 1, 2]


def test_balls_are_drawn_from_far_to_near() -> None:
    balls = [placed(PIECES["sphere"] | OWN, np.array(TOWARDS) * way, UPRIGHT) for way in (0.3, -0.2, 0.8, 0.0)]
    heights = [middle(balls[k]) for k in drawn(balls)]
    assert all(first < second for first, second in pairwise(heights))
