"""Drivers of the built-in stages, postures while keys repeat, random postures, and excess of joints beyond their limits."""

import random

import numpy as np

from avatarsim.assets.models.ball_limits import ball_excess
from avatarsim.live.drive.driver import Driver
from avatarsim.live.drive.tree import Tree, posture_of
from avatarsim.live.stages import stage
from avatarsim.scene.joint import Ball, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.spatial import rotation

DT = 1.0 / 60.0


def driver(name: str) -> Driver:
    """Return a driver of a built-in stage."""
    return Driver(stage(name).scene)


def ticks(one: Driver, count: int, keys: str = "") -> list[TrackerSample]:
    """Return postures of some frames, while keys repeat."""
    found = []
    for k in range(count):
        for key in keys if k % 2 == 0 else "":
            assert one.press(key) == ""
        found.append(one.tick(DT))
    return found


def random_sample(scene: Scene, seed: int, amount: float = 0.8) -> TrackerSample:
    """Return a posture within limits, balls turned by up to `amount` [rad] about each axis, the root as at the start."""
    rng, tree = random.Random(seed), Tree(scene.avatars)
    found = posture_of(scene.first_sample)
    for k, node in enumerate(tree.nodes):
        if node.is_ball:
            found.turns[k] = rotation.turned(found.turns[k], [rng.uniform(-amount, amount) for _ in range(3)])
        for h, hinge in enumerate(node.hinges, start=node.first_angle):
            found.angles[h] = rng.uniform(hinge.lower, hinge.upper)
    return tree.clip(found).sample(0.0)


def excess(scene: Scene, sample: TrackerSample) -> float:
    """Return the largest excess [rad] of a joint beyond its limits, by the arrays' own definition of them."""
    most, hinge = 0.0, 0
    for k, link in enumerate(scene.links):
        if isinstance(link.joint, Hinges):
            for joint in link.joint.hinges:
                most = max(most, joint.lower - sample.angles[hinge], sample.angles[hinge] - joint.upper)
                hinge += 1
        elif isinstance(link.joint, Ball):
            turned = rotation.multiply(link.orientation, sample.rotations[k])
            most = max(most, float(ball_excess(link.joint, turned[None])[0]))
    return float(most)


def places(scene: Scene, sample: TrackerSample) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return the joint positions of all links (n, 3) [m]."""
    return link_poses(scene.avatars, sample)[0]


def fastest(scene: Scene, samples: list[TrackerSample]) -> tuple[float, float]:
    """Return the largest root speed [m/s] and joint speed [rad/s] of a sequence of postures."""
    roots = np.array([sample.positions[0] for sample in samples])
    turns, angles = np.array([sample.rotations for sample in samples]), np.array([sample.angles for sample in samples])
    steps = rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(turns[:-1]), turns[1:]))
    turned = max(float(np.linalg.norm(steps, axis=2).max()), float(np.abs(np.diff(angles, axis=0)).max(initial=0.0)))
    return float(np.linalg.norm(np.diff(roots, axis=0), axis=1).max()) / DT, turned / DT
