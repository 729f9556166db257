"""Solver, warm start and islands of an engine: the results agree for each choice, apart from noise.

A hand of fifteen ellipsoids is pressed on a table and moved along it, against a ball: friction, many contacts, two islands.
"""

from dataclasses import replace
from functools import cache

import pytest

from avatarsim.engine import Settings
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from reference.in_mujoco.engine import MujocoEngine
from tests.agreement.rivals import PybulletEngine, needs_pybullet, pybullet
from tests.agreement.runs import FRAME, MM, depths
from tests.agreement.scenes import hand_over_table, pressed

RATE, FRAMES = 240, 75
EARLY: dict[str, object] = {"margin": 0.004}
"""Gap [m] at which contacts of the hand begin: at 1 mm every digit decides whether the hand meets the ball a second time."""
NOISE = 1e-3
"""Largest difference of the largest depth between two solvers [mm]."""


def scene() -> Scene:
    """Return a scene with one ball in the path of the hand, and a second one outside it."""
    ball = (Piece(Sphere(0.04)),)
    places = {"ball": (0.25, 0.0, 0.04), "other": (0.5, 0.3, 0.04)}
    balls = [simulated(name, ball, "wood", solid(ball, 0.2), place) for name, place in places.items()]
    table = hand_over_table()
    return replace(table, bodies=(*table.bodies, *balls))


def deepest(engine: MujocoEngine | PybulletEngine, options: dict[str, object], **engine_s_own: float) -> float:
    """Return the largest depth [m] of any two bodies in any frame."""
    world = scene()
    engine.load(world, Settings("tuned", {"dt": 1.0 / RATE, **options}), FRAME)
    if engine_s_own:
        pybullet.setPhysicsEngineParameter(physicsClientId=engine._client, **engine_s_own)
    records = [engine.advance(pressed(frame), FRAME) for frame in range(1, FRAMES + 1)]
    engine.close()
    assert records[-1].shown.positions[1, 0] > 0.26, "the hand pushes the ball"
    return float(depths(world, records).max())


@cache
def usual(name: str) -> float:
    return deepest(MujocoEngine(), EARLY) if name == "mujoco" else deepest(PybulletEngine(), {})


# conjugate gradients need more iterations than Newton: limited to 100 they stop before convergence on some processors
@pytest.mark.parametrize("options", [
    {"solver": "CG", "iterations": 400}, {"solver": "PGS"}, {"islands": False}, {"warm_starts": False}, {"iterations": 30},
    {"tolerance": 1e-12},
    {"noslip_iterations": 3},
], ids=str)
def test_mujoco_ends_as_deep_with_any_solver(options: dict[str, object]) -> None:
    assert abs(deepest(MujocoEngine(), EARLY | options) - usual("mujoco")) < NOISE * MM


@needs_pybullet
@pytest.mark.parametrize("parameters", [
    {"enableConeFriction": 0}, {"enableConeFriction": 1}, {"warmStartingFactor": 0.0}, {"numSolverIterations": 25},
    {"useSplitImpulse": 1},
], ids=str)
def test_pybullet_ends_as_deep_however_it_begins(parameters: dict[str, float]) -> None:
    assert abs(deepest(PybulletEngine(), {}, **parameters) - usual("pybullet")) < NOISE * MM
