"""Small worlds with avatars, and the arrays that kernels work on."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.model.skeleton import forward
from avatarsim.model.world import World, build
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import Body, fixed, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Rigid, Slide, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.settings import PostureSettings
from avatarsim.spatial import rotation

Vectors = NDArray[np.float64]

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
SETTINGS = PostureSettings()
LIMITS = SwingTwist(Z, (0.6, 0.0, 0.8), 0.8, (-0.5, 1.0))


@dataclass(frozen=True)
class Little:
    """A world at its first posture, with the axes (nd, 3) of its degrees, and a step (nd) of zeros."""

    world: World
    axes: Vectors
    still: Vectors

    @property
    def parts(self) -> tuple:
        """Geometry, skeleton, posture, poses."""
        return self.world.geometry, self.world.skeleton, self.world.posture, self.world.poses


def little(scene: Scene) -> Little:
    """Return arrays of `scene`."""
    world = build(scene)
    degrees = int(world.skeleton.first_dof[-1])
    axes, still = np.zeros((degrees, 3)), np.zeros(degrees)
    forward(world.geometry, world.skeleton, world.posture, still, world.poses, axes)
    return Little(world, axes, still)


def turned(axis: Vector, angle: float) -> tuple[float, float, float, float]:
    """Return a quaternion, as links and pieces take it."""
    w, x, y, z = rotation.from_axis_angle(axis, angle).tolist()
    return w, x, y, z


def piece(length: float = 0.3) -> tuple[Piece, ...]:
    """Return a capsule along z from the joint's centre."""
    return (Piece(Capsule(0.04, length), (0.0, 0.0, 0.5 * length)),)


def mixed_avatar() -> Avatar:
    """Return a root with a ball, a two-hinge and a rigid link in a row, a hinge branch, and a slide that carries a hinge:
    every kind of joint and shape."""
    mass = solid(piece(), 1.0)
    lean, hull = turned(X, 0.4), (Piece(ellipsoid_hull((0.05, 0.06, 0.15)), (0.0, 0.0, 0.15)),)
    box = (Piece(Box((0.08, 0.1, 0.3)), (0.0, 0.0, 0.15)), Piece(Sphere(0.05), (0.0, 0.0, 0.35)))
    return Avatar(
        "m",
        (
            Link("root", None, Free(), piece(), mass),
            Link("a", "root", Ball(LIMITS), hull, mass, anchor=(0.0, 0.0, 0.4), orientation=lean),
            Link(
                "b", "a", Hinges((Hinge(X, -2.0, 2.0), Hinge(Y, -1.0, 1.5))), box, mass, anchor=(0.0, 0.0, 0.4), orientation=lean
            ),
            Link("c", "b", Rigid(), piece(0.1), mass, anchor=(0.0, 0.0, 0.5)),
            Link("d", "root", Hinges((Hinge(Z, -1.0, 1.0),)), piece(), mass, anchor=(0.3, 0.0, 0.0)),
        ),
    )


def sliding_avatar(name: str = "m") -> Avatar:
    """Return the mixed avatar with a slide that carries a hinge: every kind of joint."""
    mass = solid(piece(), 1.0)
    lean, hull = turned(X, 0.4), (Piece(ellipsoid_hull((0.05, 0.06, 0.15)), (0.0, 0.0, 0.15)),)
    slide = Link("e", "root", Slide((-1.0, 0.5, 0.2), -0.2, 0.9), piece(), mass, anchor=(-0.3, 0.0, 0.0), orientation=lean)
    bend = Link("f", "e", Hinges((Hinge(Y, -1.0, 1.0),)), hull, mass, anchor=(-0.2, 0.0, 0.0))
    return replace(mixed_avatar(), name=name, links=(*mixed_avatar().links, slide, bend))


def random_sample(avatars: tuple[Avatar, ...], seed: int) -> TrackerSample:
    """Return any posture of all avatars, within limits or not."""
    rng = np.random.default_rng(seed)
    links, hinges = sum(len(a.links) for a in avatars), sum(a.hinge_count for a in avatars)
    return TrackerSample(
        0.0, rng.normal(size=(links, 3)), rotation.normalised(rng.normal(size=(links, 4))), rng.normal(size=hinges)
    )


def at(sample: TrackerSample, position: Vector) -> TrackerSample:
    """Return the sample with the first root moved."""
    positions = sample.positions.copy()
    positions[0] = position
    return TrackerSample(sample.time, positions, sample.rotations, sample.angles)


def panel(thickness: float = 0.002, x: float = 0.0) -> Body:
    """Return a thin plate across the x axis."""
    return fixed("panel", (Piece(Box((thickness, 2.0, 2.0))),), "metal", (x, 0.0, 0.0))


def block(name: str, centre: Vector, size: Vector) -> Body:
    """Return a fixed box."""
    return fixed(name, (Piece(Box(size)),), "wood", centre)


def hand(shape: tuple[Piece, ...] = (Piece(Sphere(0.05)),), name: str = "hand") -> Avatar:
    """Return a driven body of one link."""
    return rigid_avatar(name, shape, solid(shape, 0.5))


def hand_scene(start: Vector, *bodies: Body, shape: tuple[Piece, ...] = (Piece(Sphere(0.05)),)) -> Scene:
    """Return one hand at `start` among bodies."""
    avatar = hand(shape)
    return Scene("hand", bodies, (avatar,), start=at(rest((avatar,)), start))
