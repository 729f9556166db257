"""Parts of scenes: hulls about their own centre, prisms, an open box, and the rigid hand of fifteen parts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull as QuickHull

from avatarsim.scene.body import Role, solid
from avatarsim.scene.joint import Free
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull
from avatarsim.scene.tracker import rest
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from scenarios.building.avatars.hand import DIGITS, MASS, hand_pieces, rigid_hand
from scenarios.building.cases import loose
from scenarios.building.reach import reach
from scenarios.building.things import drawn_hull, mixed, open_box, prism


@given(st.integers(0, 2**32 - 1))
def test_a_drawn_hull_lies_about_its_centre_along_its_principal_axes(seed: int) -> None:
    piece = drawn_hull(np.random.default_rng(seed), 0.045)
    mass = solid((piece,), 0.2)
    off = mass.inertia - np.diag(np.diag(mass.inertia))
    assert np.abs(mass.centre).max() < 1e-12 and np.abs(off).max() < 1e-12 * np.abs(mass.inertia).max() + 1e-18
    # the centre of mass lies inside the ball that the corners are drawn from
    assert isinstance(piece.shape, ConvexHull) and np.linalg.norm(piece.shape.vertices, axis=1).max() < 2.0 * 0.045


def test_a_seed_draws_the_same_things_and_kinds_take_turns() -> None:
    first, again = (mixed(np.random.default_rng(7), 9) for _ in range(2))
    for one, other in zip(first, again, strict=True):
        assert type(one.shape) is type(other.shape)
        assert solid((one,), 1.0).inertia.tolist() == solid((other,), 1.0).inertia.tolist()
    assert len({type(piece.shape) for piece in first[:3]}) == 3


def test_a_prism_has_the_moments_of_its_circle_as_its_sides_grow() -> None:
    inertia = solid((prism(200, 0.03, 0.01),), 2.0).inertia
    assert inertia[2, 2] == pytest.approx(0.5 * 2.0 * 0.03**2, rel=1e-3)
    assert inertia[0, 0] == pytest.approx(2.0 * (3.0 * 0.03**2 + 0.01**2) / 12.0, rel=1e-3)


def test_an_open_box_has_its_floor_at_nought_and_its_walls_around_its_width() -> None:
    floor, *walls = open_box(0.5, 0.3, 0.04, "wall")
    assert floor.position == (0.0, 0.0, 0.0) and all(body.role is Role.FIXED for body in (floor, *walls))
    inside = [max(abs(wall.position[0]), abs(wall.position[1])) - 0.02 for wall in walls]
    assert inside == pytest.approx([0.25] * 4) and {wall.position[2] for wall in walls} == {0.15}


def test_a_rigid_hand_of_fifteen_parts_of_a_hundred_triangles_has_the_size_and_weight_of_a_hand() -> None:
    pieces, hand = hand_pieces(), rigid_hand()
    (link,), sample = hand.links, rest((hand,))
    assert len(pieces) == 15 == 1 + sum(len(digit.bones) for digit in DIGITS)
    for piece in pieces:
        assert isinstance(piece.shape, ConvexHull) and len(QuickHull(piece.shape.vertices).simplices) == 100
    assert isinstance(link.joint, Free) and link.material == "human" and link.mass.mass == pytest.approx(MASS)
    length, width, thickness = (
        float(reach((hand,), (sample,), axis)[0] + reach((hand,), (sample,), -axis)[0]) for axis in np.eye(3)
    )
    assert 0.18 < length < 0.21 and 0.08 < width < 0.15 and 0.02 < thickness < 0.05
    # the palm is level, so that it lies flat on a table
    assert reach((hand,), (sample,), (0.0, 0.0, -1.0))[0] == pytest.approx(0.0157, abs=2e-4)


def test_neighbouring_parts_of_the_hand_run_into_each_other() -> None:
    parts = tuple(loose(str(k), piece, "human", 1.0) for k, piece in enumerate(hand_pieces()))
    verdict = Judge(Scene("loose", parts)).overlaps(np.zeros((15, 3)), np.tile(rotation.IDENTITY, (15, 1)))
    joined = {"0"}
    # grow from the palm: a part belongs to the hand when it lies half a millimetre deep in one that does
    for _ in parts:
        for a, b, depth in verdict.pairs:
            if depth > 5e-4 and {a, b} & joined:
                joined |= {a, b}
    assert joined == {body.name for body in parts}
