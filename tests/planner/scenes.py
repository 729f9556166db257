"""Small scenes of the planner: obstacles that an avatar cannot slide around, and where its target is."""

import numpy as np

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.simulator import AvatarsimEngine
from tests.worlds.little_worlds import at, block, hand

DT = 1.0 / 60.0
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def walker() -> Avatar:
    """Return a trunk with an upper and a lower arm."""
    trunk, arm = (Piece(Box((0.2, 0.3, 0.6))),), (Piece(Capsule(0.03, 0.24), (0.0, 0.0, -0.15)),)
    return Avatar(
        "walker",
        (
            Link("trunk", None, Free(), trunk, solid(trunk, 10.0)),
            Link("upper", "trunk", Hinges((Hinge(Y, -3.0, 3.0), Hinge(X, -2.0, 2.0))), arm, solid(arm, 1.0), anchor=(0.0, 0.22,
            0.2)),
            Link("lower", "upper", Hinges((Hinge(Y, -2.5, 2.5),)), arm, solid(arm, 1.0), anchor=(0.0, 0.0, -0.34)),
        ),
    )


def room_with_door(avatar: Avatar) -> Scene:
    """Return a wall before the avatar, high and wide, with a doorway 1.5 m to its left."""
    floor = block("floor", (0.0, 0.0, -0.6), (9.0, 9.0, 0.2))
    right, left = block("right", (0.7, -1.5, 0.8), (0.1, 5.0, 2.6)), block("left", (0.7, 3.25, 0.8), (0.1, 2.5, 2.6))
    return Scene("door", (floor, right, left), (avatar,), start=rest((avatar,)))


def moved(scene: Scene, place: Vector, angles: tuple[float, ...] = ()) -> TrackerSample:
    """Return the start with its root elsewhere, and other angles of hinges."""
    sample = at(scene.first_sample, place)
    return TrackerSample(0.0, sample.positions, sample.rotations, np.array(angles or sample.angles))


def behind_the_wall(avatar: Avatar) -> tuple[Scene, TrackerSample]:
    """Return the room with a door, and a target on the other side of its wall."""
    scene = room_with_door(avatar)
    return scene, moved(scene, (1.4, 0.0, 0.0))


def held_arm() -> tuple[Scene, TrackerSample]:
    """Return a flat arm on a fixed base, and a target on the other side of a post within its reach: it must fold to get past."""
    bone = (Piece(Capsule(0.03, 0.24), (0.15, 0.0, 0.0), orientation=(0.7071067811865476, 0.0, 0.7071067811865475, 0.0)),)
    mass = solid(bone, 1.0)
    arm = Avatar(
        "arm",
        (
            Link("upper", None, Hinges((Hinge(Z, -3.0, 3.0),)), bone, mass),
            Link("middle", "upper", Hinges((Hinge(Z, -2.5, 2.5),)), bone, mass, anchor=(0.34, 0.0, 0.0)),
            Link("lower", "middle", Hinges((Hinge(Z, -2.5, 2.5),)), bone, mass, anchor=(0.34, 0.0, 0.0)),
        ),
    )
    post = fixed("post", (Piece(Capsule(0.05, 1.0), (0.0, 0.0, 0.0)),), "metal", (0.22, 0.55, 0.0))
    scene = Scene("held", (post,), (arm,), start=rest((arm,)))
    start = scene.first_sample
    return scene, TrackerSample(0.0, start.positions, start.rotations, np.array([2.4, 0.0, 0.0]))


def palm() -> Avatar:
    """Return a driven box without joints."""
    return hand((Piece(Box((0.1, 0.1, 0.03))),), "palm")


class Run:
    """An engine of preset `default` with its scene."""

    def __init__(self, scene: Scene, seed: int = 0, **options: object) -> None:
        self.scene, self.engine = scene, AvatarsimEngine()
        self.record: FrameRecord = self.engine.load(scene, Settings("default", options, seed=seed), DT)
        self.said: dict[str, int] = {}

    def go(self, sample: TrackerSample, frames: int) -> list[FrameRecord]:
        """Run so many frames with a target that rests; their statuses are added up in `said`."""
        found = []
        for _ in range(frames):
            self.record = self.engine.advance(sample, DT)
            found.append(self.record)
            for name, value in self.record.statuses.items():
                self.said[name] = self.said.get(name, 0) + value
        return found

    def far(self, sample: TrackerSample) -> float:
        """Return the distance [m] of the link origin that is farthest from the target's."""
        target, _ = link_poses(self.scene.avatars, sample)
        shown = self.record.shown.positions[len(self.scene.bodies) :]
        return float(np.linalg.norm(shown - target, axis=1).max())
