"""Small scenes of the posture solver and motions through them, for the tests of whole frames."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body, fixed
from avatarsim.scene.joint import Ball, Free, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from tests.stability.hostile import hinged_avatar
from tests.worlds.little_worlds import at, block, hand, mixed_avatar


def corner() -> tuple[Body, ...]:
    """Return a floor, a thin wall and a post."""
    return (
        block("floor", (0.0, 0.0, -0.6), (4.0, 4.0, 0.1)), block("wall", (0.7, 0.0, 0.5), (0.01, 4.0, 2.4)),
        fixed("post", (Piece(Capsule(0.03, 1.0)),), "metal", (-0.5, 0.4, 0.0)),
    )


def both_hands(names: tuple[str, ...]) -> Scene:
    """Hands before two walls that are far apart: `a` and `b` before one, `far` before the other; only those that are named."""
    walls = block("wall", (0.1, 0.0, 0.0), (0.02, 2.0, 2.0)), block("far wall", (50.1, 0.0, 0.0), (0.02, 2.0, 2.0))
    places = {"a": (-0.15, -0.1, 0.0), "b": (-0.15, 0.1, 0.0), "far": (50.0, 0.0, 0.0)}
    avatars = tuple(hand((Piece(Sphere(0.05)),), name) for name in names)
    start = replace(rest(avatars), positions=np.array([places[name] for name in names]))
    return Scene("hands", walls, avatars, start=start)


def standing_hinged(bodies: tuple[Body, ...] = ()) -> Scene:
    """Return sixteen hulls among bodies, a metre above the origin."""
    avatar = hinged_avatar()
    return Scene("hinged", bodies, (avatar,), start=at(rest((avatar,)), (0.0, 0.0, 1.1)))


@cache
def free_hinged() -> Scene:
    """Return sixteen hulls with nothing around them."""
    return standing_hinged()


def two_of_them() -> Scene:
    """Return a tree with every kind of joint and a hand in its way, in the corner."""
    pair: tuple[Avatar, ...] = (mixed_avatar(), hand((Piece(Box((0.1, 0.08, 0.06))),), "other"))
    start = rest(pair)
    start.positions[5] = (0.3, 0.5, 0.0)
    return Scene("two", corner(), pair, start=start)


def alone() -> Scene:
    """Return a box in the corner."""
    box = hand((Piece(Box((0.1, 0.08, 0.06))),))
    return Scene("hand", corner(), (box,), start=at(rest((box,)), (0.2, 0.0, 0.0)))


def walled_hinged() -> Scene:
    """Return sixteen hulls on a floor before a thin wall."""
    floor, wall = block("floor", (0.0, 0.0, 0.0), (4.0, 4.0, 0.1)), block("wall", (0.7, 0.0, 1.0), (0.01, 4.0, 2.4))
    return standing_hinged((floor, wall))


SCENES = {"hand": alone(), "two": two_of_them(), "hinged": walled_hinged()}


def posed(scene: Scene, rng: np.random.Generator, spread: float, room: float) -> TrackerSample:
    """The start, its joints turned by angles of that spread [rad] and its roots anywhere within `room` [m] of the origin."""
    start, joints = scene.first_sample, [link.joint for link in scene.links]
    positions, rotations = start.positions.copy(), start.rotations.copy()
    for k, joint in enumerate(joints):
        if isinstance(joint, Free):
            positions[k] = rng.uniform(-room, room, 3)
            rotations[k] = rotation.normalised(rng.normal(size=4))
        elif isinstance(joint, Ball):
            rotations[k] = rotation.multiply(rotations[k], rotation.from_axis_angle(rng.normal(size=3), spread))
    limits = [(one.lower, one.upper) for joint in joints if isinstance(joint, Hinges) for one in joint.hinges]
    low, high = np.array(limits).reshape(-1, 2).T
    angles = np.clip(start.angles + rng.uniform(-spread, spread, len(start.angles)), low, high)
    return TrackerSample(start.time, positions, rotations, angles)


def drawn(scene: Scene, seed: int, frames: int) -> Iterator[TrackerSample]:
    """Yield a motion that drifts, twitches, rests and jumps, into any obstacles around and beyond the limits of joints."""
    rng, sample = np.random.default_rng(seed), scene.first_sample
    roots = np.array([isinstance(link.joint, Free) for link in scene.links])
    balls = np.array([isinstance(link.joint, Ball) for link in scene.links])
    drift, spin = rng.normal(0.0, 0.02, (len(roots), 3)), rng.normal(0.0, 0.05, (len(roots), 3))
    rates = rng.normal(0.0, 0.08, len(sample.angles))
    for k in range(frames):
        positions, rotations, angles = sample.positions.copy(), sample.rotations.copy(), sample.angles.copy()
        if k % 9 < 6:
            positions[roots] += drift[roots]
            for j in np.flatnonzero(roots | balls):
                turned = rotation.from_axis_angle(spin[j], float(np.linalg.norm(spin[j])))
                rotations[j] = rotation.normalised(rotation.multiply(rotations[j], turned))
            angles += rates
        if k % 12 == 11:
            positions[roots] += rng.uniform(-0.6, 0.6, (int(roots.sum()), 3))
            rotations[roots] = rotation.normalised(rng.normal(size=(int(roots.sum()), 4)))
            drift, rates = rng.normal(0.0, 0.02, drift.shape), rng.normal(0.0, 0.08, len(rates))
        sample = TrackerSample(k / 60.0, positions, rotations, angles)
        yield sample
