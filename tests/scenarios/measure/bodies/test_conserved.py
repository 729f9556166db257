"""Conservation in groups of bodies: injected losses and gains are found, group by group."""

import numpy as np
import pytest

from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from runfiles.record import Recording
from scenarios.measure.bodies.conserved import conserved
from tests.scenarios.examples import expecting, resting

PIECES = (Piece(Sphere(0.1)),)
SCENE = Scene("two", (
    simulated("a", PIECES, "wood", solid(PIECES, 1.0), (-1.0, 0.0, 0.0)),
    simulated("b", PIECES, "wood", solid(PIECES, 3.0), (1.0, 0.0, 0.0)),
), gravity=(0.0, 0.0, 0.0))
PAIR = ("a", "b")


def recording(first: tuple[float, float], second: tuple[float, float]) -> Recording:
    """Return a recording with these speeds of a and b along y in the first and the second half of twenty frames."""
    found = resting(SCENE, 20)
    found.velocities[:10, :, 1], found.velocities[10:, :, 1] = first, second
    return found


def test_what_momentum_lacks_is_relative_to_what_there_was() -> None:
    found = conserved(recording((2.0, -1.0), (2.0, -0.9)), expecting(20, isolated=(PAIR,)), SCENE)
    assert found["momentum_drift_max"] == pytest.approx(0.3 / 5.0)
    # about the common centre at x = 0.5: arms -1.5 and 0.5; relative speeds 2.25 and -0.75 at first, 2.175 and -0.725 later
    first, second = 1.5 * 2.25 + 0.5 * 3.0 * 0.75, 1.5 * 2.175 + 0.5 * 3.0 * 0.725
    assert found["angular_momentum_drift_max"] == pytest.approx((first - second) / first)


def test_energy_drift_is_of_both_signs_and_gain_of_one() -> None:
    lost = conserved(recording((2.0, 0.0), (1.0, 0.0)), expecting(20, elastic=(PAIR,), alone=(PAIR,)), SCENE)
    assert lost == {"energy_drift_max": pytest.approx(0.75), "energy_gain_max": 0.0}
    won = conserved(recording((1.0, 0.0), (2.0, 0.0)), expecting(20, elastic=(PAIR,), alone=(PAIR,)), SCENE)
    assert won == {"energy_drift_max": pytest.approx(0.75), "energy_gain_max": pytest.approx(0.75)}


def test_one_group_cannot_hide_behind_another() -> None:
    found = conserved(recording((2.0, 1.0), (0.0, 1.1)), expecting(20, alone=(("a",), ("b",))), SCENE)
    assert found["energy_gain_max"] == pytest.approx((1.21 - 1.0) / 1.21)


def test_who_never_moves_keeps_nothing_but_gains_nothing_either() -> None:
    found = conserved(recording((0.0, 0.0), (0.0, 0.0)), expecting(20, isolated=(PAIR,), elastic=(PAIR,), alone=(PAIR,)), SCENE)
    assert found["energy_gain_max"] == 0.0 and len(found) == 4
    assert all(value == pytest.approx(np.nan, nan_ok=True) for name, value in found.items() if name != "energy_gain_max")


def test_nan_is_never_lost_among_groups() -> None:
    bad = recording((1.0, 1.0), (1.0, np.nan))
    found = conserved(bad, expecting(20, alone=(("b",), ("a",)), elastic=(("b",), ("a",))), SCENE)
    assert found["energy_gain_max"] == pytest.approx(np.nan, nan_ok=True) == found["energy_drift_max"]
