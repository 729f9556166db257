"""Arms and hands for the tests, as arrays, and CCD on them as one call."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.model.skeleton import forward
from avatarsim.model.world import World, build
from avatarsim.paper.ccd_ik import reach_goal
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import Body, solid
from avatarsim.scene.joint import Ball, Hinge, Hinges, Joint, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import PaperSettings
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Z = (0.0, 0.0, 1.0)
RADIUS = 0.03
AS_PRINTED = PaperSettings(tolerance=1e-9, sweeps=2000, bend=0.0)
BENDING = AS_PRINTED._replace(bend=0.1)
ALONG_X = tuple(rotation.from_axis_angle((0.0, 1.0, 0.0), np.pi / 2))
SWING_TWIST = SwingTwist((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1.2, (-0.5, 0.7))


def planar(*limits: tuple[float, float]) -> list[Joint]:
    """Return hinges about z, one per link."""
    return [Hinges((Hinge(Z, *limit),)) for limit in limits]


def arm(
    lengths: tuple[float, ...], joints: list[Joint], name: str = "arm", at: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> Avatar:
    """Return capsules end to end along x, anchored to the world at ``at``."""
    links = []
    for k, (length, joint) in enumerate(zip(lengths, joints, strict=True)):
        piece = Piece(Capsule(RADIUS, length), (0.5 * length, 0.0, 0.0), ALONG_X)
        links.append(
            Link(
                f"{name}{k}", f"{name}{k - 1}" if k else None, joint, (piece,), solid((piece,), 1.0),
                anchor=(lengths[k - 1], 0.0, 0.0) if k else at,
            )
        )
    return Avatar(name, tuple(links))


def ball_hand(radius: float, name: str = "hand") -> Avatar:
    """Return a driven sphere, at the origin unless a test puts it elsewhere."""
    piece = Piece(Sphere(radius))
    return rigid_avatar(name, (piece,), solid((piece,), 0.4))


def world_of(avatars: tuple[Avatar, ...], bodies: tuple[Body, ...] = (), start: TrackerSample | None = None) -> World:
    """Return the arrays of a scene with these avatars."""
    return build(Scene("test", bodies, avatars, start=start))


def tips(world: World, lengths: tuple[float, ...]) -> Array:
    """Return the end of the last link [m]."""
    body = world.skeleton.first + len(lengths) - 1
    end: Array = world.poses.position[body] + world.poses.rotation[body] @ np.array([lengths[-1], 0.0, 0.0])
    return end


@dataclass
class Reach:
    """Result of CCD: its status and sweeps, the distance left that it reports, whether the chain was bent, and the distance
    left that the kinematics has."""

    status: int
    sweeps: int
    left: float
    bent: bool
    measured: float
    angles: Array


def reach(
    world: World, lengths: tuple[float, ...], goal: Array, settings: PaperSettings = AS_PRINTED, angles: Array | None = None
) -> Reach:
    """Bring the tip of a one-arm world to ``goal`` from ``angles`` (default: as it is)."""
    skel, nd = world.skeleton, int(world.skeleton.first_dof[-1])
    axes, none = np.zeros((nd, 3)), np.zeros(nd)
    if angles is not None:
        world.posture.angle[:] = angles
    forward(world.geometry, skel, world.posture, none, world.poses, axes)
    x, y, z = tips(world, lengths)
    links = np.arange(len(lengths), dtype=np.int64)
    status, sweeps, left, bent = reach_goal(
        skel, links, 0, len(lengths) - 1, (x, y, z), (float(goal[0]), float(goal[1]), float(goal[2])), settings,
        world.posture, world.poses, axes,
    )
    forward(world.geometry, skel, world.posture, none, world.poses, axes)
    return Reach(status, sweeps, left, bent, float(np.linalg.norm(tips(world, lengths) - goal)), world.posture.angle.copy())


def three_axes(limit: float) -> Joint:
    """Return a ball and socket as the paper builds it: three hinges that share a centre."""
    return Hinges(tuple(Hinge(axis, -limit, limit) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), Z)))


def limited_ball() -> Joint:
    """Return a native ball with a cone of 1.2 rad about x and a twist of -0.5 to 0.7 rad."""
    return Ball(SWING_TWIST)
