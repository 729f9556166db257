"""What the page says that engines do not have alike is what their adapters and presets do."""

import re

import pytest

from reference.in_mujoco.presets import SCENES as MUJOCO_SCENES
from reference.in_mujoco.presets import presets as mujoco_presets
from reference.presets import Kind
from reports.page.index import UNLIKE

SAID = next(sentence for sentence in UNLIKE if sentence.startswith("The same shapes"))
AVATARS = (Kind.DRIVEN, Kind.MIXED)


def test_what_mujoco_has_otherwise_is_said() -> None:
    planes = [scene for scene, own in MUJOCO_SCENES.items() if "floors" in own and own["floors"].value == "planes"]
    assert f"in {' and '.join(planes)} an infinite plane" in SAID
    share = float(re.search(r"armature of (\d+) %", SAID).group(1)) / 100.0  # type: ignore[union-attr]
    for kind in Kind:
        found = mujoco_presets(kind)
        assert found["default"]["armature"].value == 0.0 and found["default"]["floors"].value == "boxes"
        assert found["tuned"]["armature"].value == (share if kind in AVATARS else 0.0)
    assert not any("armature" in own for own in MUJOCO_SCENES.values())


def test_what_pybullet_has_otherwise_is_said() -> None:
    pytest.importorskip("pybullet", exc_type=ImportError)
    from reference.in_pybullet.presets import SCENES, presets
    from reference.in_pybullet.shapes import MOST_PIECES
    from reference.in_pybullet.stand_ins import ELLIPSOID_VERTICES
    from reference.in_pybullet.world import BETWEEN_HINGES

    assert f"hulls of {ELLIPSOID_VERTICES} points" in SAID and f"at most {MOST_PIECES} pieces a body" in SAID
    assert f"stand-in links of {100.0 * BETWEEN_HINGES:g} % of a link's mass" in SAID
    for kind in Kind:
        default, tuned = presets(kind)["default"], presets(kind)["tuned"]
        margins = [float(str(preset["collision_margin"].value)) for preset in (default, tuned)]
        assert f"inflated by {1e3 * margins[0]:g} mm by default and by {1e6 * margins[1]:g} um tuned" in SAID
        for word in ("boxes_as_hulls", "pieces_as_links"):
            assert default[word].value is False and tuned[word].value is (kind in AVATARS)
    assert not any(word in own for own in SCENES.values() for word in ("boxes_as_hulls", "collision_margin"))


def test_the_rig_is_said_of_each_engine() -> None:
    rig = next(sentence for sentence in UNLIKE if "The rig of MuJoCo" in sentence)
    for words in ("MuJoCo is one weld per link", "mujoco/servos a weld of the root", "PyBullet one constraint of the root"):
        assert words in rig
