"""Limits by the names of joints: human postures are inside, others are not, left and right alike."""

from dataclasses import replace

import numpy as np
import pytest

import avatarsim as av
from avatarsim.assets.models.ball_limits import ball_excess, beyond_limits
from avatarsim.assets.models.from_skeleton import human
from avatarsim.assets.models.skeleton import Skeleton
from avatarsim.model.joint_limits import cone_excess
from avatarsim.model.skeleton import skeleton as skeleton_of
from avatarsim.scene.joint import Ball
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from avatarsim.spatial.tangent import Columns
from tests.assets.models.recorded import clip, human_skeleton
from tests.assets.motions.robots import driven

SKELETON = human_skeleton()
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)

# joint, axis and degrees relative to a T pose that faces +x, whether a human can: for the left side
POSTURES = [
    ("LeftLeg", Y, 120.0, True), ("LeftLeg", Y, -30.0, False), ("LeftLeg", X, 30.0, False), ("LeftLeg", Y, 175.0, False),
    ("LeftUpLeg", Y, -110.0, True), ("LeftUpLeg", Y, 35.0, True), ("LeftUpLeg", Y, 75.0, False), ("LeftUpLeg", X, 45.0, True),
    ("LeftUpLeg", Z, 90.0, False), ("LeftForeArm", Z, -140.0, True), ("LeftForeArm", Z, 40.0, False),
    ("LeftForeArm", Y, 80.0, True),
    ("LeftForeArm", Y, 120.0, False), ("LeftArm", X, -85.0, True), ("LeftArm", X, 90.0, True), ("LeftArm", Z, -90.0, True),
    ("LeftArm", Z, -120.0, True), ("LeftArm", Z, 100.0, False), ("LeftArm", Y, 70.0, True), ("LeftHand", X, -75.0, True),
    ("LeftHand", X, 120.0, False), ("Spine", Y, 70.0, True), ("Spine", Y, -80.0, False), ("Spine", Z, 40.0, True),
    ("Spine", Z, 90.0, False), ("Head", Z, 75.0, True), ("Head", Z, 130.0, False), ("LeftFoot", Y, -20.0, True),
    ("LeftFoot", Y, 90.0, False),
]


def mirrored(joint: str, axis: tuple[float, float, float], degrees: float) -> tuple[str, tuple[float, float, float], float]:
    """Return the posture of the other side: turns about x and z change sign in a mirror at y = 0."""
    return joint.replace("Left", "Right"), axis, degrees if axis == Y else -degrees


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("joint, axis, degrees, can", POSTURES)
def test_limits_hold_what_humans_can_do(
    joint: str, axis: tuple[float, float, float], degrees: float, can: bool, side: str
) -> None:
    if side == "right":
        joint, axis, degrees = mirrored(joint, axis, degrees)
    avatar = driven(human(SKELETON, 1.7, clip(SKELETON, {}))).avatar
    found = beyond_limits(avatar, clip(SKELETON, {joint: (axis, degrees)}, frames=3))
    assert [(one.joint, one.frames) for one in found] == ([] if can else [(joint, 3)])


@pytest.mark.parametrize("joint, axis, degrees, can", POSTURES)
def test_hinges_have_the_range_of_their_movement(joint: str, axis: tuple[float, float, float], degrees: float, can: bool) -> None:
    """The same postures, by a hinge about that axis; the shoulder's cone is no range of one hinge."""
    if joint == "LeftArm" or (joint, axis) == ("LeftLeg", X):
        return
    at = [bone.name for bone in SKELETON.bones].index(joint)
    bones = list(SKELETON.bones)
    bones[at] = replace(bones[at], axes=(axis,), turns=("r",))
    skeleton = Skeleton("human", tuple(bones))
    avatar = driven(human(skeleton, 1.7, clip(skeleton, {}))).avatar
    still = clip(skeleton, {})
    turned = Motion(still.times, still.positions, still.rotations, np.array([[np.radians(degrees)]]))
    assert (beyond_limits(avatar, turned) == ()) == can


def test_a_stance_in_the_clip_stands_for_a_folded_rest() -> None:
    """The skeleton has each bone's frame turned arbitrarily: the limits are the same, counted from a standing frame."""
    random = np.random.default_rng(5)
    turned = rotation.normalised(random.normal(size=(len(SKELETON.bones), 4)))
    turned[0] = rotation.IDENTITY
    bones = []
    for k, bone in enumerate(SKELETON.bones):
        above, own = rotation.conjugate(turned[max(bone.parent, 0)]), rotation.conjugate(turned[k])
        offset, tips = rotation.rotate(above, bone.offset), [rotation.rotate(own, tip) for tip in bone.tips]
        bones.append(replace(bone, offset=tuple(offset) if k else bone.offset, tips=tuple(tuple(tip) for tip in tips)))
    skeleton = Skeleton("human", tuple(bones))

    def posture(joint: str, axis: tuple[float, float, float], degrees: float) -> Motion:
        own = clip(SKELETON, {joint: (axis, degrees)}).rotations
        parents = turned[[max(bone.parent, 0) for bone in SKELETON.bones]]
        local = rotation.multiply(rotation.conjugate(parents), rotation.multiply(own, turned))
        return replace(clip(skeleton, {}), rotations=local)

    model = driven(human(skeleton, 1.7, posture("Hips", X, 0.0)))
    for joint, axis, degrees, can in POSTURES:
        found = beyond_limits(model.avatar, posture(joint, axis, degrees))
        # a twist limit that would cross half a turn is left out, so that more may be allowed
        assert found == () if can else [one.joint for one in found] in ([joint], [])
    assert any(isinstance(link.joint, av.Ball) and link.joint.limits is not None for link in model.avatar.links)


def columns(quaternion: np.typing.NDArray[np.float64]) -> Columns:
    """Return the columns of the matrix, as the kernels have them."""
    x, y, z = (tuple(float(v) for v in column) for column in rotation.to_matrix(quaternion).T)
    return x, y, z  # type: ignore[return-value]


@pytest.mark.parametrize("name", ["LeftArm", "RightArm", "LeftForeArm", "LeftLeg", "RightLeg", "RightUpLeg", "Spine", "LeftFoot"])
def test_excess_is_the_engine_s(name: str) -> None:
    """Random turns of the joints of a human avatar, knees with a reach cone among them."""
    skeleton = human_skeleton()
    avatar = driven(human(skeleton, 1.7, clip(skeleton, {}))).avatar
    skel = skeleton_of(Scene("room", avatars=(avatar,)))
    link = [link.name for link in avatar.links].index(name)
    joint = avatar.links[link].joint
    assert isinstance(joint, Ball) and (joint.cone is not None) == ("Leg" in name and "Up" not in name)
    turned = rotation.normalised(np.random.default_rng(6).normal(size=(400, 4)))
    found = ball_excess(joint, turned)
    for one, quaternion in zip(found, turned, strict=True):
        assert max(0.0, cone_excess(skel.balls, link, columns(quaternion))) == pytest.approx(one, abs=1e-9)
    assert (found > 0.1).any() and (ball_excess(joint, rotation.from_rotation_vector(np.zeros((1, 3)))) == 0.0).all()
