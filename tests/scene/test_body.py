"""Fixed and simulated bodies and what they refuse."""

import math

import pytest

from avatarsim.errors import InvalidScene
from avatarsim.scene.body import Body, Role, fixed, simulated, solid
from avatarsim.scene.shape import Piece, Sphere

BALL = (Piece(Sphere(0.1)),)
MASS = solid(BALL, 1.0)


def test_the_two_makers_set_the_role() -> None:
    assert fixed("a", BALL, "wood").role is Role.FIXED
    assert simulated("a", BALL, "wood", MASS).role is Role.SIMULATED


def test_a_body_needs_pieces() -> None:
    with pytest.raises(InvalidScene, match="number of pieces of body crate is 0; valid: at least 1"):
        fixed("crate", (), "wood")


def test_a_simulated_body_needs_a_mass() -> None:
    with pytest.raises(InvalidScene, match="mass of simulated body crate is None"):
        simulated("crate", BALL, "wood", None)


def test_driven_bodies_are_avatars() -> None:
    with pytest.raises(InvalidScene, match="role of body hand is 'driven'; valid: fixed or simulated"):
        Body("hand", Role.DRIVEN, BALL, "wood")


@pytest.mark.parametrize(
    ("field", "value", "thing"),
    [
        ("position", (math.nan, 0.0, 0.0), "position of crate"), ("position", (0.0, 0.0), "position of crate"),
        ("orientation", (2.0, 0.0, 0.0, 0.0), "orientation of crate"), ("velocity", (0.0, math.inf, 0.0), "velocity of crate"),
        ("angular_velocity", (0.0, 0.0, math.nan), "angular velocity of crate"),
    ],
)
def test_places_and_velocities_must_be_finite(field: str, value: tuple[float, ...], thing: str) -> None:
    with pytest.raises(InvalidScene) as error:
        Body("crate", Role.SIMULATED, BALL, "wood", mass=MASS, **{field: value})
    assert thing in str(error.value)


@pytest.mark.parametrize("which", ["velocity", "angular_velocity"])
def test_what_is_fixed_has_no_velocity(which: str) -> None:
    """Impacts would read it, and a floor that never moves would kick for ever."""
    with pytest.raises(InvalidScene, match="velocity of fixed body floor .* zero"):
        Body("floor", Role.FIXED, BALL, "wood", **{which: (0.0, 0.0, 1.0)})
