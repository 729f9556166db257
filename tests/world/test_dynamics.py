"""Masses, inertias, coefficients and first velocities as arrays."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import UnknownName
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Role, fixed, simulated
from avatarsim.scene.mass import solid
from avatarsim.scene.material import Contact, PairTable
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.world.dynamics import dynamics, velocities

CRATE = (Piece(Box((0.1, 0.2, 0.3)), (0.5, 0.0, 0.0)),)
MASS = solid(CRATE, 4.0)
FLOOR = fixed("floor", CRATE, "wood", (0.0, 0.0, -5.0))
DROP = simulated("drop", CRATE, "metal", MASS, velocity=(1.0, 2.0, 3.0), angular_velocity=(4.0, 5.0, 6.0))
HAND = rigid_avatar("hand", CRATE, solid(CRATE, 0.5))


def test_masses_by_role() -> None:
    found = dynamics(Scene("s", (FLOOR, DROP), (HAND, replace(HAND, name="other", coupled_mass=8.0))))
    assert found.role.tolist() == [Role.FIXED.value, Role.SIMULATED.value, Role.DRIVEN.value, Role.DRIVEN.value]
    assert found.inverse_mass.tolist() == [0.0, 0.25, 2.0, 0.125]
    assert found.inertia[1] == pytest.approx(MASS.inertia) and not found.inertia[[0, 2, 3]].any()
    assert found.inverse_inertia[1] @ found.inertia[1] == pytest.approx(np.eye(3))
    assert found.gravity.tolist() == [0.0, 0.0, -9.81]


def test_coefficients_are_those_of_wanted_pairs_and_symmetric() -> None:
    found = dynamics(Scene("s", (FLOOR, DROP), (HAND,)))
    assert found.restitution[0, 1] == 0.2 and found.friction[0, 1] == 0.1 and found.friction[1, 2] == 0.1
    assert (found.restitution == found.restitution.T).all() and (found.friction == found.friction.T).all()
    assert found.restitution[0, 0] == 0.0


@pytest.mark.parametrize("effect", ["restitution", "friction"])
def test_an_effect_narrowed_away_is_zero(effect: str) -> None:
    found = dynamics(Scene("s", (FLOOR, DROP), narrow=(effect,)))
    assert not getattr(found, effect).any()
    assert (found.friction if effect == "restitution" else found.restitution).any()


def test_a_pair_that_the_table_lacks_is_named() -> None:
    table = PairTable({("wood", "wood"): Contact(0.1, 0.1), ("metal", "metal"): Contact(0.1, 0.1)})
    with pytest.raises(UnknownName, match="pair of materials is 'wood, metal'"):
        dynamics(Scene("s", (FLOOR, DROP), materials=table))


def test_first_velocities() -> None:
    found = velocities(Scene("s", (FLOOR, DROP), (HAND,)))
    assert found.linear.tolist() == [[0, 0, 0], [1, 2, 3], [0, 0, 0]] and found.angular.tolist() == [
        [0, 0, 0],
        [4, 5, 6],
        [0, 0, 0],
    ]
