"""Drawn hands with hinges, led by shaking trackers into drawn things and into their own fingers: nothing overlaps."""


import numpy as np
import pytest

from avatarsim.collision.scratch import make_scratch
from avatarsim.engine import Settings
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from tests.rigid.upper_world import least_gap, wanted_pairs


def hand(random: np.random.Generator) -> Avatar:
    """A palm and two to four fingers of one to three hinges, which may bend into each other."""
    palm = (Piece(Box((0.1, 0.1, 0.02))),)
    links = [Link("palm", None, Free(), palm, solid(palm, random.uniform(0.2, 1.0)), "m")]
    for finger in range(int(random.integers(2, 5))):
        angle = 0.5 * np.pi * finger + random.uniform(-0.3, 0.3)
        x, y, parent = float(np.cos(angle)), float(np.sin(angle)), "palm"
        anchor = (0.06 * x, 0.06 * y, -0.011)
        for joint in range(int(random.integers(1, 4))):
            length = random.uniform(0.025, 0.05)
            bone = Piece(Capsule(0.007, length), (0.0, 0.0, -0.5 * length - 0.009))
            if random.random() < 0.3:
                bone = Piece(Box((0.012, 0.012, length)), (0.0, 0.0, -0.5 * length - 0.003))
            bend, name = Hinges((Hinge((y, -x, 0.0), -0.9, 0.9),)), f"finger {finger} {joint}"
            links.append(Link(name, parent, bend, (bone,), solid((bone,), random.uniform(0.01, 0.1)), "m", anchor))
            parent, anchor = name, (0.0, 0.0, -length - 0.02)
    return Avatar("hand", tuple(links))


def things(random: np.random.Generator) -> list[Body]:
    """One to three balls, boxes and hulls of 10 g to 2 kg above each other."""
    found = []
    for k in range(int(random.integers(1, 4))):
        corners = random.normal(size=(14, 3))
        hull = ConvexHull(0.04 * corners / np.linalg.norm(corners, axis=1)[:, None])
        shape = (Sphere(random.uniform(0.02, 0.04)), Box(tuple(random.uniform(0.03, 0.08, 3))), hull)[random.integers(3)]
        mass = float(np.exp(random.uniform(np.log(0.01), np.log(2.0))))
        place = (random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), 0.06 + 0.1 * k)
        found.append(simulated(f"thing {k}", (Piece(shape),), "m", solid((Piece(shape),), mass), place))
    return found


@pytest.mark.parametrize("seed", [*range(8), 308, 372])
def test_drawn_hands_overlap_nothing(seed: int) -> None:
    random = np.random.default_rng(seed)
    avatar, bodies = hand(random), things(random)
    angles = random.uniform(-0.9, 0.9, len(avatar.links) - 1)
    often, far, noise = random.uniform(0.5, 3.0), random.uniform(0.02, 0.15), (0.0, 3e-4, 1e-3)[seed % 3]

    def sample(time: float) -> TrackerSample:
        shakes = far if time > 1.0 else 0.0
        places = np.zeros((len(avatar.links), 3))
        high = 0.6 - 0.4 * min(time, 1.0) + 0.5 * shakes * np.sin(6.0 * often * time)
        places[0] = shakes * np.sin(3.0 * often * time), 0.0, high
        places[0] += noise * random.normal(size=3)
        turns = np.tile(rotation.IDENTITY, (len(avatar.links), 1))
        turns[0] = rotation.from_axis_angle((0.0, 1.0, 0.0), 0.8 * np.sin(2.0 * time) if time > 1.0 else 0.0)
        return TrackerSample(time, places, turns, angles * (0.5 - 0.5 * np.cos(3.0 * time)))

    floor = fixed("floor", (Piece(Box((3.0, 3.0, 0.2))),), "m", (0.0, 0.0, -0.1))
    law = PairTable({("m", "m"): ContactLaw(0.5 * (seed % 2), random.uniform(0.2, 0.9))})
    engine, dt = AvatarsimEngine(), (1.0 / 30.0, 1.0 / 60.0, 1.0 / 90.0, 1.0 / 240.0)[seed % 4]
    engine.load(Scene("drawn", (floor, *bodies), (avatar,), materials=law, start=sample(0.0)), Settings(), dt)
    world = engine._running().world
    pairs, scratch = wanted_pairs(world.geometry), make_scratch()
    for k in range(round(2.5 / dt)):
        shown = engine.advance(sample((k + 1) * dt), dt).shown
        assert np.isfinite(shown.positions).all()
        assert least_gap(world.poses.vertices, world.geometry.shapes, pairs, scratch) >= -1e-6
