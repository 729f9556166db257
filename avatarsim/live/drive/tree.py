"""Trees of links, and postures that may be changed in place; kinematics and limits are the engine's own."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.bare_avatars import BareAvatars
from avatarsim.model import skeleton
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.joint import Ball, Free, Hinge, Slide, axes_of
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Poses = tuple[Array, Array]
"""Places (links, 3) [m] and orientations (links, 4) of links in the world."""


@dataclass(slots=True)
class Posture:
    """Arrays of a sample: `roots` (links, 3) [m] of free links, `turns` (links, 4) of free links and balls, `angles` of hinges
    [rad] and slides [m]."""

    roots: Array
    turns: Array
    angles: Array

    def copy(self) -> "Posture":
        """Return a copy with its own arrays."""
        return Posture(self.roots.copy(), self.turns.copy(), self.angles.copy())

    def sample(self, time: float) -> TrackerSample:
        """Return a sample at `time` [s] that shares these arrays."""
        return TrackerSample(time, self.roots, self.turns, self.angles)


def posture_of(sample: TrackerSample) -> Posture:
    """Return the posture of a checked sample; its turns become unit quaternions to rounding."""
    return Posture(sample.positions.copy(), rotation.normalised(sample.rotations), sample.angles.copy())


@dataclass(frozen=True, slots=True)
class Node:
    """A link: its parent's number or -1, its place in the parent, its hinges or slide, and the number of their first angle."""

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
    """Links of all avatars of a scene, in its order."""

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
        """Arrays of these links in the engine."""
        return BareAvatars(self._avatars)

    def take_over(self, found: skeleton.Posture, links: Sequence[int], posture_out: Posture) -> None:
        """Copy all angles, and the turns of these links, from arrays."""
        sample = self.arrays.sample(found)
        posture_out.turns[links], posture_out.angles[:] = sample.rotations[links], sample.angles

    def clip(self, posture_out: Posture) -> Posture:
        """Clip each joint to its limits; turns within them keep their bits. Return the posture."""
        own = self.arrays.read(posture_out.sample(0.0))
        clipped = self.arrays.clipped(own)
        self.take_over(clipped, np.flatnonzero((clipped.turn != own.turn).any(axis=(1, 2))).tolist(), posture_out)
        return posture_out

    def chain(self, link: int) -> tuple[int, ...]:
        """Return a link and all above it, the root first."""
        found = []
        while link >= 0:
            found.append(link)
            link = self.nodes[link].parent
        return tuple(reversed(found))

    def subtree(self, link: int) -> list[int]:
        """Return a link and all below it, parents before children."""
        found = [link]
        for k in found:
            found.extend(self.children[k])
        return found

    def moving(self, links: Iterable[int]) -> list[int]:
        """Return those of the links that turn or slide against their parent."""
        return [k for k in links if self.nodes[k].is_ball or self.nodes[k].hinges]

    def angles(self, links: Iterable[int]) -> list[int]:
        """Return the numbers of the angles of the links."""
        return [h for k in links for h, _ in enumerate(self.nodes[k].hinges, start=self.nodes[k].first_angle)]

    def above(self, k: int, poses: Poses) -> Array:
        """Return the world orientation of the frame in which the joint of link k turns."""
        node = self.nodes[k]
        return np.array(node.orientation) if node.parent < 0 else rotation.multiply(poses[1][node.parent], node.orientation)

    def poses(self, posture: Posture) -> Poses:
        """Return the poses of all links."""
        places, turns = self.arrays.poses(self.arrays.read(posture.sample(0.0)))
        return places.copy(), turns.copy()

    def pose(self, posture: Posture, link: int) -> tuple[Array, Array]:
        """Return position (3,) [m] and orientation (4,) of one link in the world."""
        places, turns = self.poses(posture)
        return places[link], turns[link]
