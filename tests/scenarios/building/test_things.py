"""Things that scenes are filled with: hulls about their own centre along their own axes, the same from the same seed."""

import numpy as np
import pytest

from avatarsim.scene.body import Role, solid
from avatarsim.scene.shape import ConvexHull
from scenarios.building.things import drawn_hull, mixed, open_box, prism


@pytest.mark.parametrize("seed", range(5))
def test_a_drawn_hull_lies_about_its_centre_along_its_principal_axes(seed: int) -> None:
    piece = drawn_hull(np.random.default_rng(seed), 0.045)
    mass = solid((piece,), 0.2)
    assert np.abs(mass.centre).max() < 1e-12
    off = mass.inertia - np.diag(np.diag(mass.inertia))
    assert np.abs(off).max() < 1e-12 * np.abs(mass.inertia).max() + 1e-18
    assert isinstance(piece.shape, ConvexHull)
    # the centre of mass lies inside the ball that the corners are drawn from
    assert np.linalg.norm(piece.shape.vertices, axis=1).max() < 2.0 * 0.045


def test_the_same_seed_draws_the_same_things_and_kinds_take_turns() -> None:
    first, again = (mixed(np.random.default_rng(7), 9) for _ in range(2))
    for one, other in zip(first, again, strict=True):
        assert type(one.shape) is type(other.shape)
        assert solid((one,), 1.0).inertia.tolist() == solid((other,), 1.0).inertia.tolist()
    assert len({type(piece.shape) for piece in first[:3]}) == 3


def test_a_prism_has_the_moments_of_its_circle_as_its_sides_grow() -> None:
    mass = solid((prism(200, 0.03, 0.01),), 2.0)
    assert mass.inertia[2, 2] == pytest.approx(0.5 * 2.0 * 0.03**2, rel=1e-3)
    assert mass.inertia[0, 0] == pytest.approx(2.0 * (3.0 * 0.03**2 + 0.01**2) / 12.0, rel=1e-3)


def test_an_open_box_has_its_floor_at_nought_and_its_walls_around_its_width() -> None:
    floor, *walls = open_box(0.5, 0.3, 0.04, "wall")
    assert floor.position == (0.0, 0.0, 0.0) and all(body.role is Role.FIXED for body in (floor, *walls))
    inside = [max(abs(wall.position[0]), abs(wall.position[1])) - 0.02 for wall in walls]
    assert inside == pytest.approx([0.25] * 4) and {wall.position[2] for wall in walls} == {0.15}
