"""Rigid hands under load: bodies on them lower them by m g / K, pressed bodies feel K times the lag, and no K shakes."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.coupling.equation_6 import coupled
from avatarsim.coupling.tracked_motion import TOP_SPEED
from avatarsim.engine import Settings
from avatarsim.errors import InvalidScene
from avatarsim.model.dynamics import make_drive, velocities
from avatarsim.rigid.driven import aim, bound_forces, note_lag
from avatarsim.scene.avatar import Drive, rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings, PostureSettings
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from scenarios import catalog
from tests.coupling.scenes import cube
from tests.rigid.upper_world import G, World, hand
from tests.worlds.loaded import loaded

DT = 1.0 / 60.0
PALM = (Piece(Box((0.2, 0.2, 0.02))),)
HELD = 0.3
"""Mass [kg] of the held body."""


def table(restitution: float) -> PairTable:
    """Return one contact law for all."""
    return PairTable({("m", "m"): ContactLaw(restitution, 0.6)})


def box(name: str, z: float, mass: float = HELD) -> Body:
    """Return a cube of 8 cm whose lower face is at z."""
    return cube(mass, (0.0, 0.0, z + 0.04), name, 0.08)


def carry(
    bodies: list[Body], place: Callable[[float], tuple[float, float, float]], seconds: float, restitution: float = 0.0,
    drive: Drive | None = None, **options: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Run a palm of 0.5 kg whose origin is at ``place`` of the time; returns positions (frames, nb, 3) and where its user was."""
    avatar = replace(rigid_avatar("palm", PALM, solid(PALM, 0.5), "m"), drive=drive)

    def sample(time: float) -> TrackerSample:
        return TrackerSample(time, np.array([place(time)]), np.array([[1.0, 0.0, 0.0, 0.0]]), np.zeros(0))

    scene = Scene("carry", tuple(bodies), (avatar,), materials=table(restitution), start=sample(0.0))
    engine, shown, users = AvatarsimEngine(), [], []
    engine.load(scene, Settings(options=options), DT)
    for k in range(round(seconds / DT)):
        user = sample((k + 1) * DT)
        shown.append(engine.advance(user, DT).shown.positions.copy())
        users.append(user.positions[0])
    return np.array(shown), np.array(users)


@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize("spring", [300.0, 1000.0, 1e6])
def test_a_load_lowers_a_hand_by_its_weight_over_the_spring(spring: float, restitution: float) -> None:
    shown, users = carry([box("box", 0.011)], lambda time: (0.0, 0.0, 0.0), 3.0, restitution, spring=spring)
    sag = users[-60:, 2] - shown[-60:, 1, 2]
    assert sag == pytest.approx(HELD * G / spring, rel=1e-3, abs=1e-7)


def test_an_avatar_has_its_own_drive() -> None:
    drive = Drive(stiffness=300.0, damping=20.0)
    shown, users = carry([box("box", 0.011)], lambda time: (0.0, 0.0, 0.0), 3.0, drive=drive, spring=5000.0)
    assert users[-1, 2] - shown[-1, 1, 2] == pytest.approx(HELD * G / 300.0, rel=1e-3)


@pytest.mark.parametrize("wrong", [{"stiffness": -1.0}, {"damping": -1.0}, {"largest_force": 0.0}, {"stiffness": float("nan")}])
def test_a_drive_that_cannot_be_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(InvalidScene, match="drive"):
        Drive(**wrong)


def test_a_hand_that_is_led_up_and_down_carries_what_lies_on_it() -> None:
    shown, users = carry([box("box", 0.011)], lambda time: (0.1 * np.sin(3.0 * time), 0.0, 0.1 * np.sin(5.0 * time)), 3.0)
    apart = (shown[:, 0] - shown[:, 1])[30:]
    assert np.ptp(apart, axis=0) == pytest.approx(0.0, abs=1e-4)
    # by m g / K and the force that accelerates the box, at most m a / K
    most = HELD * (G + 0.1 * 5.0**2) / CouplingSettings().spring
    assert abs(users - shown[:, 1])[30:].max() < 1.2 * most


def test_a_box_held_to_the_ceiling_falls_once_the_hand_goes() -> None:
    ceiling = fixed("ceiling", (Piece(Box((1.0, 1.0, 0.1))),), "m", (0.0, 0.0, 0.25))
    shown, _ = carry([box("box", 0.011), ceiling], lambda time: (0.0, 0.0, min(0.3 * time, 0.15) if time < 2.0 else -0.5), 2.4)
    pressed = shown[100:118, 0, 2]
    assert pressed == pytest.approx(0.16, abs=2e-4)
    assert np.ptp(pressed) < 1e-6
    assert shown[-1, 0, 2] < pressed[0] - 0.1


