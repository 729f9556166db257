"""A small human skeleton, and clips of it, for tests of avatars made of skeletons."""

import numpy as np

from avatarsim.assets.models.skeleton import Bone, Skeleton
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation

BALL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
XYZ = ("x", "y", "z")


def human_skeleton() -> Skeleton:
    """Return a human of 1.7 m that faces +x in a T pose, with z up; all joints are balls."""
    bones = [
        Bone("Hips", -1, (0.0, 0.0, 0.0)), Bone("Spine", 0, (0.0, 0.0, 0.1)), Bone("Neck", 1, (0.0, 0.0, 0.45)),
        Bone("Head", 2, (0.0, 0.0, 0.1), tips=((0.0, 0.0, 0.2),)),
    ]
    for side, y in (("Left", 1.0), ("Right", -1.0)):
        first = len(bones)
        bones += [
            Bone(f"{side}Shoulder", 1, (0.0, 0.05 * y, 0.4)), Bone(f"{side}Arm", first, (0.0, 0.13 * y, 0.0)),
            Bone(f"{side}ForeArm", first + 1, (0.0, 0.28 * y, 0.0)),
            Bone(f"{side}Hand", first + 2, (0.0, 0.25 * y, 0.0), tips=((0.0, 0.18 * y, 0.0),)),
            Bone(f"{side}UpLeg", 0, (0.0, 0.1 * y, -0.05)), Bone(f"{side}Leg", first + 4, (0.0, 0.0, -0.42)),
            Bone(f"{side}Foot", first + 5, (0.0, 0.0, -0.41), tips=((0.2, 0.0, -0.05),)),
        ]
    balls = [bones[0], *(Bone(b.name, b.parent, b.offset, BALL, XYZ, b.tips) for b in bones[1:])]
    return Skeleton("human", tuple(balls))


def clip(skeleton: Skeleton, turned: dict[str, tuple[tuple[float, float, float], float]], frames: int = 1) -> Motion:
    """Return equal frames in which some bones are turned about an axis by degrees, relative to rest."""
    positions, rotations, angles = (np.repeat(array[None], frames, axis=0) for array in skeleton.still)
    names = [bone.name for bone in skeleton.bones]
    for name, (axis, degrees) in turned.items():
        rotations[:, names.index(name)] = rotation.from_axis_angle(axis, np.radians(degrees))
    return Motion(np.arange(frames) / 60.0, positions, rotations, angles)
