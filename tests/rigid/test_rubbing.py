"""Driven contact velocity: of a hand that is blocked, as it is shown to move; of one that goes freely, as its user moves."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from avatarsim.engine import Settings
from avatarsim.rigid.contact_generation import SEEN, note_drift, note_shown
from avatarsim.rigid.contacts import (
    DRIVEN_A,
    DRIVEN_B,
    Masses,
    add_contact,
    axis,
    make_contacts,
    speed_along,
    velocity_at,
    weigh,
)
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.joint import Free, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from tests.rigid.upper_world import World, ball, hand

DT = 1.0 / 60.0
PRESSED, REST, ON_TOP, ABOVE = 0.5, 0.16, 0.15, 0.35
"""Time for which the hand goes down onto the plank [s], from which height [m], where it stops, and how far above the wrist is."""


def at(x: float, z: float) -> TrackerSample:
    return TrackerSample(0.0, np.array([[x, 0.0, z + ABOVE]] * 2), np.array([rotation.IDENTITY] * 2), np.zeros(0))


def pressed_and_led(speed: float, walled: bool) -> NDArray[np.float64]:
    """Return places and velocities along x (frames, 2, 2) of a plank on ice and of a hand that presses on it 3 cm deep and then
    is led along it for 1.5 s, if ``walled`` with its wrist into a wall 5 mm ahead."""
    cube, plate, plank = ((Piece(Box(size)),) for size in ((0.1, 0.1, 0.1), (0.1, 0.6, 0.4), (0.6, 0.3, 0.1)))
    arm = Avatar("arm", (
        Link("wrist", None, Free(), plate, solid(plate, 0.5), "hand"),
        Link("hand", "wrist", Rigid(), cube, solid(cube, 0.5), "hand", (0.0, 0.0, -ABOVE)),
    ))
    slippery, rough = ContactLaw(0.0, 0.0), ContactLaw(0.0, 0.5)
    pairs = {("ice", "wood"): slippery, ("ice", "hand"): slippery, ("hand", "wood"): rough}
    walls = (fixed("wall", (Piece(Box((0.2, 1.0, 0.4))),), "ice", (0.155, 0.0, REST + ABOVE)),) if walled else ()
    scene = Scene("rub", (
        fixed("floor", (Piece(Box((6.0, 6.0, 0.2))),), "ice", (0.0, 0.0, -0.1)),
        simulated("plank", plank, "wood", solid(plank, 2.0), (0.0, 0.0, 0.0501)), *walls,
    ), (arm,), materials=PairTable(pairs), start=at(0.0, REST))
    engine, found = AvatarsimEngine(), []
    engine.load(scene, Settings(), DT)
    for k in range(1, 121):
        down, led = min(1.0, k * DT / PRESSED), max(0.0, k * DT - PRESSED)
        shown = engine.advance(at(speed * led, REST - down * (REST - ON_TOP + 0.03)), DT).shown
        found.append([[s[1, 0], s[-1, 0]] for s in (shown.positions, shown.velocities)])
    engine.close()
    return np.array(found)


@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_a_hand_that_a_wall_holds_is_no_conveyor(speed: float) -> None:
    """By its user's velocity the plank went 0.7 and 2 m beneath a hand that moved 2 cm; it may follow the hand's own motion."""
    places = pressed_and_led(speed, walled=True)[:, 0]
    assert np.abs(places[:, 1]).max() < 0.025
    # on ice it keeps the speed of the hand's last centimetre
    assert np.abs(places[:, 0]).max() < 0.07


@pytest.mark.parametrize("speed", [0.2, 0.5])
def test_a_hand_that_goes_freely_takes_along_what_it_presses_on(speed: float) -> None:
    velocities = pressed_and_led(speed, walled=False)[:, 1]
    assert velocities[-30:, 0] == pytest.approx(speed, rel=0.01)


@pytest.mark.nojit
@pytest.mark.parametrize("driven", [DRIVEN_A, DRIVEN_B])
def test_along_the_tangents_the_slower_of_both_counts(driven: int) -> None:
    """Against the plain sum: the simulated body's motion at the contact, less the motion shown or meant of the driven one."""
    world = World([ball("b", (0.0, 0.0, 5.0))], avatars=(hand(),))
    rng, b, held = np.random.default_rng(driven), 1, 0
    side = 0 if driven == DRIVEN_A else 1
    for _ in range(60):
        contacts = make_contacts(4, bodies=2)
        n, arms = rng.normal(size=3), rng.normal(size=(2, 3))
        n /= np.linalg.norm(n)
        pair = (b, 0) if side == 0 else (0, b)
        add_contact(contacts, *pair, driven, tuple(n), tuple(arms[0]), tuple(arms[1]), 0.0)
        memory = world.memory._replace(contacts=contacts)
        world.velocities.linear[:], world.velocities.angular[:] = rng.normal(size=(2, 2, 3))
        memory.shown_linear[b], memory.shown_angular[b] = rng.uniform(0.0, 2.0) * rng.normal(size=(2, 3))
        note_drift(world.velocities, memory, 0)
        point = [v + np.cross(w, arms[i]) for i, v, w in (
            (1 - side, world.velocities.linear[0], world.velocities.angular[0]),
            (side, world.velocities.linear[b], world.velocities.angular[b]),
            (side, memory.shown_linear[b], memory.shown_angular[b]),
        )]
        across = [v - n * (n @ v) for v in point]
        up = np.linalg.norm(across[2]) + SEEN < np.linalg.norm(across[1])
        held += up
        seen = n * (n @ point[1]) + across[2 if up else 1]
        wanted = (seen - point[0]) if side == 0 else (point[0] - seen)
        found = velocity_at(contacts, 0, world.velocities.linear, world.velocities.angular)
        np.testing.assert_allclose(found, wanted, atol=1e-12)
        weigh(contacts, Masses(np.ones(2), np.tile(np.eye(3), (2, 1, 1))))
        parts = [speed_along(contacts, 0, i, world.velocities.linear, world.velocities.angular) for i in range(3)]
        np.testing.assert_allclose(parts, [np.dot(axis(contacts, 0, i), wanted) for i in range(3)], atol=1e-12)
    assert 10 < held < 50


def test_what_is_shown_is_the_way_from_one_frame_to_the_next() -> None:
    world = World([ball("b", (0.0, 0.0, 5.0))], avatars=(hand(),))
    rng, b = np.random.default_rng(3), 1
    for _ in range(10):
        first, turn, way = Rotation.random(random_state=rng), Rotation.from_rotvec(rng.normal(size=3)), rng.normal(size=3)
        world.memory.trial.position[b], world.memory.trial.rotation[b] = 0.5, first.as_matrix()
        world.poses.position[b], world.poses.rotation[b] = 0.5 + way * DT, (turn * first).as_matrix()
        note_shown(world.poses, DT, world.memory, b)
        np.testing.assert_allclose(world.memory.shown_linear[b], way, rtol=1e-10)
        np.testing.assert_allclose(world.memory.shown_angular[b] * DT, turn.as_rotvec(), rtol=1e-9, atol=1e-12)
