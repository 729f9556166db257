"""Masses, inertias, coefficients and first velocities as arrays."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import UnknownName
from avatarsim.model.dynamics import dynamics, meeting_materials, velocities
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import ContactLaw, PairTable, Role, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece

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
    other = fixed("other", CRATE, "wood", (9.0, 0.0, -5.0))
    found = dynamics(Scene("s", (FLOOR, DROP, other), (HAND,)))
    floor, drop, _, hand = found.material
    assert found.restitution[floor, drop] == 0.2 and found.friction[floor, drop] == 0.1 and found.friction[drop, hand] == 0.1
    assert (found.restitution == found.restitution.T).all() and (found.friction == found.friction.T).all()
    # two fixed bodies never meet, and there is one of metal only
    assert found.restitution[floor, floor] == 0.0 and found.restitution[drop, drop] == 0.0


def test_materials_that_meet_are_those_of_some_wanted_pair() -> None:
    """Against the matrix of wanted pairs, with exclusions that leave some materials no pair at all."""
    rng = np.random.default_rng(2)
    for _ in range(40):
        names = [f"b{k}" for k in range(7)]
        bodies = [
            fixed(name, CRATE, str(rng.choice(["wood", "metal"]))) if rng.random() < 0.4
            else simulated(name, CRATE, str(rng.choice(["wood", "metal", "human"])), MASS) for name in names
        ]
        exclude = tuple((a, b) for a in names for b in names if a != b and rng.random() < 0.35)
        scene = Scene("s", tuple(bodies), exclude=exclude)
        kinds, wanted = scene.material_names, scene.pair_filter
        pairs = {tuple(sorted((kinds[a], kinds[b]))) for a in range(7) for b in range(7) if wanted[a, b]}
        assert meeting_materials(scene) == sorted(pairs)


@pytest.mark.parametrize("effect", ["restitution", "friction"])
def test_an_effect_narrowed_away_is_zero(effect: str) -> None:
    found = dynamics(Scene("s", (FLOOR, DROP), narrow=(effect,)))
    assert not getattr(found, effect).any()
    assert (found.friction if effect == "restitution" else found.restitution).any()


def test_a_pair_that_the_table_lacks_is_named() -> None:
    table = PairTable({("wood", "wood"): ContactLaw(0.1, 0.1), ("metal", "metal"): ContactLaw(0.1, 0.1)})
    with pytest.raises(UnknownName, match="pair of materials is 'metal, wood'"):
        dynamics(Scene("s", (FLOOR, DROP), materials=table))


def test_first_velocities() -> None:
    found = velocities(Scene("s", (FLOOR, DROP), (HAND,)))
    assert found.linear.tolist() == [[0, 0, 0], [1, 2, 3], [0, 0, 0]]
    assert found.angular.tolist() == [[0, 0, 0], [4, 5, 6], [0, 0, 0]]
