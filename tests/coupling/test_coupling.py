"""The link that takes an impulse, the force with which a blocked one presses, and hands that walls hold."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import nnls

from avatarsim.coupling.tracked_motion import apply_to_roots, project_velocities, receive
from avatarsim.engine import Settings
from avatarsim.ik.state import make_contacts
from avatarsim.model.world import World, build
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import TABLE_1, Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Shape, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from tests.worlds.loaded import loaded

DT = 1.0 / 60.0
NO_GRAVITY = (0.0, 0.0, 0.0)
FINGER = (Piece(Box((0.1, 0.02, 0.02)), (0.05, 0.0, 0.0)),)
PALM = (Piece(Box((0.1, 0.08, 0.03)), (-0.06, 0.0, 0.0)),)


def pointing() -> Avatar:
    """Return a palm of 5 kg and a finger of 20 g along x, which bends down."""
    bend = Hinges((Hinge((0.0, 1.0, 0.0), -1.5, 1.5),))
    return Avatar("hand", (
        Link("palm", None, Free(), PALM, solid(PALM, 5.0)), Link("finger", "palm", bend, FINGER, solid(FINGER, 0.02)),
    ))


def block(mass: float, x: float, velocity: float = 0.0, role: str = "simulated") -> Body:
    """Return a cube of 0.2 m whose near face is at x."""
    pieces = (Piece(Box((0.2, 0.2, 0.2))),)
    at = (x + 0.1, 0.0, 0.0)
    if role == "fixed":
        return fixed("block", pieces, "wood", at)
    return simulated("block", pieces, "wood", solid(pieces, mass), at, velocity=(velocity, 0.0, 0.0))


def at(avatar: Avatar, x: float) -> TrackerSample:
    """Return the avatar's root at x, all joints at zero."""
    sample = rest((avatar,))
    positions = sample.positions.copy()
    positions[0, 0] = x
    return replace(sample, positions=positions)


def world() -> World:
    return build(Scene("point", (block(1.0, 0.5),), (pointing(),)))


@pytest.mark.nojit
def test_an_impulse_changes_its_own_link_only() -> None:
    w = world()
    received = np.zeros((3, 3))
    received[2], w.drive.linked[1:] = (-0.1, 0.0, 0.0), 1
    receive(w.skeleton, w.drive, received)
    np.testing.assert_allclose(w.drive.lag[1:], [[0.0, 0.0, 0.0], [-5.0, 0.0, 0.0]])
    assert w.drive.loaded.tolist() == [0, 0, 1]


@pytest.mark.nojit
def test_where_only_roots_have_springs_roots_hold_momentum() -> None:
    """0.1 N s are 2 cm/s of 5 kg, not 5 m/s."""
    w = world()
    received, rate = np.zeros((3, 3)), np.zeros((2, 3))
    received[2] = (-0.1, 0.0, 0.0)
    apply_to_roots(w.skeleton, received, w.dynamics.inverse_mass, rate)
    np.testing.assert_allclose(rate, [[-0.02, 0.0, 0.0], [0.0, 0.0, 0.0]])


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.parametrize("mass", [1.0, 1e6])
def test_a_finger_on_a_heavy_block_does_not_throw_its_hand(preset: str, mass: float) -> None:
    """The user goes 10 cm into it at 1 m/s; the hand is never farther than that from its user, and comes back too."""
    avatar = pointing()
    engine = loaded(Scene("point", (block(mass, 0.15),), (avatar,), gravity=NO_GRAVITY), preset)
    farthest, x = 0.0, 0.0
    for k in range(40):
        x = min(0.15, (k + 1) * DT) if k < 20 else 0.0
        record = engine.advance(at(avatar, x), DT)
        farthest = max(farthest, abs(record.shown.positions[1, 0] - x)) if k < 20 else farthest
    assert farthest < 0.11
    assert abs(record.shown.positions[1, 0]) < 0.01
    assert np.linalg.norm(record.shown.velocities[0]) < 2.5


def pressed_against(body: Body, *more: Body) -> np.ndarray:
    """Return the impulse on a hand of 0.5 kg that a user holds 5 cm inside a body, over half a second [N s]."""
    avatar = rigid_avatar("hand", (Piece(Box((0.04, 0.1, 0.1))),), solid(PALM, 0.5))
    engine = loaded(Scene("press", (body, *more), (avatar,), gravity=NO_GRAVITY))
    total = np.zeros(3)
    for k in range(90):
        engine.advance(at(avatar, min(0.13, 0.01 * k)), DT)
        if k >= 60:
            total += engine._running().upper.memory.received[-1]
    return total


def test_a_held_body_is_pressed_by_the_spring_and_a_wall_not() -> None:
    """5 cm and 1000 N/m are 50 N."""
    wall = fixed("wall", (Piece(Box((0.2, 2.0, 2.0))),), "wood", (0.4001, 0.0, 0.0))
    force = -pressed_against(block(2.0, 0.1), wall)[0] / 0.5
    assert force == pytest.approx(50.0, rel=0.01)
    bystander = replace(block(2.0, 5.0), name="bystander")
    assert not pressed_against(block(2.0, 0.1, role="fixed"), bystander).any()


