"""The rigid hand: fifteen parts of a hundred triangles, the size and weight of a hand, in one piece."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from avatarsim.scene.body import simulated, solid
from avatarsim.scene.joint import Free
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull as Hull
from avatarsim.scene.tracker import rest
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from scenarios.building.avatars.hand import DIGITS, MASS, hand_pieces, rigid_hand
from scenarios.building.reach import reach


def test_fifteen_parts_of_a_hundred_triangles() -> None:
    pieces = hand_pieces()
    assert len(pieces) == 15 == 1 + sum(len(digit.bones) for digit in DIGITS)
    for piece in pieces:
        assert isinstance(piece.shape, Hull)
        assert len(ConvexHull(piece.shape.vertices).simplices) == 100


def test_it_has_the_size_and_weight_of_a_hand() -> None:
    hand = rigid_hand()
    (link,), sample = hand.links, rest((hand,))
    assert isinstance(link.joint, Free) and link.material == "human"
    assert link.mass.mass == pytest.approx(MASS)
    length, width, thickness = (
        float(reach((hand,), (sample,), axis)[0] + reach((hand,), (sample,), -axis)[0]) for axis in np.eye(3)
    )
    assert 0.18 < length < 0.21 and 0.08 < width < 0.15 and 0.02 < thickness < 0.05


def test_the_palm_is_level_so_that_it_lies_flat_on_a_table() -> None:
    hand = rigid_hand()
    below = reach((hand,), (rest((hand,)),), (0.0, 0.0, -1.0))[0]
    assert below == pytest.approx(0.0157, abs=2e-4)


def test_neighbouring_parts_run_into_each_other() -> None:
    loose = tuple(
        simulated(str(k), (piece,), "human", solid((piece,), 1.0)) for k, piece in enumerate(hand_pieces())
    )
    verdict = Judge(Scene("loose", loose)).overlaps(np.zeros((15, 3)), np.tile(rotation.IDENTITY, (15, 1)))
    joined = {"0"}
    # grow from the palm: a part belongs to the hand when it lies half a millimetre deep in one that does
    for _ in loose:
        for a, b, depth in verdict.pairs:
            if depth > 5e-4 and {a, b} & joined:
                joined |= {a, b}
    assert joined == {body.name for body in loose}
