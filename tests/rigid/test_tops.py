"""A top on its tip, by public types: spin, precession and energy, for tops drawn at random."""

from math import cos, sin

import numpy as np
import pytest

from avatarsim.scene.body import Body, simulated, solid
from avatarsim.scene.shape import Piece
from avatarsim.spatial import rotation
from reference.closed_form import top_precession
from scenarios.catalog.contact.top import piece, reach
from tests.rigid.upper_world import G, World, slab

SECONDS = 2.0


def drawn(seed: int, friction: float) -> tuple[World, float, float, float]:
    """(a top on a slab, its spin [rad/s], precession without friction [rad/s], seconds of a frame); all drawn by ``seed``."""
    random = np.random.default_rng(seed)
    mass, spin, lean = 10.0 ** random.uniform(-2.0, 0.5), random.uniform(100.0, 300.0), random.uniform(0.05, 0.4)
    pieces: tuple[Piece, ...] = (piece(),)
    held, axis = solid(pieces, mass), np.array([sin(lean), 0.0, cos(lean)])
    place = (0.0, 0.0, reach() * cos(lean) + 2e-8)
    turn = tuple(rotation.from_rotation_vector(np.array([0.0, lean, 0.0])))
    top: Body = simulated("top", pieces, "m", held, place, turn, angular_velocity=tuple(spin * axis))
    moments = np.diag(held.inertia)
    rate = top_precession(float(moments[0]), float(moments[2]), mass, reach(), spin, lean, G)
    return World([slab(), top], 0.0, friction), spin, rate, 1.0 / random.uniform(60.0, 240.0)


def watched(world: World, dt: float) -> tuple[np.ndarray, float, float]:
    """(spin [rad/s] after every frame, mean precession [rad/s], largest rise of energy in a frame as a part of it)."""
    spins, angle, last, most, energy = [], 0.0, 0.0, 0.0, world.energy()
    frames = round(SECONDS / dt)
    for _ in range(frames):
        assert world.frame(dt) == 0
        axis = world.poses.rotation[1, :, 2]
        spins.append(axis @ world.velocities.angular[1])
        now = float(np.arctan2(axis[1], axis[0]))
        angle += (now - last + np.pi) % (2.0 * np.pi) - np.pi
        last = now
        most, energy = max(most, (world.energy() - energy) / energy), world.energy()
    assert world.gap() > -1e-6
    return np.array(spins), angle / (frames * dt), most


@pytest.mark.parametrize("seed", range(12))
def test_a_top_keeps_its_spin_and_precesses(seed: int) -> None:
    """Its axis goes round as by closed form, but for the part of a nod in which the time ends; nods alone lose energy."""
    world, spin, rate, dt = drawn(seed, 0.0)
    energy = world.energy()
    spins, found, most = watched(world, dt)
    np.testing.assert_allclose(spins, spin, rtol=1e-4)
    assert found == pytest.approx(rate, rel=0.03) and most < 1e-9
    assert world.energy() == pytest.approx(energy, rel=1e-4)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("friction", [0.01, 0.3])
def test_friction_at_its_tip_takes_no_spin_and_gives_no_energy(friction: float, seed: int) -> None:
    """The tip is on the axis: friction there has no torque about it."""
    world, spin, _, dt = drawn(seed, friction)
    spins, _, most = watched(world, dt)
    np.testing.assert_allclose(spins, spin, rtol=1e-3)
    assert most < 1e-9