@pytest.mark.parametrize("narrow", [(), ("coupling",)])
def test_a_hand_strikes_whether_or_not_it_is_struck_back(narrow: tuple[str, ...]) -> None:
    """Eqs 8 and 9: a hand of 2 kg at 1.5 m/s meets a block of 1 kg, wood on wood."""
    palm = rigid_avatar("palm", PALM, solid(PALM, 2.0), material="wood")
    scene = Scene("strike", (block(1.0, 0.1),), (palm,), gravity=NO_GRAVITY, narrow=narrow)
    engine = loaded(scene)
    struck = list[float]()
    for k in range(21):
        speed = float(engine.advance(at(palm, 1.5 * DT * k), DT).shown.velocities[0, 0])
        struck += [speed] if speed != 0.0 else []
    restitution = TABLE_1.contact("wood", "wood").restitution
    assert struck[0] == pytest.approx((1.0 + restitution) * 1.5 * 2.0 / 3.0, rel=1e-6)
    # the spring throws it after the user; without one the hand strikes again until the block is as fast as that
    assert struck[-1] == pytest.approx(1.5, rel=1e-4) if narrow else struck[-1] > 1.6


CUBE, COMING = 0.1, -0.1
"""Edge of the hand's height and thickness [m], and the velocity of a ball that comes its way [m/s]."""


def stood(x: float, z: float = 0.0) -> TrackerSample:
    return TrackerSample(0.0, np.array([[x, 0.0, z]]), np.array([rotation.IDENTITY]), np.zeros(0))


def a_scene(hand: Shape, *bodies: Body, gravity: float = 0.0) -> Scene:
    """A hand at the origin among bodies of wood; ice is without friction, and hands throw balls back with half their speed."""
    pieces = (Piece(hand),)
    pairs = {("ice", "wood"): ContactLaw(0.0, 0.0), ("ice", "hand"): ContactLaw(0.0, 0.0), ("hand", "wood"): ContactLaw(0.5, 0.0)}
    return Scene(
        "held", bodies, (rigid_avatar("hand", pieces, solid(pieces, 0.5), "hand"),), materials=PairTable(pairs),
        gravity=(0.0, 0.0, -gravity), start=stood(0.0),
    )


def ball(x: float, mass: float = 0.3, **more: Any) -> Body:
    pieces = (Piece(Sphere(0.04)),)
    return simulated("ball", pieces, "wood", solid(pieces, mass), (x, 0.0, 0.0), **more)


def post(y: float) -> Body:
    return fixed(f"post{y:+}", (Piece(Box((0.1, 0.1, 0.4))),), "ice", (0.2, y, 0.0))


def speeds(scene: Scene, speed: float, down: float = 0.0) -> NDArray[np.float64]:
    """Return velocities along x (90) of the first body, while the user goes on and ``down`` [m] lower than the start."""
    engine, found = AvatarsimEngine(), []
    engine.load(scene, Settings(), DT)
    for k in range(1, 91):
        shown = engine.advance(stood(speed * k * DT, -min(1.0, k / 10) * down), DT).shown
        found.append(shown.velocities[0, 0])
    engine.close()
    return np.array(found)


@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_a_ball_that_comes_to_a_held_hand_is_not_shot_away(speed: float) -> None:
    """Between two posts that hold the hand; by the user's velocity it left at 1.87 m/s where that was 2."""
    coming = ball(0.25, velocity=(COMING, 0.0, 0.0))
    velocities = speeds(a_scene(Box((CUBE, 0.3, CUBE)), coming, post(-0.12), post(0.12)), speed)
    assert velocities[0] == COMING and COMING < velocities[-1]
    assert velocities.max() <= -0.5 * COMING


def test_a_hand_that_a_table_holds_pushes_along_it() -> None:
    """Its user presses 5 cm into the table: nothing of the way along it is lost."""
    table = fixed("table", (Piece(Box((6.0, 2.0, 0.2))),), "ice", (0.0, 0.0, -0.5 * CUBE - 0.101))
    velocities = speeds(a_scene(Box((CUBE, 0.3, CUBE)), ball(0.2), table), 0.5, down=0.05)
    assert velocities[-1] > 0.5


@pytest.mark.nojit
def test_only_what_goes_into_fixed_bodies_is_taken() -> None:
    """By two walls of a corner of 60 degrees; not by a ball."""
    pieces = (Piece(Box((1.0, 1.0, 1.0))),)
    walls = [fixed(name, pieces, "ice", (x, 5.0, 0.0)) for name, x in (("a", 5.0), ("b", 7.0))]
    w = build(a_scene(Sphere(0.05), *walls, ball(-0.2)))
    contacts = make_contacts(8)
    hand, rng = w.skeleton.first, np.random.default_rng(5)
    normals = np.array([[-1.0, 0.0, 0.0], [0.5, -np.sqrt(0.75), 0.0], [0.0, 0.0, -1.0]])
    into_both = 0
    for v in rng.normal(size=(60, 3)):
        for k, other in enumerate((0, 1, 2)):
            contacts.pair[k], contacts.normal[k] = (w.geometry.first_shape[hand], w.geometry.first_shape[other]), normals[k]
        contacts.used[0] = 3
        w.velocities.linear[hand] = v
        project_velocities(w.geometry, w.dynamics, contacts, w.velocities)
        left = w.velocities.linear[hand]
        # the nearest velocity that goes into neither wall
        free = v + normals[:2].T @ nnls(normals[:2].T, -v)[0]
        into_both += int(np.linalg.norm(free[:2]) < 1e-9)
        assert left[2] == v[2] and (normals[:2] @ left).min() > -1e-5
        if (normals[:2] @ v).min() >= 0.0 or np.linalg.norm(free[:2]) < 1e-9:
            np.testing.assert_allclose(left, free, atol=1e-5)
    assert 5 < into_both < 55
