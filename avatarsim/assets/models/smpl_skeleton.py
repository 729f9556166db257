"""Kinematic trees of the SMPL family (Loper et al. 2015; SMPL-H, SMPL-X), and an approximate rest skeleton.

Joints and parents are facts of the format. The joint positions of a body come from the model's own files, which need a
licence of their user: with `J` from one of them a skeleton is exact. Otherwise it is constructed from segment lengths as shares
of stature (Drillis and Contini, in Winter 2009) in the family's rest pose, arms sideways, and notes state that.

The family's frames have x left, y up, z forward; here x is forward, y left, z up: (x, y, z) becomes (z, x, y), a rotation.
"""

import numpy as np

from avatarsim.assets.models.skeleton import Bone, Skeleton
from avatarsim.errors import InvalidInput
from avatarsim.scene.checks import Vector, within
from avatarsim.spatial.rotation import Array

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)

BODY = (
    ("pelvis", -1), ("left_hip", 0), ("right_hip", 0), ("spine1", 0), ("left_knee", 1), ("right_knee", 2), ("spine2", 3),
    ("left_ankle", 4), ("right_ankle", 5), ("spine3", 6), ("left_foot", 7), ("right_foot", 8), ("neck", 9), ("left_collar", 9),
    ("right_collar", 9), ("head", 12), ("left_shoulder", 13), ("right_shoulder", 14), ("left_elbow", 16), ("right_elbow", 17),
    ("left_wrist", 18), ("right_wrist", 19),
)
"""Names and parents of the joints that all three have."""

FACE = (("jaw", 15), ("left_eye", 15), ("right_eye", 15))
FINGERS = ("index", "middle", "pinky", "ring", "thumb")


def _hands(first: int) -> tuple[tuple[str, int], ...]:
    """Return three joints a finger, left hand first; `first` is the number of the first of them."""
    found: list[tuple[str, int]] = []
    for side, wrist in (("left", 20), ("right", 21)):
        for finger in FINGERS:
            for k in (1, 2, 3):
                found.append((f"{side}_{finger}{k}", wrist if k == 1 else first + len(found) - 1))
    return tuple(found)


TREES = {
    "SMPL": (*BODY, ("left_hand", 20), ("right_hand", 21)),
    "SMPL-H": (*BODY, *_hands(22)),
    "SMPL-X": (*BODY, *FACE, *_hands(25)),
}
"""Names and parents of 24, 52 and 55 joints, in the order of the poses."""

STATURE = 1.7
"""Stature [m] of the approximate skeleton."""

LEAST_STATURE, MOST_STATURE = 0.4, 2.6
"""Statures [m] of humans, newborns and giants included."""

MIDDLE = {
    "pelvis": (0.0, 0.0, 0.0), "spine1": (-0.01, 0.0, 0.065), "spine2": (0.0, 0.0, 0.08), "spine3": (0.0, 0.0, 0.03),
    "neck": (-0.005, 0.0, 0.105), "head": (0.015, 0.0, 0.05), "jaw": (0.01, 0.0, 0.01),
}
"""Offsets from the parent as shares of stature: forward, left, up."""

LEFT = {
    "hip": (0.0, 0.045, -0.045), "knee": (0.0, 0.0, -0.245), "ankle": (-0.01, 0.0, -0.246), "foot": (0.07, 0.0, -0.025),
    "collar": (0.0, 0.04, 0.06), "shoulder": (0.0, 0.065, 0.015), "elbow": (0.0, 0.16, 0.0), "wrist": (0.0, 0.146, 0.0),
    "hand": (0.0, 0.045, 0.0), "eye": (0.04, 0.018, 0.035),
    "index1": (0.014, 0.052, 0.0), "middle1": (0.002, 0.054, 0.0), "ring1": (-0.009, 0.050, 0.0), "pinky1": (-0.019, 0.044, 0.0),
    "thumb1": (0.014, 0.015, -0.006),
    **{f"{finger}{k}": (0.0, length, 0.0) for finger in ("index", "middle", "ring", "pinky")
       for k, length in ((2, 0.022 if finger != "pinky" else 0.017), (3, 0.014 if finger != "pinky" else 0.011))},
    "thumb2": (0.012, 0.014, -0.003), "thumb3": (0.010, 0.015, 0.0),
}
"""Offsets of the left side; the right one mirrors them."""

