"""A recorded skeleton: a tree of bones with joints, as BVH and ASF describe it, in metres and with z up."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.checks import Vector
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Limits = tuple[float, float]


@dataclass(frozen=True)
class Bone:
    """One joint and its bone. With every joint at zero the frames of all bones are parallel.

    parent   number of the bone it is attached to, an earlier one; -1 for the root
    offset   the joint's centre in the parent's frame [m]
    axes     axes of its turns in the bone's frame, the first one nearest the parent; none for a joint that does not turn
    turns    the file's names of these turns
    tips     points in the bone's frame [m] where it ends without another joint
    limits   the file's own limits of each turn [rad]; none where it states none"""

    name: str
    parent: int
    offset: Vector
    axes: tuple[Vector, ...] = ()
    turns: tuple[str, ...] = ()
    tips: tuple[Vector, ...] = ()
    limits: tuple[Limits, ...] = ()


@dataclass(frozen=True)
class Skeleton:
    """Bones, parents before children, of a recorded human or animal called `name`."""

    name: str
    bones: tuple[Bone, ...]

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """Return the bones attached to each one."""
        found: list[list[int]] = [[] for _ in self.bones]
        for k, bone in enumerate(self.bones):
            if bone.parent >= 0:
                found[bone.parent].append(k)
        return tuple(tuple(each) for each in found)

    def poses(self, positions: Array, rotations: Array, angles: Array) -> tuple[Array, Array]:
        """Return joints (..., bones, 3) [m] and orientations (..., bones, 4) in the world, of postures as in TrackerSample."""
        shape = np.shape(positions)
        places, turned = np.zeros(shape), np.zeros((*shape[:-1], 4))
        hinge = 0
        for k, bone in enumerate(self.bones):
            if bone.parent < 0:
                places[..., k, :], turned[..., k, :] = positions[..., k, :], rotations[..., k, :]
                continue
            own = turned[..., bone.parent, :]
            places[..., k, :] = places[..., bone.parent, :] + rotation.rotate(own, bone.offset)
            if len(bone.axes) == 3:
                own = rotation.multiply(own, rotations[..., k, :])
            else:
                for axis in bone.axes:
                    own = rotation.multiply(own, rotation.from_axis_angle(axis, angles[..., hinge]))
                    hinge += 1
            turned[..., k, :] = own
        return places, turned

    def points(self, positions: Array, rotations: Array, angles: Array) -> Array:
        """Return joints and tips (..., points, 3) [m] of postures as in TrackerSample: all joints, then the tips bone by bone."""
        places, turned = self.poses(positions, rotations, angles)
        carried = [(k, tip) for k, bone in enumerate(self.bones) for tip in bone.tips]
        tips = [places[..., k, :] + rotation.rotate(turned[..., k, :], tip) for k, tip in carried]
        return np.concatenate([places, np.stack(tips, axis=-2)], axis=-2) if tips else places

    @cached_property
    def still(self) -> tuple[Array, Array, Array]:
        """Return the posture with every joint at zero and the root at the origin, as in TrackerSample."""
        hinges = sum(len(bone.axes) for bone in self.bones[1:] if len(bone.axes) < 3)
        unturned = np.tile(np.array(rotation.IDENTITY), (len(self.bones), 1))
        return np.zeros((len(self.bones), 3)), unturned, np.zeros(hinges)

    @cached_property
    def rest(self) -> Array:
        """Joints and tips (points, 3) [m] with every joint at zero and the root at the origin."""
        return self.points(*self.still)

    @cached_property
    def owners(self) -> tuple[int, ...]:
        """The bone of each of the `points`."""
        return (*range(len(self.bones)), *(k for k, bone in enumerate(self.bones) for _ in bone.tips))

    def ends(self, k: int) -> tuple[Vector, ...]:
        """Return the ends of bone k, in its own frame [m]: the joints attached to it, then its tips."""
        return tuple(dict.fromkeys([*(self.bones[child].offset for child in self.children[k]), *self.bones[k].tips]))
