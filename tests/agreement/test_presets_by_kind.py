"""What the engines' page lists as different from a scene is set by the kind of the scene, and by no scene alone."""

import pytest

from reference.in_mujoco.presets import SCENES as MUJOCO_SCENES
from reference.in_mujoco.presets import presets as mujoco_presets
from reference.in_pybullet.presets import SCENES as PYBULLET_SCENES
from reference.in_pybullet.presets import presets as pybullet_presets
from reference.presets import Kind

AVATARS = (Kind.DRIVEN, Kind.MIXED)


@pytest.mark.parametrize("kind", Kind)
def test_only_tuned_scenes_with_avatars_change_their_bodies(kind: Kind) -> None:
    mujoco, pybullet = mujoco_presets(kind), pybullet_presets(kind)
    assert (mujoco["default"]["armature"].value, mujoco["tuned"]["armature"].value) == (0.0, 0.3 if kind in AVATARS else 0.0)
    assert mujoco["default"]["floors"].value == "boxes"
    for word in ("boxes_as_hulls", "pieces_as_links"):
        assert (pybullet["default"][word].value, pybullet["tuned"][word].value) == (False, kind in AVATARS)
    assert [pybullet[name]["collision_margin"].value for name in ("default", "tuned")] == [1e-3, 1e-6]


def test_no_scene_alone_changes_them() -> None:
    assert not any("armature" in own for own in MUJOCO_SCENES.values())
    assert not any(word in own for own in PYBULLET_SCENES.values() for word in ("boxes_as_hulls", "collision_margin"))
