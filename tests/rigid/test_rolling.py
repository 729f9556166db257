"""Bodies on a smooth surface roll, and tops precess, as closed forms predict, at every frame time."""

from itertools import combinations_with_replacement
from math import cos, radians, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.rigid.state import SEGMENTS, SUBSTEPS
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Shape
from avatarsim.spatial import rotation
from reference.closed_form import top_precession
from scenarios.catalog.flight.flight import piece, reach
from tests.rigid.upper_world import G, World, ball, slab, thing

R, LAID = 0.05, 2e-8
"""Radius of the log [m]; gap at which bodies are laid on one another [m]."""
LOG = Capsule(R, 0.2)
LYING, ALONG_X = (sqrt(0.5), sqrt(0.5), 0.0, 0.0), (sqrt(0.5), 0.0, sqrt(0.5), 0.0)
"""With its axis along y, and along x."""
RATES = [30.0, 60.0, 240.0, 1000.0]
DOWN = (0.0, 0.0, -G)


def log(
    velocity: float, spin: tuple[float, float, float], friction: float, gravity: tuple[float, float, float] = DOWN,
    shape: Capsule = LOG,
) -> World:
    """Return a log across its way along x, on a floor."""
    body = thing(
        "log", shape, (0.0, 0.0, shape.radius + LAID), orientation=LYING, velocity=(velocity, 0.0, 0.0), angular_velocity=spin
    )
    return World([slab(), body], 0.0, friction, gravity)


def share(world: World, radius: float = R) -> float:
    """Return I / (m r^2) about the axis of the log."""
    return float(world.dynamics.inertia[1][2, 2] * world.dynamics.inverse_mass[1]) / radius**2


def run(world: World, seconds: float, rate: float) -> float:
    """Run frames that all succeed, none with a plastic step and none that gains energy; return the lost energy [J]."""
    first = last = world.energy()
    for _ in range(round(seconds * rate)):
        assert world.frame(1.0 / rate) == 0
        assert world.memory.counts[SUBSTEPS] == 0
        energy = world.energy()
        assert energy <= last + 1e-12
        last = energy
    assert world.gap() > -5e-7
    return first - last


@settings(max_examples=25, deadline=None)
@given(
    radius=st.floats(0.01, 0.3), slender=st.floats(0.2, 10.0), velocity=st.floats(0.1, 20.0), spin=st.floats(-1.0, 1.0),
    friction=st.just(0.0) | st.floats(0.05, 1.0), rate=st.sampled_from(RATES),
)
def test_any_log_slides_until_it_rolls(
    radius: float, slender: float, velocity: float, spin: float, friction: float, rate: float
) -> None:
    """m v r + I w about the line stays, whatever friction does; slip v0 - w0 r lasts for its size times k / ((1 + k) mu g)."""
    seconds = 0.3
    world = log(velocity, (0.0, spin * velocity / radius, 0.0), friction, shape=Capsule(radius, slender * radius))
    k, slip = share(world, radius), velocity - spin * velocity
    run(world, seconds, rate)
    v, w = world.velocities.linear[1, 0], world.velocities.angular[1, 1]
    kept = (velocity + k * spin * velocity) / (1.0 + k)
    assert (v + k * w * radius) / (1.0 + k) == pytest.approx(kept, abs=1e-6)
    lasts = abs(slip) * k / ((1.0 + k) * friction * G) if friction > 0.0 else np.inf
    slides = min(seconds, lasts)
    left = slip * max(0.0, 1.0 - seconds / lasts) if lasts > 0.0 else 0.0
    assert v - w * radius == pytest.approx(left, abs=1e-6)
    way = velocity * seconds - friction * G * np.sign(slip) * slides * (seconds - 0.5 * slides)
    assert world.poses.position[1, 0] == pytest.approx(way, abs=1e-6)


@pytest.mark.parametrize("degrees", [5.0, 15.0, 30.0])
@pytest.mark.parametrize("rate", RATES)
def test_a_log_rolls_down_an_incline(rate: float, degrees: float) -> None:
    """a = g sin t / (1 + I / (m r^2))."""
    t = radians(degrees)
    world = log(0.0, (0.0, 0.0, 0.0), 0.6, (G * sin(t), 0.0, -G * cos(t)))
    a = G * sin(t) / (1.0 + share(world))
    run(world, 0.6, rate)
    assert world.velocities.linear[1, 0] == pytest.approx(0.6 * a, abs=1e-6)
    assert world.poses.position[1, 0] == pytest.approx(0.18 * a, abs=1e-6)


