"""Body parts by names of joints, in the conventions of recordings, and segments of the body."""

import numpy as np
import pytest

from avatarsim.assets.models.anthropometry import SEGMENT_OF, SEGMENTS, Part, parts
from avatarsim.assets.models.skeleton import Bone, Skeleton

CMU = {
    "root": "pelvis", "lhipjoint": "hip bone left", "lfemur": "thigh left", "ltibia": "shank left", "lfoot": "foot left",
    "ltoes": "toe left", "lowerback": "spine", "upperback": "spine", "thorax": "spine", "lowerneck": "neck", "upperneck": "neck",
    "head": "head", "rclavicle": "clavicle right", "rhumerus": "upper arm right", "rradius": "forearm right",
    "rwrist": "hand right",
    "rhand": "hand right", "rfingers": "finger right", "rthumb": "thumb right",
}
LAFAN = {
    "Hips": "pelvis", "LeftUpLeg": "thigh left", "LeftLeg": "shank left", "LeftFoot": "foot left", "LeftToe": "toe left",
    "Spine": "spine", "Spine1": "spine", "Spine2": "spine", "Neck": "neck", "Head": "head",
}
LAFAN_ARM = {"LeftShoulder": "clavicle left", "LeftArm": "upper arm left", "LeftForeArm": "forearm left", "LeftHand": "hand left"}
MIXAMO = {
    "mixamorig:Hips": "pelvis", "mixamorig:RightUpLeg": "thigh right", "mixamorig:RightLeg": "shank right",
    "mixamorig:RightToeBase": "toe right", "mixamorig:RightHandIndex1": "finger right",
    "mixamorig:RightHandThumb2": "thumb right",
}
DAZ = {
    "hip": "pelvis", "abdomen": "spine", "chest": "spine", "rCollar": "clavicle right", "rShldr": "upper arm right",
    "rForeArm": "forearm right", "rHand": "hand right", "rThumb1": "thumb right", "rMid2": "finger right",
    "lButtock": "hip bone left", "lThigh": "thigh left", "lShin": "shank left", "leftEye": "face",
}
SOMA = {
    "Hips": "pelvis", "Chest": "spine", "Neck1": "neck", "LeftLeg": "thigh left", "LeftShin": "shank left",
    "LeftToeBase": "toe left",
}
MAX = {
    "Bip01": "", "Bip01 Pelvis": "pelvis", "Bip01 L Thigh": "thigh left", "Bip01 L Calf": "shank left",
    "Bip01 R UpperArm": "upper arm right",
}
ANKLES = {"Hips": "pelvis", "LeftHip": "thigh left", "LeftKnee": "shank left", "LeftAnkle": "foot left"}
ELBOWS = {"Chest": "spine", "RightShoulder": "upper arm right", "RightElbow": "forearm right", "RightWrist": "hand right"}
STRANGE = {"Prop": "", "Camera": "", "Bone_07": "", "LeftWing": "", "Larm": "upper arm left", "thumb.R": "thumb right"}


@pytest.mark.parametrize("named", [CMU, LAFAN, LAFAN_ARM, MIXAMO, DAZ, SOMA, MAX, ANKLES, ELBOWS, STRANGE])
def test_names_say_parts(named: dict[str, str]) -> None:
    """Each convention as a chain: `shoulder` and `leg` are identified by their children and parents."""
    skeleton = Skeleton("chain", tuple(Bone(name, k - 1, (0.0, 0.0, 0.1)) for k, name in enumerate(named)))
    found = parts(skeleton)
    said = {name: f"{part.kind} {part.side}".strip() for name, part in zip(named, found, strict=True)}
    said = {name: one.removesuffix(" left") if one.startswith("face") else one for name, one in said.items()}
    assert said == named


def test_segments_are_a_whole_body() -> None:
    limbs = {"upper arm", "forearm", "hand", "thigh", "shank", "foot"}
    assert sum(one.share * (2 if name in limbs else 1) for name, one in SEGMENTS.items()) == pytest.approx(1.0, abs=1e-9)
    assert set(SEGMENT_OF.values()) == set(SEGMENTS)
    assert Part("", "") == parts(Skeleton("one", (Bone("thing", -1, (0.0, 0.0, 0.0)),)))[0]


@pytest.mark.parametrize("name", sorted(SEGMENTS))
def test_radii_give_back_the_volume(name: str) -> None:
    segment = SEGMENTS[name]
    radius = segment.radius(75.0, 1.741)
    volume = np.pi * radius**2 * segment.wider * segment.length
    assert volume * segment.density == pytest.approx(75.0 * segment.share)
    assert segment.radius(150.0, 1.741) == pytest.approx(radius * np.sqrt(2.0))