def test_where_nothing_leans_on_it_a_hand_is_at_its_user() -> None:
    shown, users = carry([box("box", -0.5)], lambda time: (0.2 * np.sin(9.0 * time), 0.0, 0.1 * time), 1.0)
    assert shown[:, 1] == pytest.approx(users, abs=1e-9)


def aimed(spring: float, damping: float, lag: float, rate: float, steps: int, seconds: float, force: float = np.inf) -> float:
    """Return the lag [m] of a body of 2 kg after so many implicit steps without contact."""
    world = World([], avatars=[hand()])
    drive = make_drive(world.scene, np.array([0.5]))
    drive.stiffness[:], drive.damping[:], drive.largest_force[:] = spring, damping, force
    drive.coupled[:] = 1
    drive.lag[0, 0], world.poses.position[0] = rate, (lag, 0.0, 0.0)
    masses, speed, h = world.dynamics._replace(drive=drive), velocities(world.scene), seconds / steps
    for _ in range(steps):
        for _ in range(2):
            aim(drive, world.poses, speed, world.memory, 0, 0.0, h, h)
            world.memory.linear_end[:], world.memory.angular_end[:] = speed.linear, speed.angular
            if not bound_forces(masses, world.poses, world.memory, np.array([0]), 0.0, h, h):
                break
        world.poses.position[0] += h * speed.linear[0]
        note_lag(masses, speed, np.array([0]))
    return float(world.poses.position[0, 0])


def test_implicit_steps_tend_to_equation_6() -> None:
    exact = coupled(2.0, 1000.0, 40.0, (0.01, 0.0, 0.0), (0.3, 0.0, 0.0), 0.1)[0][0]
    errors = [abs(aimed(1000.0, 40.0, 0.01, 0.3, steps, 0.1) - exact) for steps in (100, 1000, 10000)]
    assert errors[2] < 1e-6
    assert errors[1] == pytest.approx(errors[0] / 10.0, rel=0.1)


@pytest.mark.parametrize("spring", [1.0, 1e3, 1e6, 1e9])
def test_no_spring_makes_a_hand_unstable(spring: float) -> None:
    assert abs(aimed(spring, 0.0, 0.01, 0.0, 100, 1.0)) <= 0.0101


def test_the_spring_pulls_no_harder_than_the_largest_force() -> None:
    """2 kg pulled by 10 N without damping: half of 5 m/s^2 over 0.1 s."""
    assert aimed(1e6, 0.0, 1.0, 0.0, 1000, 0.1, 10.0) == pytest.approx(1.0 - 0.5 * 5.0 * 0.01, rel=1e-3)


def test_what_lies_on_a_turning_hand_stays_where_it_lies() -> None:
    """3 rad/s at 8 cm needs a friction of 0.07 of 0.6; straight steps would let it drift 20 mm outwards in 10 s."""
    avatar = rigid_avatar("palm", (Piece(Box((0.3, 0.3, 0.02))),), solid(PALM, 0.5), "m")
    shape = (Piece(Box((0.05, 0.05, 0.05))),)
    load = simulated("box", shape, "m", solid(shape, HELD), (0.08, 0.0, 0.0361))

    def sample(time: float) -> TrackerSample:
        angle = 0.75 * time**2 if time < 2.0 else 3.0 * time - 3.0
        turn = rotation.from_axis_angle((0.0, 0.0, 1.0), angle)
        return TrackerSample(time, np.zeros((1, 3)), turn[None], np.zeros(0))

    engine, places = AvatarsimEngine(), []
    engine.load(Scene("turn", (load,), (avatar,), materials=table(0.0), start=sample(0.0)), Settings(), DT)
    for k in range(600):
        shown = engine.advance(sample((k + 1) * DT), DT).shown
        places.append(rotation.to_matrix(shown.orientations[1]).T @ (shown.positions[0] - shown.positions[1]))
    assert np.ptp(places[30:], axis=0) == pytest.approx(0.0, abs=3e-4)


def test_a_tracker_that_jumps_throws_nothing_too_fast() -> None:
    most = TOP_SPEED + PostureSettings().catch_up_move
    shown, _ = carry([box("box", 0.011)], lambda time: (0.0, 0.0, 0.0 if time < 1.0 else 1e3), 1.5)
    speeds = np.linalg.norm(np.diff(shown[:, 0], axis=0), axis=1) / DT
    assert speeds.max() < 1.05 * most


