"""Bodies on a floor, one step per frame: setup and states of the tests of restitution and friction."""

from dataclasses import dataclass

import numpy as np

from avatarsim.engine import Engine, Settings
from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.scene import EARTH, Scene
from avatarsim.scene.shape import Box, Piece, Shape, Sphere
from avatarsim.spatial import rotation
from scenarios.building.cases import pair_table
from tests.agreement.runs import Array, idle, played

GRAVITY = -EARTH[2]
"""Gravitational acceleration [m/s^2]."""
BALL, BALL_MASS = Sphere(0.05), 0.2
"""Ball of 5 cm radius, mass [kg]."""
RATES = (60, 240, 1000, 4000)
"""Steps per second."""


@dataclass(frozen=True)
class Thrown:
    """One body: its shape, mass [kg], position [m], velocity [m/s] and contact law with the floor."""

    shape: Shape
    mass: float
    at: Vector
    velocity: Vector
    law: ContactLaw
    turn: Quaternion = rotation.IDENTITY


@dataclass(frozen=True)
class Seen:
    """States (F, n, 3) of n bodies: position of the centre [m], velocity [m/s], angular velocity [rad/s]."""

    places: Array
    velocities: Array
    spins: Array


def over_floor(name: str, thrown: list[Thrown], gravity: float = GRAVITY) -> Scene:
    """Return a floor with its top at z = 0 and bodies that do not meet. The scene has the settings of the one of that name."""
    laws = sorted({(one.law.restitution, one.law.friction) for one in thrown})
    material = {law: f"m{k}" for k, law in enumerate(laws)}
    bodies: list[Body] = [fixed("floor", (Piece(Box((60.0, 60.0, 0.4))),), "floor", (0.0, 0.0, -0.2))]
    for k, one in enumerate(thrown):
        pieces = (Piece(one.shape),)
        made_of = material[one.law.restitution, one.law.friction]
        bodies.append(simulated(
            f"b{k}", pieces, made_of, solid(pieces, one.mass), one.at, one.turn, velocity=one.velocity
        ))
    table = {("floor", made_of): ContactLaw(*law) for law, made_of in material.items()}
    return Scene(name, tuple(bodies), materials=pair_table(["floor", *material.values()], table), gravity=(0.0, 0.0, -gravity))


def seen(engine: Engine, scene: Scene, rate: int, seconds: float, preset: str = "tuned", /, **options: object) -> Seen:
    """Return the states of all bodies but the first, at the start and after every step."""
    step = 1.0 / rate
    records = played(engine, scene, idle(scene, round(seconds * rate), step), Settings(preset, {"dt": step, **options}), step)
    shown = [record.shown for record in records]
    return Seen(
        np.array([state.positions[1:] for state in shown]), np.array([state.velocities[1:] for state in shown]),
        np.array([state.angular_velocities[1:] for state in shown]),
    )
