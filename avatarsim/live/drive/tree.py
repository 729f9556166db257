"""Trees of links as plain lists, and postures that may be changed in place; kinematics and limits are the engine's own."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np

from avatarsim.ik.bare_avatars import BareAvatars
from avatarsim.live.drive.turns import multiply, normalised
from avatarsim.model import skeleton
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.joint import Ball, Free, Hinge, Slide, axes_of
from avatarsim.scene.tracker import TrackerSample

Pose = tuple[Vector, Quaternion]
"""Place [m] and orientation of a link in the world."""


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
        # two thirds of the time of np.array
        roots, turns = (np.fromiter(chain.from_iterable(rows), np.float64) for rows in (self.roots, self.turns))
        return TrackerSample(time, roots.reshape(-1, 3), turns.reshape(-1, 4), np.array(self.angles, dtype=np.float64))


def posture_of(sample: TrackerSample) -> Posture:
    """A posture of a sample that has been checked; its turns become unit quaternions to rounding."""
    turns = [normalised((w, x, y, z)) for w, x, y, z in sample.rotations.tolist()]
    return Posture([(x, y, z) for x, y, z in sample.positions.tolist()], turns, [float(angle) for angle in sample.angles])


@dataclass(frozen=True, slots=True)
class Node:
    """A link: its parent's number or -1, its place in that, its hinges, or its slide, and the number of their first angle."""

    name: str
    avatar: int
    parent: int
    anchor: Vector
    orientation: Quaternion
    is_free: bool
    is_ball: bool
    hinges: tuple[Hinge | Slide, ...]
    first_angle: int

    @property
    def is_slide(self) -> bool:
        """True for a link that slides."""
        return bool(self.hinges) and isinstance(self.hinges[0], Slide)


class Tree:
    """The links of all avatars of a scene, in its order."""

    def __init__(self, avatars: Sequence[Avatar]) -> None:
        self._avatars = tuple(avatars)
        self.nodes: list[Node] = []
        angle = 0
        for number, avatar in enumerate(avatars):
            first = len(self.nodes)
            index = {link.name: first + k for k, link in enumerate(avatar.links)}
            for link in avatar.links:
                hinges = axes_of(link.joint)
                self.nodes.append(Node(
                    link.name, number, -1 if link.parent is None else index[link.parent], link.anchor, link.orientation,
                    isinstance(link.joint, Free), isinstance(link.joint, Ball), hinges, angle,
                ))
                angle += len(hinges)
        self.children: list[list[int]] = [[] for _ in self.nodes]
        for k, node in enumerate(self.nodes):
            if node.parent >= 0:
                self.children[node.parent].append(k)

    @cached_property
    def arrays(self) -> BareAvatars:
        """The engine's arrays of these links."""
        return BareAvatars(self._avatars)

    def take_over(self, found: skeleton.Posture, links: Iterable[int], posture_out: Posture) -> None:
        """Take over all angles, and the turns of these links, from arrays."""
        sample = self.arrays.sample(found)
        turns, posture_out.angles = sample.rotations.tolist(), sample.angles.tolist()
        for k in links:
            w, x, y, z = turns[k]
            posture_out.turns[k] = (w, x, y, z)

    def clip(self, posture_out: Posture) -> None:
        """Put each joint inside its limits; turns inside them stay to the bit."""
        own = self.arrays.read(posture_out.sample(0.0))
        clipped = self.arrays.clipped(own)
        self.take_over(clipped, np.flatnonzero((clipped.turn != own.turn).any(axis=(1, 2))).tolist(), posture_out)

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

    def above(self, k: int, poses: Sequence[Pose]) -> Quaternion:
        """The frame that the joint of link k turns in, in the world."""
        node = self.nodes[k]
        return node.orientation if node.parent < 0 else multiply(poses[node.parent][1], node.orientation)

    def poses(self, posture: Posture) -> list[Pose]:
        """Return the poses of all links."""
        places, turns = self.arrays.poses(self.arrays.read(posture.sample(0.0)))
        return [((a, b, c), (w, x, y, z)) for (a, b, c), (w, x, y, z) in zip(places.tolist(), turns.tolist(), strict=True)]

    def pose(self, posture: Posture, link: int) -> Pose:
        """Place [m] and orientation in the world of one link."""
        return self.poses(posture)[link]