def test_a_hand_goes_on_carrying_when_another_body_comes() -> None:
    avatar = rigid_avatar("palm", PALM, solid(PALM, 0.5), "m")
    sample = TrackerSample(0.0, np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0, 0.0]]), np.zeros(0))
    scene = Scene("carry", (box("box", 0.011),), (avatar,), materials=table(0.0), start=sample)
    engine = loaded(scene)
    for _ in range(120):
        before = engine.advance(sample, DT).shown.positions
    engine.change(Scene("carry", (box("box", 0.011), box("far", 3.0)), (avatar,), materials=table(0.0), start=sample))
    after = engine.advance(sample, DT).shown.positions
    assert after[0] == pytest.approx(before[0], abs=1e-6)
    assert after[2] == pytest.approx(before[1], abs=1e-6)


@pytest.mark.parametrize(("hold", "slips"), [(2, 2e-3), (3, 5e-3)])
def test_a_tracker_slower_than_the_frames_carries_too(hold: int, slips: float) -> None:
    """Its samples are held for so many frames, and each step is up to 22 mm long; at once, the box would be left behind."""
    def place(time: float) -> tuple[float, float, float]:
        held = hold * DT * int((time + 1e-9) / (hold * DT))
        share = float(np.clip((held - 0.5) / 1.0, 0.0, 1.0))
        return 0.3 * share * share * (3.0 - 2.0 * share), 0.0, 0.3 * share * share * (3.0 - 2.0 * share)

    shown, users = carry([box("box", 0.011)], place, 2.5)
    apart = shown[:, 0] - shown[:, 1]
    assert np.ptp(apart[20:], axis=0) == pytest.approx(0.0, abs=slips)
    assert shown[-1, 1, 2] == pytest.approx(users[-1, 2] - HELD * G / 1000.0, abs=1e-5)


@pytest.mark.parametrize("tilt", [0.2, 0.25])
def test_a_pinch_with_crooked_pads_launches_nothing(tilt: float) -> None:
    pad = (Piece(Box((0.02, 0.06, 0.06))),)
    pads = tuple(rigid_avatar(name, pad, solid(pad, mass), "m") for name, mass in (("right", 2.1), ("left", 0.2)))
    floor = fixed("floor", (Piece(Box((2.0, 2.0, 0.1))),), "m", (0.0, 0.0, -0.05))

    def sample(time: float) -> TrackerSample:
        x = max(0.3 - 0.85 * time, 0.03)
        turns = [rotation.from_axis_angle((0.0, 0.0, 1.0), angle) for angle in (tilt, -0.9 * tilt)]
        return TrackerSample(time, np.array([(x, 0.02, 0.05), (-x, 0.02, 0.05)]), np.array(turns), np.zeros(0))

    engine = loaded(Scene("pinch", (floor, box("box", 2e-7)), pads, materials=table(0.0), start=sample(0.0)))
    for k in range(90):
        assert np.linalg.norm(engine.advance(sample((k + 1) * DT), DT).shown.velocities, axis=1).max() < 10.0


@pytest.mark.parametrize("seed", range(4))
def test_noise_of_a_tracker_does_not_shake_a_box_out_of_a_pinch(seed: int) -> None:
    """White noise of 0.5 mm a sample, as of a headset's tracker: the inertia of the hands resists it, and springs yield to it."""
    scenario = catalog.get(("pinch_light", "pinch_heavy")[seed % 2])
    scene, random, engine, seen = scenario.build(), np.random.default_rng(seed), AvatarsimEngine(), []
    motion = scenario.motion(scene, 0)
    engine.load(scene, Settings(), DT)
    for frame in range(165):
        sample = motion(frame)
        shaken = replace(sample, positions=sample.positions + 5e-4 * random.normal(size=(2, 3)))
        shown = engine.advance(shaken, DT).shown.positions
        seen.append(shown[1] - shown[2:].mean(axis=0))
    held = np.array(seen[50:])
    assert np.linalg.norm(held - held[0], axis=1).max() < 5e-4


@pytest.mark.parametrize("stacked", [1, 2])
def test_what_is_pushed_over_seams_goes_as_over_one_plate(stacked: int) -> None:
    """A floor of twenty flush tiles: no edge between them stops, tilts or lifts a box."""
    def pushed(tiles: int) -> np.ndarray:
        wide = 2.0 / tiles
        floor = fixed("floor", tuple(
            Piece(Box((wide, 2.0, 0.2)), (-0.5 + wide * (k + 0.5), 0.0, -0.1)) for k in range(tiles)
        ), "m")
        boxes = [box(f"box {k}", 1e-4 + k * 0.0801, 0.5) for k in range(stacked)]
        shown, _ = carry([floor, *boxes], lambda t: (-0.15 + 0.4 * t, 0.0, 0.03), 2.0)
        return shown[:, 1:]

    apart = np.abs(pushed(20) - pushed(1))
    assert apart[..., 2].max() < 5e-5 and apart.max() < 1e-4
