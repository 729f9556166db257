"""Drawn crowds that scenery moves: bodies on a lift or a turntable, or in the way of a bar, and a hand amid them."""

import math

import numpy as np

from avatarsim.scene.avatar import Avatar, rigid_avatar
from avatarsim.scene.body import solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.moving import Pose, moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, ConvexHull, Piece, Sphere
from avatarsim.scene.tracker import rest
from avatarsim.spatial import rotation
from scenarios.drawn_crowds.bodies import FLOOR, HAND, drawn_table, lattice, spacing
from scenarios.drawn_crowds.kinds import ABOVE, HAND_MASS, LASTS, Crowd, Drawn
from scenarios.motion.moving_bodies import about_z, given
from scenarios.motion.rigid_hands import eased

FIST = 0.05
"""Radius of the hand [m]."""
TOP, THICK, CORNERS = 0.15, 0.04, 24
"""Height of a platform at the start, its thickness [m], and corners of one that turns."""
RISES, TURNS, FORCES = (-0.1, 0.4), (-4.0, 4.0), (50.0, 2000.0)
"""How far a lift goes [m], how fast a table turns in the end [rad/s], and largest forces [N]."""
BAR, WIDE = 0.03, 1.4
"""Thickness of a bar [m], and the angle on either side of the middle through which it swings [rad]."""


def moved(drawn: Drawn) -> Crowd:
    """Let a lift, a turntable or a bar in hinges move the bodies, and a hand that is to stand still."""
    random = drawn.random
    kind, hole = int(random.integers(3)), FIST + float(random.uniform(0.02, 0.1))
    base = 0.0 if kind == 2 else TOP
    places = lattice(random, drawn.radii, math.ceil(len(drawn.pieces) / int(random.integers(1, 4))), hole)
    held = float(np.linalg.norm(np.array(places)[:, :2], axis=1).max()) + spacing(drawn.radii)
    bodies = drawn.bodies([(x, y, z + base) for x, y, z in places])
    force = float(np.exp(random.uniform(*np.log(FORCES))))
    scenery, poses = swings(random, held, force) if kind == 2 else carries(random, held, force, kind == 1)
    ball = (Piece(Sphere(FIST)),)
    avatars = scenery, rigid_avatar("hand", ball, solid(ball, HAND_MASS), HAND)
    start = rest(avatars)
    start.positions[1] = 0.0, 0.0, base + FIST + ABOVE
    if kind == 2:
        start.angles[0] = WIDE
    scene = Scene(drawn.name, tuple(bodies), avatars, drawn_table(random), start=start)
    return Crowd(scene, given(poses), tuple(f"thing_{k}" for k in range(len(drawn.pieces))) if kind == 2 else ())


class Poses:
    """Pose of one moving body by time: a height from rest to rest, and an angle that ends at constant speed."""

    def __init__(self, name: str, place: Vector, rise: float, speed: float) -> None:
        self.name, self.place, self.rise, self.speed = name, place, rise, speed

    def __call__(self, time: float) -> dict[str, Pose]:
        x, y, z = self.place
        height = self.rise * (eased(time, 0.2, 0.5 * LASTS) - eased(time, 0.6 * LASTS, LASTS))
        angle = self.speed * 0.5 * time * time / LASTS
        return {self.name: ((x, y, z + height), about_z(angle) if self.speed else rotation.IDENTITY)}


def carries(random: np.random.Generator, held: float, force: float, turns: bool) -> tuple[Avatar, Poses]:
    """Return a platform below all bodies that goes up and down, or turns."""
    middle = (0.0, 0.0, TOP - 0.5 * THICK)
    if not turns:
        lift = moving("lift", (Piece(Box((2.0 * held, 2.0 * held, THICK))),), FLOOR, position=middle, largest_force=force)
        return lift, Poses("lift", middle, float(random.uniform(*RISES)), 0.0)
    around = np.linspace(0.0, 2.0 * np.pi, CORNERS, endpoint=False)
    rim = [(1.1 * held * np.cos(a), 1.1 * held * np.sin(a), z) for a in around for z in (-0.5 * THICK, 0.5 * THICK)]
    table = moving("table", (Piece(ConvexHull(np.array(rim))),), FLOOR, position=middle, largest_force=force)
    return table, Poses("table", middle, 0.0, float(random.uniform(*TURNS)))


class Swing:
    """Angle of a bar by time: from one side to the other and back."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __call__(self, time: float) -> dict[str, Pose]:
        share = eased(time, 0.1, 0.6 * LASTS) - eased(time, 0.7 * LASTS, LASTS)
        return {self.name: [WIDE - 2.0 * WIDE * share]}


def swings(random: np.random.Generator, held: float, force: float) -> tuple[Avatar, Swing]:
    """Return a bar in hinges beside the bodies that sweeps over the floor through them."""
    high, beside = float(random.uniform(0.05, 0.2)), 1.2 * held + BAR
    length = beside + held
    bar = Piece(Box((length, BAR, high)), (0.5 * length, 0.0, ABOVE + 0.5 * high))
    joint = Hinges((Hinge((0.0, 0.0, 1.0), -math.pi, math.pi),))
    return moving("bar", (bar,), FLOOR, position=(-beside, 0.0, 0.0), largest_force=force, joint=joint), Swing("bar")
