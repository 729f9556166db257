"""A human avatar from a recorded skeleton: capsules, masses, joints, pairs that may overlap, and gaps."""

from dataclasses import replace

import numpy as np
import pytest

import avatarsim as av
from avatarsim.assets.models.from_skeleton import human
from avatarsim.assets.models.skeleton import Bone, Skeleton
from avatarsim.scene.written import written
from tests.assets.models.recorded import BALL, XYZ, clip, human_skeleton
from tests.assets.motions.robots import driven

SKELETON = human_skeleton()


def test_joints_are_the_skeletons_and_masses_a_bodys() -> None:
    model = human(SKELETON, 1.7, clip(SKELETON, {}), mass=80.0)
    assert model.avatar is not None and model.coordinates is not None and model.bodies == ()
    links = model.avatar.links
    assert [link.name for link in links] == [bone.name for bone in SKELETON.bones]
    assert isinstance(links[0].joint, av.Free) and all(isinstance(link.joint, av.Ball) for link in links[1:])
    mass = {link.name: link.mass.mass for link in links}
    assert sum(mass.values()) == pytest.approx(80.0)
    assert mass["LeftArm"] == pytest.approx(80.0 * 0.0271) and mass["RightUpLeg"] == pytest.approx(80.0 * 0.1416)
    assert mass["Hips"] + mass["Spine"] + mass["LeftShoulder"] + mass["RightShoulder"] == pytest.approx(80.0 * 0.4346)
    assert model.coordinates.names == tuple(bone.name for bone in SKELETON.bones) and model.coordinates.width == 7 + 4 * 17


def test_capsules_lie_between_joints_and_end_at_tips() -> None:
    avatar = driven(human(SKELETON, 1.7, clip(SKELETON, {}))).avatar
    links = {link.name: link for link in avatar.links}
    (shank,) = links["LeftLeg"].pieces
    assert isinstance(shank.shape, av.Capsule) and shank.shape.length == pytest.approx(0.41)
    assert shank.position == pytest.approx((0.0, 0.0, -0.205)) and 0.04 < shank.shape.radius < 0.05
    knee, thigh = (piece.shape for piece in links["LeftUpLeg"].pieces)
    assert isinstance(knee, av.Capsule) and isinstance(thigh, av.Capsule)
    assert knee.length == pytest.approx(0.42) and thigh.length < knee.length and knee.radius < thigh.radius < 0.1
    (hand,) = links["LeftHand"].pieces
    assert isinstance(hand.shape, av.Capsule)
    assert hand.position[1] + 0.5 * hand.shape.length + hand.shape.radius == pytest.approx(0.18)
    assert len(links["Hips"].pieces) == 3 and len(links["Spine"].pieces) == 3


def test_pairs_that_overlap_when_standing_may_be_no_deeper() -> None:
    model = driven(human(SKELETON, 1.7, clip(SKELETON, {})))
    pairs = {pair[:2] for pair in model.avatar.at_rest}
    assert ("Hips", "Neck") not in pairs and ("Spine", "LeftArm") in pairs and not model.avatar.ignore
    assert not {"LeftHand", "LeftFoot"} & {name for pair in pairs for name in pair}
    # arms in the thighs in the first frame, or anywhere else
    down = clip(SKELETON, {"LeftArm": ((1.0, 0.0, 0.0), -99.0), "RightArm": ((1.0, 0.0, 0.0), 99.0)})
    assert written(human(SKELETON, 1.7, down).avatar) == written(model.avatar)
    with av.AvatarsimEngine() as engine:
        engine.load(av.Scene("room", avatars=(model.avatar,), start=clip(SKELETON, {}).sample(0)), av.Settings(), 1.0 / 60.0)


def test_a_folded_skeleton_excludes_what_is_near_alone() -> None:
    """Legs and arms folded onto the trunk at rest overlap it all over, which implies nothing."""
    along = [(float(np.linalg.norm(bone.offset)), 0.0, 0.0) for bone in SKELETON.bones]
    flat = (replace(bone, offset=offset) for bone, offset in zip(SKELETON.bones, along, strict=True))
    folded = Skeleton("folded", tuple(flat))
    model = human(folded, 1.7, clip(folded, {}))
    assert model.avatar is not None and model.notes
    assert all(isinstance(link.joint, av.Free) or link.joint == av.Ball() for link in model.avatar.links)


def test_hinges_and_rigid_joints_keep_their_order() -> None:
    bones = list(SKELETON.bones)
    at = {bone.name: k for k, bone in enumerate(bones)}
    bones[at["LeftLeg"]] = replace(bones[at["LeftLeg"]], axes=(BALL[2], BALL[1]), turns=("z", "y"))
    bones[at["LeftHand"]] = replace(bones[at["LeftHand"]], axes=(), turns=())
    skeleton = Skeleton("human", tuple(bones))
    model = driven(human(skeleton, 1.7, clip(skeleton, {}), limits=False))
    knee = model.avatar.links[at["LeftLeg"]].joint
    assert knee == av.Hinges((av.Hinge(BALL[2]), av.Hinge(BALL[1]))) and model.avatar.links[at["LeftHand"]].joint == av.Rigid()
    assert [name for name in model.coordinates.names if "LeftLeg" in name] == ["LeftLeg z", "LeftLeg y"]
    assert "LeftHand" not in model.coordinates.names and all(link.joint == av.Ball() for link in model.avatar.links[1:4])


def test_unknown_names_have_radii_and_masses_by_length() -> None:
    bones = (
        Bone("Thing", -1, (0.0, 0.0, 0.0)), Bone("A", 0, (0.0, 0.0, 0.5), BALL, XYZ),
        Bone("B", 1, (0.0, 0.0, 0.5), BALL, XYZ, ((0.0, 0.0, 0.4),)),
        Bone("Marker", 2, (0.0, 0.0, 0.0), BALL, XYZ),
    )
    skeleton = Skeleton("thing", bones)
    model = human(skeleton, 1.4, clip(skeleton, {}))
    assert model.avatar is not None and len(model.notes) >= 2
    first = model.avatar.links[0].pieces[0].shape
    assert isinstance(first, av.Capsule) and first.radius == pytest.approx(0.075)
    assert model.avatar.links[0].mass.mass == pytest.approx(model.avatar.links[1].mass.mass)
    assert model.avatar.links[3].pieces == () and model.avatar.links[2].joint == av.Ball()


def test_a_root_on_the_floor_and_end_joints_have_no_body() -> None:
    bones = [Bone("Reference", -1, (0.0, 0.0, 0.0)), Bone("Hips", 0, (0.0, 0.0, 0.9), BALL, XYZ)]
    bones += [replace(bone, parent=bone.parent + 1, tips=()) for bone in SKELETON.bones[1:]]
    bones.append(Bone("Head_End", 4, (0.0, 0.0, 0.2), BALL, XYZ))
    skeleton = Skeleton("human", tuple(bones))
    avatar = human(skeleton, 1.7, clip(skeleton, {})).avatar
    assert avatar is not None and avatar.links[0].pieces == () and avatar.links[-1].pieces == () and avatar.links[1].pieces
    (head,) = avatar.links[4].pieces
    assert isinstance(head.shape, av.Capsule)
    assert head.position[2] + 0.5 * head.shape.length + head.shape.radius == pytest.approx(0.2, abs=0.02)
    (hand,) = next(link.pieces for link in avatar.links if link.name == "LeftHand")
    assert isinstance(hand.shape, av.Sphere)