@pytest.mark.parametrize("rate", RATES)
def test_a_log_spins_about_the_vertical(rate: float) -> None:
    """With friction it comes to rest where it is; without it turns on, and its rolling motion turns with its axis."""
    world = log(0.0, (0.0, 0.0, 10.0), 0.3)
    run(world, 0.6, rate)
    np.testing.assert_allclose(world.poses.position[1], [0.0, 0.0, R + LAID], atol=1e-8)
    assert not np.any(world.velocities.linear[1]) and not np.any(world.velocities.angular[1])
    world = log(1.0, (0.0, 20.0, 2.0), 0.0)
    run(world, 0.6, rate)
    np.testing.assert_allclose(world.poses.position[1], [0.6, 0.0, R + LAID], atol=2e-7)
    expected = [-20.0 * sin(1.2), 20.0 * cos(1.2), 2.0]
    np.testing.assert_allclose(world.velocities.angular[1], expected, atol=5e-3)


@pytest.mark.parametrize(("radii", "velocity", "friction", "most"), [
    ((0.1, 0.06, 0.05), 0.0, 0.0, 3e-2), ((0.06, 0.06, 0.05), 0.0, 0.0, 3e-2), ((0.3, 0.1, 0.04), 0.0, 0.0, 3e-2),
    ((0.1, 0.06, 0.05), 0.15, 1.0, 2e-2),
])
@pytest.mark.parametrize("rate", RATES)
def test_an_egg_rocks_or_rolls_to_and_fro(
    rate: float, radii: tuple[float, float, float], velocity: float, friction: float, most: float
) -> None:
    """It gains no energy and loses hundredths of its motion's; without friction its centre stays above one point."""
    body = thing(
        "egg", Ellipsoid(radii), (0.0, 0.0, radii[2] + LAID), velocity=(velocity, 0.0, 0.0), angular_velocity=(0.0, 3.0, 0.0)
    )
    world = World([slab(), body], 0.0, friction)
    motion = world.energy() - G * (radii[2] + LAID)
    assert run(world, 1.0, rate) < most * motion
    if friction == 0.0:
        np.testing.assert_allclose(world.poses.position[1, :2], 0.0, atol=1e-9)


@pytest.mark.parametrize("rate", RATES)
def test_a_log_rolls_along_another_that_it_crosses(rate: float) -> None:
    bar = fixed("bar", (Piece(Capsule(R, 2.0)),), "m", position=(0.0, 0.0, -R), orientation=ALONG_X)
    body = thing("log", LOG, (0.0, 0.0, R + LAID), orientation=LYING, velocity=(0.5, 0.0, 0.0), angular_velocity=(0.0, 10.0, 0.0))
    world = World([bar, body], 0.0, 0.5)
    run(world, 0.6, rate)
    np.testing.assert_allclose(world.poses.position[1], [0.3, 0.0, R + LAID], atol=1e-7)
    np.testing.assert_allclose(world.velocities.linear[1], [0.5, 0.0, 0.0], atol=1e-7)


@pytest.mark.parametrize("shape", [LOG, Ellipsoid((R, R, 0.2))])
@pytest.mark.parametrize("rate", RATES)
def test_what_rolls_off_a_log_obeys_energy(rate: float, shape: Shape) -> None:
    """Side by side: v^2 (1 + k) / 2 = g (R + r) (1 - cos a), until it leaves."""
    wide = 0.2
    bar = fixed("bar", (Piece(Capsule(wide, 2.0)),), "m", position=(0.0, 0.0, -wide), orientation=LYING)
    start, v = (0.0, 0.0, R + LAID), 0.2
    body = thing("log", shape, start, orientation=LYING, velocity=(v, 0.0, 0.0), angular_velocity=(0.0, v / R, 0.0))
    world = World([bar, body], 0.0, 2.0)
    k = share(world)
    run(world, 0.2, rate)
    fallen = R - world.poses.position[1, 2]
    speed = float(np.linalg.norm(world.velocities.linear[1]))
    assert fallen > 2e-3
    assert speed == pytest.approx(sqrt(v * v + 2.0 * G * fallen / (1.0 + k)), rel=1e-3)
    assert world.velocities.angular[1, 1] == pytest.approx(speed / R, rel=1e-3)


