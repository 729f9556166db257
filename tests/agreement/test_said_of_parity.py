"""What the page of engines says that a scene has otherwise in them is what their adapters and presets do."""

import pytest

from reference.in_mujoco.presets import SCENES as MUJOCO_SCENES
from reference.in_mujoco.presets import presets as mujoco_presets
from reference.presets import Kind
from runfiles.engines import about

AVATARS = (Kind.DRIVEN, Kind.MIXED)


def said(engine: str, *words: str) -> bool:
    """Whether one sentence on an engine has all of these words."""
    return any(all(word in one for word in words) for one in about(engine).unlike)


def test_what_mujoco_has_otherwise_is_said() -> None:
    planes = [scene for scene, own in MUJOCO_SCENES.items() if "floors" in own and own["floors"].value == "planes"]
    assert planes and said("mujoco", "infinite plane", *planes)
    shares = set()
    for kind in Kind:
        found = mujoco_presets(kind)
        assert found["default"]["armature"].value == 0.0 and found["default"]["floors"].value == "boxes"
        share = float(str(found["tuned"]["armature"].value))
        assert (share > 0.0) is (kind in AVATARS)
        shares.add(share)
    (share,) = shares - {0.0}
    assert said("mujoco", f"armature of {100.0 * share:g} %")
    assert not any("armature" in own for own in MUJOCO_SCENES.values())


def test_what_pybullet_has_otherwise_is_said() -> None:
    pytest.importorskip("pybullet", exc_type=ImportError)
    from reference.in_pybullet.presets import SCENES, presets
    from reference.in_pybullet.shapes import MOST_PIECES
    from reference.in_pybullet.stand_ins import ELLIPSOID_VERTICES
    from reference.in_pybullet.world import BETWEEN_HINGES

    assert said("pybullet", f"hulls of {ELLIPSOID_VERTICES} points") and said("pybullet", f"at most {MOST_PIECES} pieces")
    assert said("pybullet", f"links of {100.0 * BETWEEN_HINGES:g} % of the mass")
    for kind in Kind:
        default, tuned = presets(kind)["default"], presets(kind)["tuned"]
        margins = [float(str(preset["collision_margin"].value)) for preset in (default, tuned)]
        assert said("pybullet", f"inflated by {1e3 * margins[0]:g} mm by default, by {1e6 * margins[1]:g} µm in tuned")
        for word in ("boxes_as_hulls", "pieces_as_links"):
            assert default[word].value is False and tuned[word].value is (kind in AVATARS)
    assert not any(word in own for own in SCENES.values() for word in ("boxes_as_hulls", "collision_margin"))


@pytest.mark.parametrize(("engine", "words"), [
    ("mujoco", ("one weld per link", "a weld of the root and a servo per joint")),
    ("pybullet", ("one constraint of the root", "a motor per joint")),
])
def test_the_rig_is_said_of_each_engine(engine: str, words: tuple[str, ...]) -> None:
    assert said(engine, *words)
