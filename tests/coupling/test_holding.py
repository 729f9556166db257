"""A hand that stands at a wall hits nothing, however fast the user goes on; what bodies hold is pushed as ever."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import nnls

from avatarsim.coupling.tracked_motion import project_velocities
from avatarsim.engine import Settings
from avatarsim.ik.state import make_contacts
from avatarsim.model.world import build
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Shape, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation

DT = 1.0 / 60.0
CUBE, COMING = 0.1, -0.1
"""Edge of what the hand is high and thick [m], and the velocity of a ball that comes its way [m/s]."""


def at(x: float, z: float = 0.0) -> TrackerSample:
    return TrackerSample(0.0, np.array([[x, 0.0, z]]), np.array([rotation.IDENTITY]), np.zeros(0))


def a_scene(hand: Shape, *bodies: Body, gravity: float = 0.0) -> Scene:
    """A hand at the origin among bodies of wood; ice is without friction, and hands throw balls back with half their speed."""
    pieces = (Piece(hand),)
    pairs = {("ice", "wood"): ContactLaw(0.0, 0.0), ("ice", "hand"): ContactLaw(0.0, 0.0), ("hand", "wood"): ContactLaw(0.5, 0.0)}
    return Scene(
        "held", bodies, (rigid_avatar("hand", pieces, solid(pieces, 0.5), "hand"),), materials=PairTable(pairs),
        gravity=(0.0, 0.0, -gravity), start=at(0.0),
    )


def ball(x: float, mass: float = 0.3, **more: tuple[float, float, float]) -> Body:
    pieces = (Piece(Sphere(0.04)),)
    return simulated("ball", pieces, "wood", solid(pieces, mass), (x, 0.0, 0.0), **more)


def post(y: float) -> Body:
    return fixed(f"post{y:+}", (Piece(Box((0.1, 0.1, 0.4))),), "ice", (0.2, y, 0.0))


def led(scene: Scene, speed: float, down: float = 0.0) -> NDArray[np.float64]:
    """Velocities along x (90) of the first body, while the user goes on and ``down`` [m] lower than the start."""
    engine, found = AvatarsimEngine(), []
    engine.load(scene, Settings(), DT)
    for k in range(1, 91):
        shown = engine.advance(at(speed * k * DT, -min(1.0, k / 10) * down), DT).shown
        found.append(shown.velocities[0, 0])
    engine.close()
    return np.array(found)


@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_a_ball_that_comes_to_a_held_hand_is_not_shot_away(speed: float) -> None:
    """Between two posts that hold the hand; by the user's velocity it left at 1.87 m/s where that was 2."""
    velocities = led(a_scene(Box((CUBE, 0.3, CUBE)), ball(0.25, velocity=(COMING, 0.0, 0.0)), post(-0.12), post(0.12)), speed)
    assert velocities[0] == COMING and COMING < velocities[-1]
    assert velocities.max() <= -0.5 * COMING


def test_a_hand_that_a_table_holds_pushes_along_it() -> None:
    """Its user presses 5 cm into the table: nothing of the way along it is lost."""
    table = fixed("table", (Piece(Box((6.0, 2.0, 0.2))),), "ice", (0.0, 0.0, -0.5 * CUBE - 0.101))
    velocities = led(a_scene(Box((CUBE, 0.3, CUBE)), ball(0.2), table), 0.5, down=0.05)
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
        into_both += np.linalg.norm(free[:2]) < 1e-9
        assert left[2] == v[2] and (normals[:2] @ left).min() > -1e-5
        if (normals[:2] @ v).min() >= 0.0 or np.linalg.norm(free[:2]) < 1e-9:
            np.testing.assert_allclose(left, free, atol=1e-5)
    assert 5 < into_both < 55