TIPS = {
    "head": ((0.0, 0.0, 0.10),), "foot": ((0.045, 0.0, -0.01),), "hand": ((0.0, 0.063, 0.0),),
    **{f"{finger}3": ((0.0, 0.012, 0.0),) for finger in ("index", "middle", "ring", "pinky")}, "thumb3": ((0.010, 0.015, 0.0),),
}
"""Ends of bones without another joint."""

PELVIS = (0.03, 0.0, -0.22)
"""Place [m] of the pelvis's joint against the family's origin, at rest, forward, left, up: about that of a mean body."""


def from_smpl_axes(vector: Array) -> Array:
    """Convert (x, y, z) of the family, shape (..., 3), to the axes used here."""
    return np.asarray(vector[..., [2, 0, 1]])


def to_smpl_axes(vector: Array) -> Array:
    """Convert (x, y, z) from the axes used here to the family's: the inverse of `from_smpl_axes`."""
    return np.asarray(vector[..., [1, 2, 0]])


def tree_of(joints: int) -> str | None:
    """Return the member of the family with so many joints; None where it has none."""
    return next((name for name, tree in TREES.items() if len(tree) == joints), None)


def approximate(member: str, stature: float = STATURE) -> tuple[Skeleton, Array]:
    """Return the approximate skeleton, and the pelvis's place (3,) [m] in the family's axes."""
    within("stature [m]", stature, LEAST_STATURE, MOST_STATURE, InvalidInput)
    bones = []
    for name, parent in TREES[member]:
        bones.append(_bone(name, parent, _sized(_share(name, MIDDLE, LEFT), stature), stature))
    return Skeleton(member, tuple(bones)), to_smpl_axes(np.array(PELVIS)) * stature / STATURE


def measured(member: str, joints: Array) -> tuple[Skeleton, Array]:
    """Return the skeleton of rest joints (n, 3) [m] in the family's axes, and the pelvis's place among them."""
    tree = TREES[member]
    places = from_smpl_axes(joints[: len(tree)])
    # tips are not joints: those of the approximate skeleton, scaled to the distances of the body's joints
    whole = approximate(member)[0].rest[: len(tree)]
    stature = STATURE * float(np.ptp(places[:, 2]) / np.ptp(whole[:, 2]))
    bones = []
    for k, (name, parent) in enumerate(tree):
        x, y, z = (float(v) for v in places[k] - (places[parent] if parent >= 0 else 0.0))
        bones.append(_bone(name, parent, (x, y, z), stature))
    return Skeleton(member, tuple(bones)), joints[0].copy()


def _bone(name: str, parent: int, offset: Vector, stature: float) -> Bone:
    part, side = _part(name)
    tips = tuple(_sized((x, side * y, z), stature) for x, y, z in TIPS.get(part, ()))
    return Bone(name, parent, offset, axes=(X, Y, Z), tips=tips)


def _part(name: str) -> tuple[str, float]:
    """Return the name without its side, and the sign of left."""
    for side, sign in (("left_", 1.0), ("right_", -1.0)):
        if name.startswith(side):
            return name.removeprefix(side), sign
    return name, 1.0


def _share(name: str, middle: dict[str, Vector], left: dict[str, Vector]) -> Vector:
    part, side = _part(name)
    x, y, z = middle.get(part) or left[part]
    return (x, side * y, z)


def _sized(share: Vector, stature: float) -> Vector:
    x, y, z = share
    return (x * stature, y * stature, z * stature)
