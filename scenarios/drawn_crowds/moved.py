"""Drawn crowds that scenery moves: bodies on a lift or a turntable, or in the way of a bar, and a hand amid them."""

import math
from collections.abc import Callable

import numpy as np

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.moving import Pose, moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import rest
from avatarsim.spatial import rotation
from scenarios.building.cases import driven
from scenarios.building.things import disc
from scenarios.drawn_crowds.bodies import FLOOR, HAND, drawn_table, lattice, spacing
from scenarios.drawn_crowds.kinds import ABOVE, HAND_MASS, LASTS, Crowd, Drawn
from scenarios.motion.rigid_hands import about_z, eased, given

Poses = Callable[[float], dict[str, Pose]]
FIST = 0.05
"""Radius of the hand [m]."""
TOP, THICK, CORNERS = 0.15, 0.04, 24
"""Height of a platform at the start, its thickness [m], and corners of one that turns."""
RISES, TURNS, FORCES = (-0.1, 0.4), (-4.0, 4.0), (50.0, 2000.0)
"""Way of a lift [m], angular velocity of a table in the end [rad/s], and largest forces [N]."""
BAR, WIDE = 0.03, 1.4
"""Thickness of a bar [m], and the angle on either side of the middle through which it swings [rad]."""


def moved(draw: Drawn) -> Crowd:
    """Let a lift, a turntable or a bar in hinges move the bodies, and a hand that is to stand still."""
    random = draw.random
    kind, hole = int(random.integers(3)), FIST + float(random.uniform(0.02, 0.1))
    base = 0.0 if kind == 2 else TOP
    places = lattice(random, draw.radii, math.ceil(len(draw.pieces) / int(random.integers(1, 4))), hole)
    held = float(np.linalg.norm(np.array(places)[:, :2], axis=1).max()) + spacing(draw.radii)
    bodies = draw.bodies([(x, y, z + base) for x, y, z in places])
    force = float(np.exp(random.uniform(*np.log(FORCES))))
    scenery, poses = swings(random, held, force) if kind == 2 else carries(random, held, force, kind == 1)
    avatars = scenery, driven("hand", Sphere(FIST), HAND_MASS, HAND)
    start = rest(avatars)
    start.positions[1] = 0.0, 0.0, base + FIST + ABOVE
    if kind == 2:
        start.angles[0] = WIDE
    scene = Scene(draw.name, tuple(bodies), avatars, drawn_table(random), start=start)
    return Crowd(scene, given(poses), tuple(f"thing_{k}" for k in range(len(draw.pieces))) if kind == 2 else ())


def carries(random: np.random.Generator, held: float, force: float, turns: bool) -> tuple[Avatar, Poses]:
    """Return a platform below all bodies that goes up and down, or turns, at constant speed in the end."""
    middle = (0.0, 0.0, TOP - 0.5 * THICK)
    if turns:
        table = moving("table", (disc(CORNERS, 1.1 * held, THICK),), FLOOR, position=middle, largest_force=force)
        speed = float(random.uniform(*TURNS))
        return table, lambda time: {"table": (middle, about_z(speed * 0.5 * time * time / LASTS))}
    size, rise = Box((2.0 * held, 2.0 * held, THICK)), float(random.uniform(*RISES))
    lift = moving("lift", (Piece(size),), FLOOR, position=middle, largest_force=force)

    def raised(time: float) -> dict[str, Pose]:
        x, y, z = middle
        height = rise * (eased(time, 0.2, 0.5 * LASTS) - eased(time, 0.6 * LASTS, LASTS))
        return {"lift": ((x, y, z + height), rotation.IDENTITY)}

    return lift, raised


def swings(random: np.random.Generator, held: float, force: float) -> tuple[Avatar, Poses]:
    """Return a bar in hinges next to the bodies that sweeps over the floor through them, from one side to the other and back."""
    high, offset = float(random.uniform(0.05, 0.2)), 1.2 * held + BAR
    length = offset + held
    bar = Piece(Box((length, BAR, high)), (0.5 * length, 0.0, ABOVE + 0.5 * high))
    joint = Hinges((Hinge((0.0, 0.0, 1.0), -math.pi, math.pi),))
    swung = moving("bar", (bar,), FLOOR, position=(-offset, 0.0, 0.0), largest_force=force, joint=joint)

    def angle(time: float) -> dict[str, Pose]:
        share = eased(time, 0.1, 0.6 * LASTS) - eased(time, 0.7 * LASTS, LASTS)
        return {"bar": [WIDE - 2.0 * WIDE * share]}

    return swung, angle
