"""Scenes that test a coefficient: bodies of one shape over a floor, each of a material of its own.

A module of scenarios by name, as the catalogue is: `restitution_sphere_240` drops spheres at 240 steps per second, each
coefficient from several heights within one coarse step, so that impacts come at different parts of a step.
`friction_box_flat_1000` throws flat boxes along the floor without gravity, along an axis and across it.
"""

from functools import cache, partial
from math import cos, radians, sin, sqrt

import numpy as np

from avatarsim.errors import UnknownName
from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Quaternion
from avatarsim.scene.scene import EARTH, Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.spatial import rotation
from scenarios.building.cases import NOWHERE, pair_table, turned_by
from scenarios.motion.untracked import untracked
from scenarios.scenario import Scenario

LAWS = ("restitution", "friction")
SHAPES = ("sphere", "box_flat", "box_corner", "capsule")
"""One contact, four, one with a corner and the centre above it, two."""
RATES = (60, 240, 1000, 4000)
"""Steps per second; an engine of fixed steps is set to take one per frame."""
ASKED = {"restitution": (0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 0.9, 1.0), "friction": (0.0, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0)}
PHASES = 4
"""Bodies per coefficient."""
SPEED, HEIGHT = 3.96, 0.2
"""First speed downwards [m/s] and gap [m]: they arrive at 4.43 m/s, as from one metre."""
SPREAD = 4.43 / 60.0
"""Way [m] of a step of 1/60 s at the impact: heights are spread over it."""
DOWN, ALONG = 2.0, 25.0
"""Of sliding bodies [m/s]. So fast along the floor that no contact stops sliding: a corner may lose 16 m/s of its slip."""
BOUNCE = 0.5
"""Restitution of sliding bodies: they leave the floor again."""
GAP = 0.1
"""Smallest first gap of sliding bodies [m]: three coarse steps of free flight, which show the drag there is."""
DIRECTIONS = (0.0, 45.0)
"""Of sliding bodies [deg]: a friction pyramid shows in the second."""
SECONDS = {"restitution": 0.3, "friction": 0.2}
"""Length of a run: long enough for contacts that take 50 ms."""
MASS = 1.0
"""[kg]"""
CUBE, PLATE, RADIUS = 0.1, (0.4, 0.4, 0.1), 0.05
"""Edge of a cube [m]; edges of a sliding box, so flat that friction hardly tumbles it; radius of spheres and capsules."""
APART = 1.0
"""Distance between two bodies [m]."""


def name_of(law: str, shape: str, rate: int) -> str:
    """Return the name of a scene."""
    return f"{law}_{shape}_{rate}"


def parts_of(name: str) -> tuple[str, str, int]:
    """Return law, shape and steps per second of a scene."""
    law, rest = name.split("_", 1)
    shape, rate = rest.rsplit("_", 1)
    return law, shape, int(rate)


def body_name(stated: float, phase: int) -> str:
    """Return the name of one body."""
    return f"{stated:g}_{phase}"


def solid_of(law: str, shape: str) -> tuple[tuple[Piece, ...], Quaternion, float]:
    """Return pieces, orientation, and the height [m] of the centre when it touches the floor."""
    if shape == "sphere":
        return (Piece(Sphere(RADIUS)),), rotation_of((1.0, 0.0, 0.0), 0.0), RADIUS
    if shape == "capsule":
        # its axis along x; where it slides it is turned into its direction, or it would roll and slip another way
        return (Piece(Capsule(RADIUS, 0.2)),), rotation_of((0.0, 1.0, 0.0), 90.0), RADIUS
    if shape == "box_corner":
        w, x, y, z = rotation.between(np.full(3, 1.0 / sqrt(3.0)), (0.0, 0.0, 1.0)).tolist()
        return (Piece(Box((CUBE,) * 3)),), (w, x, y, z), 0.5 * sqrt(3.0) * CUBE
    size = PLATE if law == "friction" else (CUBE,) * 3
    return (Piece(Box(size)),), rotation_of((1.0, 0.0, 0.0), 0.0), 0.5 * size[2]


def rotation_of(axis: tuple[float, float, float], angle: float) -> Quaternion:
    """Return the turn by `angle` [deg]."""
    return turned_by(axis, radians(angle))


def contact(law: str, stated: float) -> ContactLaw:
    """Return the stated law of a body and the floor."""
    return ContactLaw(stated, 0.0) if law == "restitution" else ContactLaw(BOUNCE, stated)


def build(law: str, shape: str) -> Scene:
    """Return PHASES bodies for each coefficient, on lanes that do not meet."""
    bodies: list[Body] = [fixed("floor", (Piece(Box((140.0, 140.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    pieces, turn, touch = solid_of(law, shape)
    for k, value in enumerate(ASKED[law]):
        for phase in range(PHASES):
            if law == "restitution":
                at = (APART * k, APART * phase, touch + HEIGHT + SPREAD * phase / PHASES)
                velocity, turned = (0.0, 0.0, -SPEED), rotation_of((0.0, 0.0, 1.0), 0.0)
            else:
                # one block of lanes per direction, far enough apart that no body crosses the other's
                way = len(DIRECTIONS) * phase // PHASES
                angle = radians(DIRECTIONS[way])
                lane = APART * (PHASES * k + phase)
                at = (-60.0 + 40.0 * way, lane - 30.0, touch + GAP + DOWN / 60.0 * phase / PHASES)
                velocity = (ALONG * cos(angle), ALONG * sin(angle), -DOWN)
                turned = rotation_of((0.0, 0.0, 1.0), DIRECTIONS[way])
            w, x, y, z = rotation.multiply(turned, turn).tolist()
            mass, name = solid(pieces, MASS), body_name(value, phase)
            bodies.append(simulated(name, pieces, f"c_{value:g}", mass, at, (w, x, y, z), velocity=velocity))
    stated = {("floor", f"c_{value:g}"): contact(law, value) for value in ASKED[law]}
    materials = pair_table(["floor", *(f"c_{value:g}" for value in ASKED[law])], stated)
    gravity = EARTH if law == "restitution" else NOWHERE
    return Scene(f"{law}_{shape}", tuple(bodies), materials=materials, gravity=gravity)


@cache
def get(name: str) -> Scenario:
    """Return the scenario of that name; UnknownName lists those that exist."""
    known = {name_of(law, shape, rate): (law, shape, rate) for law in LAWS for shape in SHAPES for rate in RATES}
    if name not in known:
        raise UnknownName("scene of the map", name, known)
    law, shape, rate = known[name]
    return Scenario(
        name, f"{law} of {shape}, {rate} steps per second.", f"The {law} that was obtained.", partial(build, law, shape),
        untracked(1.0 / rate), round(SECONDS[law] * rate), dt=1.0 / rate,
    )
