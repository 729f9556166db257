"""Trees of links as plain lists, postures that may be changed in place, and forward kinematics (Featherstone 2008, 4.1).

The twin of `avatarsim.scene.tracker.link_poses` for a few links at a time, without numpy: a chain of eight links in 30 us.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from avatarsim.live.drive.limits import Limits, limits_of
from avatarsim.live.drive.turns import about, add, multiply, normalised, rotate, scaled
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.joint import Ball, Free, Hinge, Slide, axes_of
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial.rotation import IDENTITY


@dataclass(slots=True)
class Posture:
    """What a sample says, as lists: `roots` [m] of free links, `turns` of free links and balls, `angles` of hinges [rad] and
    slides [m]."""

    roots: list[Vector]
    turns: list[Quaternion]
    angles: list[float]

    def copy(self) -> "Posture":
        """One of its own."""
        return Posture(list(self.roots), list(self.turns), list(self.angles))

    def sample(self, time: float) -> TrackerSample:
        """As a sample at `time` [s]."""
        return TrackerSample(
            time, np.array(self.roots, dtype=np.float64).reshape(-1, 3), np.array(self.turns, dtype=np.float64).reshape(-1, 4),
            np.array(self.angles, dtype=np.float64),
        )


def posture_of(sample: TrackerSample) -> Posture:
    """A posture of a sample that has been checked; its turns become unit quaternions to rounding."""
    turns = [normalised((w, x, y, z)) for w, x, y, z in sample.rotations.tolist()]
    return Posture([(x, y, z) for x, y, z in sample.positions.tolist()], turns, [float(angle) for angle in sample.angles])


@dataclass(frozen=True, slots=True)
class Node:
    """A link: its parent's number or -1, its place in that, its hinges, or its slide, and the number of their first angle, and
    the limits of its ball."""

    name: str
    avatar: int
    parent: int
    anchor: Vector
    orientation: Quaternion
    is_free: bool
    is_ball: bool
    hinges: tuple[Hinge | Slide, ...]
    first_angle: int
    limits: Limits | None

    @property
    def is_slide(self) -> bool:
        """True for a link that slides."""
        return bool(self.hinges) and isinstance(self.hinges[0], Slide)


class Tree:
    """The links of all avatars of a scene, in its order."""

    def __init__(self, avatars: Sequence[Avatar]) -> None:
        self.nodes: list[Node] = []
        angle = 0
        for number, avatar in enumerate(avatars):
            first = len(self.nodes)
            index = {link.name: first + k for k, link in enumerate(avatar.links)}
            for link in avatar.links:
                hinges = axes_of(link.joint)
                is_ball = isinstance(link.joint, Ball)
                self.nodes.append(Node(
                    link.name, number, -1 if link.parent is None else index[link.parent], link.anchor, link.orientation,
                    isinstance(link.joint, Free), is_ball, hinges, angle,
                    limits_of(link.joint, link.orientation) if isinstance(link.joint, Ball) else None,
                ))
                angle += len(hinges)
        self.children: list[list[int]] = [[] for _ in self.nodes]
        for k, node in enumerate(self.nodes):
            if node.parent >= 0:
                self.children[node.parent].append(k)

    def chain(self, link: int) -> tuple[int, ...]:
        """A link and all above it, the root first."""
        found = []
        while link >= 0:
            found.append(link)
            link = self.nodes[link].parent
        return tuple(reversed(found))

    def subtree(self, link: int) -> list[int]:
        """A link and all below it, parents before children."""
        found = [link]
        for k in found:
            found.extend(self.children[k])
        return found

    def moving(self, links: Iterable[int]) -> list[int]:
        """Those of some links that turn or slide against their parent."""
        return [k for k in links if self.nodes[k].is_ball or self.nodes[k].hinges]

    def above(self, k: int, poses: dict[int, tuple[Vector, Quaternion]]) -> Quaternion:
        """The frame that the joint of link k turns in, in the world."""
        node = self.nodes[k]
        return node.orientation if node.parent < 0 else multiply(poses[node.parent][1], node.orientation)

    def poses(self, posture: Posture, links: Iterable[int]) -> dict[int, tuple[Vector, Quaternion]]:
        """Place [m] and orientation in the world of links; of each its parent is in the list before it, or it has none."""
        found: dict[int, tuple[Vector, Quaternion]] = {}
        for k in links:
            node = self.nodes[k]
            if node.is_free:
                found[k] = posture.roots[k], posture.turns[k]
                continue
            place, frame = found[node.parent] if node.parent >= 0 else ((0.0, 0.0, 0.0), IDENTITY)
            turned = multiply(frame, node.orientation)
            if node.is_ball:
                turned = multiply(turned, posture.turns[k])
            origin = add(place, rotate(frame, node.anchor))
            for h, hinge in enumerate(node.hinges, start=node.first_angle):
                if isinstance(hinge, Slide):
                    origin = add(origin, scaled(rotate(turned, hinge.axis), posture.angles[h]))
                else:
                    turned = multiply(turned, about(hinge.axis, posture.angles[h]))
            found[k] = origin, normalised(turned)
        return found

    def pose(self, posture: Posture, link: int) -> tuple[Vector, Quaternion]:
        """Place [m] and orientation in the world of one link."""
        return self.poses(posture, self.chain(link))[link]