def on_ice(carrier: str, friction: float) -> PairTable:
    """Return materials without friction but for "m" on the carrier and on itself."""
    names = ("floor", carrier, "m")
    pairs = dict.fromkeys(combinations_with_replacement(names, 2), ContactLaw(0.0, 0.0))
    return PairTable(pairs | dict.fromkeys(((carrier, "m"), ("m", "m")), ContactLaw(0.0, friction)))


@pytest.mark.parametrize("rate", RATES)
def test_a_ball_on_a_turntable_runs_in_a_circle(rate: float) -> None:
    """Its velocity turns at 2/7 of the table's rate (Earnshaw)."""
    table = thing("table", Box((2.0, 2.0, 0.1)), (0.0, 0.0, 0.05 + LAID), 1e5, material="table", angular_velocity=(0.0, 0.0, 2.0))
    body = ball("ball", (0.0, 0.0, 0.1 + R + 2.0 * LAID), R, velocity=(0.3, 0.0, 0.0), angular_velocity=(0.0, 6.0, 0.0))
    world = World([slab(material="floor"), table, body], materials=on_ice("table", 1.0))
    for _ in range(round(rate)):
        assert world.frame(1.0 / rate) == 0
    angle = 2.0 / 7.0 * 2.0
    np.testing.assert_allclose(world.velocities.linear[2], [0.3 * cos(angle), 0.3 * sin(angle), 0.0], atol=3e-4)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize(("shape", "turn"), [(LOG, LYING), (Ellipsoid((R, R, 0.1)), LYING)])
def test_what_rolls_on_a_sledge_shares_its_momentum(rate: float, shape: Shape, turn: tuple[float, float, float, float]) -> None:
    """On ice, sledge of four times the mass: slip ends, momentum stays, and the log's part is m / (m + 1 / (1/M + r^2/I))."""
    sledge = thing("sledge", Box((2.0, 1.0, 0.1)), (0.0, 0.0, 0.05 + LAID), 4.0, material="sledge")
    body = thing("log", shape, (0.0, 0.0, 0.1 + R + 2.0 * LAID), orientation=turn, velocity=(1.0, 0.0, 0.0))
    world = World([slab(material="floor"), sledge, body], materials=on_ice("sledge", 0.3))
    run(world, 0.5, rate)
    k = float(world.dynamics.inertia[2][2, 2]) / R**2
    pushed = 1.0 / (1.0 + 1.0 / 4.0 + 1.0 / k)
    np.testing.assert_allclose(world.velocities.linear[2], [1.0 - pushed, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(world.velocities.linear[1], [pushed / 4.0, 0.0, 0.0], atol=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_an_egg_that_lands_and_rolls_costs_few_segments(seed: int) -> None:
    """Lifted from a dip of nanometres it is not leaving. Taken for that, it had an event every few microseconds, and spent the
    budget of two frames in three."""
    random = np.random.default_rng(seed)
    radii, turn = 0.1 * random.uniform(0.4, 1.0, 3), random.normal(size=4)
    egg = thing("egg", Ellipsoid(tuple(radii)), (0.0, 0.0, 0.3), orientation=tuple(turn / np.linalg.norm(turn)),
                velocity=(1.0, 0.5, 0.0), angular_velocity=tuple(4.0 * random.normal(size=3)))
    world = World([slab(), egg], 0.3, 0.4)
    segments, spent, energy = [], 0, world.energy()
    for _ in range(150):
        spent += world.frame() != 0
        segments.append(int(world.memory.counts[SEGMENTS]))
        assert world.energy() <= energy + 1e-12
        energy = world.energy()
        assert world.gap() > -5e-7
    assert np.median(segments) <= 15
    assert sum(segments) <= 3000
    assert spent <= 10


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
    """Return (spin [rad/s] after every frame, mean precession [rad/s], largest rise of energy in a frame as a part of it)."""
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
