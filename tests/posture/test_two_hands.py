"""Two hands that cannot pass each other: nothing may jump, so they wait."""

from dataclasses import replace

import numpy as np

from avatarsim.scene.body import Body, fixed
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import rest
from tests.posture.little_worlds import hand
from tests.posture.ride import ride


def tube() -> tuple[Body, ...]:
    """Four slabs around the x axis, inner width 0.12 m: two hands of 0.1 m cannot pass each other inside."""

    def slab(name: str, centre: Vector, size: Vector) -> Body:
        return fixed(name, (Piece(Box(size)),), "wood", centre)

    return (
        slab("left", (0.0, 0.11, 0.0), (4.0, 0.1, 0.32)),
        slab("right", (0.0, -0.11, 0.0), (4.0, 0.1, 0.32)),
        slab("over", (0.0, 0.0, 0.11), (4.0, 0.32, 0.1)),
        slab("under", (0.0, 0.0, -0.11), (4.0, 0.32, 0.1)),
    )


def test_two_hands_in_a_tube_wait_for_each_other_when_nothing_may_jump() -> None:
    pair = (hand(), hand(name="other"))
    home = rest(pair)
    apart = replace(home, positions=np.array([[-0.4, 0.0, 0.0], [0.4, 0.0, 0.0]]))
    go = ride(Scene("s", tube(), pair, start=apart), untie=0)
    for _ in range(60):
        go.frame(replace(home, positions=-apart.positions))
        assert go.place("hand")[0] < go.place("other")[0]
    for _ in range(20):
        go.frame(apart)
    assert go.error(apart) < 1e-9
