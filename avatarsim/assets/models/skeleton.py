"""Recorded skeletons: the kinematic tree of bones that motion capture formats share (BVH, ASF, SMPL), without flesh.

At rest all frames of bones are parallel to the world's, as in BVH: a bone's frame stands at its joint, and the pose of a skeleton
is the rotation of each joint against that rest. Metres, z up."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidInput

Vector = tuple[float, float, float]
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bone:
    """One joint and what it carries.

    name    unique in its skeleton
    parent  index of the bone that carries it, which comes before it; -1 for the root, the first bone
    offset  its joint in the parent's frame [m]; of the root, where it stands at rest
    ends    points in its own frame up to which it reaches where no bone follows [m]; () for a bone that only carries others
    axes    unit axes of its hinges in its own frame, in the order in which they turn; () for a ball joint
    """

    name: str
    parent: int
    offset: Vector
    ends: tuple[Vector, ...] = ()
    axes: tuple[Vector, ...] = ()


@dataclass(frozen=True)
class Skeleton:
    """Bones, each after its parent. Raises InvalidInput for an order, a name or a number that says something else."""

    bones: tuple[Bone, ...]

    def __post_init__(self) -> None:
        seen: set[str] = set()
        for index, bone in enumerate(self.bones):
            if bone.name in seen:
                raise InvalidInput("name of a bone", bone.name, "a name that no bone before it has")
            seen.add(bone.name)
            if (bone.parent != -1) if index == 0 else not 0 <= bone.parent < index:
                raise InvalidInput(f"parent of bone {bone.name}", bone.parent, "-1 for the first, of others a bone before it")
            vectors = np.array([bone.offset, *bone.ends, *bone.axes], dtype=np.float64)
            if vectors.shape[1:] != (3,) or not np.isfinite(vectors).all():
                raise InvalidInput(f"offset, ends and axes of bone {bone.name}", vectors.tolist(), "rows of 3 finite numbers")
        if not self.bones:
            raise InvalidInput("bones of a skeleton", 0, "at least 1")

    @property
    def names(self) -> tuple[str, ...]:
        """The bones' names, in order."""
        return tuple(bone.name for bone in self.bones)

    def children(self, index: int) -> tuple[int, ...]:
        """The bones that a bone carries."""
        return tuple(k for k, bone in enumerate(self.bones) if bone.parent == index)

    def rest(self) -> Array:
        """Where the joints stand at rest (bones, 3) [m]."""
        places = np.zeros((len(self.bones), 3))
        for index, bone in enumerate(self.bones):
            places[index] = bone.offset
            if index > 0:
                places[index] += places[bone.parent]
        return places
