"""Piles of everything that can fall: round, smooth and sharp, a gram next to a ton, at any frame time. Nothing overlaps, no frame
gains energy, and all numbers are numbers."""

import numpy as np
import pytest

from avatarsim.rigid.state import UNSQUEEZED
from avatarsim.scene.body import Body
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Shape, Sphere, ellipsoid_hull
from tests.rigid.upper_world import G, World, slab, thing

SIZE, PITCH = 0.1, 0.36
"""Half the size of a body, and how far their middles are from one another at the start [m]."""
SECONDS, MOST = 1.5, 100
"""Simulated time, but no more frames than that."""
LIFT = 1e-6
"""Height [m] by which a correction of positions may raise a body: the overlap that may be shown."""


def prism(corners: int, top: float) -> ConvexHull:
    """Return a regular prism, its upper face smaller by the factor ``top``: a cylinder, or nearly a cone."""
    angle = 2.0 * np.pi * np.arange(corners) / corners
    ring = 0.7 * SIZE * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    below, above = np.full((corners, 1), -0.6 * SIZE), np.full((corners, 1), 0.6 * SIZE)
    return ConvexHull(np.concatenate([np.hstack([ring, below]), np.hstack([top * ring, above])]))


def shape_of(random: np.random.Generator) -> Shape:
    """Return one of seven kinds."""
    a, b, c = SIZE * random.uniform(0.4, 1.0, 3)
    return (
        Sphere(a), Capsule(0.5 * a, b), Box((2.0 * a, 2.0 * b, 2.0 * c)), Ellipsoid((a, b, c)), ellipsoid_hull((a, b, c), 20),
        prism(16, 1.0), prism(12, 0.05),
    )[random.integers(7)]


def pile(seed: int, bodies: int, masses: tuple[float, float]) -> list[Body]:
    """Return bodies over a slab, turned and thrown; their masses even in the logarithm."""
    random, found = np.random.default_rng(seed), [slab()]
    side = int(np.ceil(bodies ** (1.0 / 3.0)))
    for k in range(bodies):
        at = PITCH * np.array([k % side, k // side % side, k // side**2]) + (0.0, 0.0, 0.4)
        turn, mass = random.normal(size=4), float(np.exp(random.uniform(*np.log(masses))))
        found.append(thing(
            f"body_{k}", shape_of(random), tuple(at), mass, orientation=tuple(turn / np.linalg.norm(turn)),
            velocity=tuple(2.0 * random.normal(size=3)), angular_velocity=tuple(4.0 * random.normal(size=3)),
        ))
    return found


@pytest.mark.parametrize("masses", [(1.0, 1.0), (1e-3, 1e4)])
@pytest.mark.parametrize("dt", [1e-3, 1.0 / 60.0, 0.12])
def test_piles_gain_nothing(dt: float, masses: tuple[float, float]) -> None:
    for seed in range(0, 8, 2):
        restitution, friction = [(0.0, 0.3), (0.3, 0.6), (0.9, 0.1)][seed % 3]
        world = World(pile(seed, 4 + 2 * seed, masses), restitution, friction)
        weight = G * sum(1.0 / w for w in world.dynamics.inverse_mass if w > 0.0)
        energy = fastest = world.energy()
        for _ in range(min(MOST, round(SECONDS / dt))):
            world.frame(dt)
            lift = weight * LIFT if world.memory.counts[UNSQUEEZED] > 0 else 0.0
            assert world.energy() <= energy + 1e-9 * fastest + lift, seed
            energy = world.energy()
        assert np.isfinite(energy)
        assert world.gap() >= -1e-6, seed
