"""Excess of balls beyond their limits, in numpy, against the kernels of the engine."""

import numpy as np
import pytest

from avatarsim.assets.models.ball_limits import ball_excess
from avatarsim.assets.models.from_skeleton import human
from avatarsim.model.joint_limits import cone_excess
from avatarsim.model.skeleton import skeleton as skeleton_of
from avatarsim.scene.joint import Ball
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from avatarsim.spatial.tangent import Columns
from tests.assets.models.recorded import clip, human_skeleton


def columns(quaternion: np.typing.NDArray[np.float64]) -> Columns:
    """The columns of the matrix, as the kernels have them."""
    x, y, z = (tuple(float(v) for v in column) for column in rotation.to_matrix(quaternion).T)
    return x, y, z  # type: ignore[return-value]


@pytest.mark.parametrize("name", ["LeftArm", "RightArm", "LeftForeArm", "LeftLeg", "RightLeg", "RightUpLeg", "Spine", "LeftFoot"])
def test_excess_is_the_engine_s(name: str) -> None:
    """Random turns of the joints of a human avatar, knees with a reach cone among them."""
    skeleton = human_skeleton()
    avatar = human(skeleton, 1.7, clip(skeleton, {})).avatar
    assert avatar is not None
    skel = skeleton_of(Scene("room", avatars=(avatar,)))
    link = [link.name for link in avatar.links].index(name)
    joint = avatar.links[link].joint
    assert isinstance(joint, Ball) and (joint.cone is not None) == ("Leg" in name and "Up" not in name)
    turned = rotation.normalised(np.random.default_rng(6).normal(size=(400, 4)))
    found = ball_excess(joint, turned)
    for one, quaternion in zip(found, turned, strict=True):
        assert max(0.0, cone_excess(skel, link, columns(quaternion))) == pytest.approx(one, abs=1e-9)
    assert (found > 0.1).any() and (ball_excess(joint, rotation.from_rotation_vector(np.zeros((1, 3)))) == 0.0).all()

