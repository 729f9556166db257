"""The whole engine: thin walls stop whatever flies at them, at the instant at which the surfaces meet.

Truths are closed forms, or the exact motion sampled densely and bisected in extended precision; nothing here knows the engine.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from avatarsim.engine import Snapshot
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Shape, Sphere
from tests.worlds.loaded import DT as FRAME
from tests.worlds.loaded import loaded

SPEEDS = (2.0, 5.0, 10.0, 30.0, 100.0, 300.0, 1000.0)
PHASES = 8
RADIUS, THICK = 0.01, 0.01
CLOSE_ENOUGH = 1e-9
"""Accuracy of contact times [s] that is promised."""
MOST_FRAMES = 7
"""Frames within which every flight below ends; one is run beyond the impact."""

Long = np.longdouble


def flier(shape: Shape, x: float, speed: float, **more: Any) -> Body:
    """Return a body of 1 kg at (x, 0, 0) that flies towards -x."""
    pieces = (Piece(shape),)
    return simulated("flier", pieces, "m", solid(pieces, 1.0), position=(x, 0.0, 0.0), velocity=(-speed, 0.0, 0.0), **more)


def first_impact(body: Body, gravity: tuple[float, float, float]) -> tuple[Snapshot, Snapshot, list[Snapshot]]:
    """Return (approach, impact, all that was shown) of the body at a wall of THICK across x = 0, by the engine alone."""
    wall = fixed("wall", (Piece(Box((THICK, 20.0, 20.0))),), "m")
    scene = Scene("test", (wall, body), materials=PairTable({("m", "m"): ContactLaw(0.5, 0.0)}), gravity=gravity)
    engine = loaded(scene, record_inside=True)
    met, shown = list[Snapshot](), list[Snapshot]()
    for _ in range(MOST_FRAMES):
        done = bool(met)
        record = engine.advance(scene.first_sample, FRAME)
        assert not record.statuses
        met += [snapshot for snapshot in record.inside if snapshot.event != "step"]
        shown += [*record.inside, record.shown]
        if done:
            break
    engine.close()
    assert [snapshot.event for snapshot in met[:2]] == ["approach", "impact"], "it was not stopped"
    assert met[0].time == met[1].time
    assert met[0].bodies == met[1].bodies == scene.names and not shown[-1].bodies
    return met[0], met[1], shown


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (0.0, 0.0, -9.81), (-9.81, 0.0, 0.0), (9.81, 0.0, 0.0)])
@pytest.mark.parametrize("speed", SPEEDS)
def test_a_ball_is_stopped_at_the_exact_time(speed: float, gravity: tuple[float, float, float]) -> None:
    """(x - r - t/2) / v, or the root of the parabola where gravity acts along the way, in phases all over the frame."""
    for phase in range(PHASES):
        x = RADIUS + 0.5 * THICK + speed * FRAME * (1.0 + phase / PHASES)
        way = Long(x) - Long(RADIUS) - Long(THICK) / 2
        pull = Long(gravity[0])
        # way - v t + a t^2 / 2 = 0
        expected = 2 * way / (Long(speed) + np.sqrt(Long(speed) ** 2 - 2 * pull * way))
        approach, impact, shown = first_impact(flier(Sphere(RADIUS), x, speed), gravity)
        assert abs(approach.time - expected) <= CLOSE_ENOUGH
        assert impact.velocities[1, 0] == pytest.approx(-0.5 * approach.velocities[1, 0], rel=1e-12)
        assert all(snapshot.positions[1, 0] - RADIUS - 0.5 * THICK > 0.0 for snapshot in shown)


def first_root(gap: Callable[[np.ndarray], np.ndarray], end: float, samples: int = 20_001) -> Long:
    """Return the first t in [0, end] with gap(t) <= 0: by brute force, in extended precision."""
    t = np.linspace(Long(0), Long(end), samples)
    below = np.flatnonzero(gap(t) <= 0)
    assert len(below) and below[0] > 0
    low, high = t[below[0] - 1], t[below[0]]
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (low, middle) if gap(np.array([middle]))[0] <= 0 else (middle, high)
    return high


ROD = 0.2
"""Length [m] of the rods' axis."""


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (0.0, 0.0, -9.81)])
@pytest.mark.parametrize("thin_box", [False, True])
@pytest.mark.parametrize("speed", SPEEDS)
def test_a_tumbling_rod_is_stopped_at_the_exact_time(speed: float, thin_box: bool, gravity: tuple[float, float, float]) -> None:
    """Spinning about a transverse axis while it flies: its extent towards the wall is a cosine, known in closed form."""
    rng = np.random.default_rng(int(speed))
    for phase in range(PHASES):
        spin, angle = float(rng.uniform(-1.0, 1.0) * rng.choice([3.0, 30.0, 300.0])), float(rng.uniform(-np.pi, np.pi))
        x = 0.5 * ROD + 2.0 * RADIUS + speed * FRAME * (1.0 + phase / PHASES)
        # the shape's long axis is z; it turns about y
        turn = (np.cos(0.5 * angle), 0.0, np.sin(0.5 * angle), 0.0)
        half = np.arctan2(Long(turn[2]), Long(turn[0]))
        shape: Shape = Box((RADIUS, 0.02, ROD)) if thin_box else Capsule(0.5 * RADIUS, ROD)

        def gap(t: np.ndarray, x: float = x, half: Long = half, spin: float = spin) -> np.ndarray:
            now = 2 * half + Long(spin) * t
            along, across = abs(np.sin(now)) * Long(ROD) / 2, Long(RADIUS) / 2
            extent = along + across * abs(np.cos(now)) if thin_box else along + across
            return np.asarray(Long(x) - Long(speed) * t - extent - Long(THICK) / 2)

        expected = first_root(gap, MOST_FRAMES * FRAME)
        body = flier(shape, x, speed, orientation=turn, angular_velocity=(0.0, spin, 0.0))
        approach, impact, shown = first_impact(body, gravity)
        assert abs(approach.time - expected) <= CLOSE_ENOUGH, (phase, spin, angle, float(approach.time - expected))
        assert impact.velocities[1, 0] > approach.velocities[1, 0]
        assert all(snapshot.positions[1, 0] > 0.5 * THICK for snapshot in shown)
