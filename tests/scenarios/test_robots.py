"""Robots of installed packages go through the Shield without overlap of their own geoms, by MuJoCo's distance."""

from importlib.util import find_spec
from pathlib import Path

import pytest

import avatarsim as av
from scenarios.robots import OwnGeoms, drive, driven

PACKAGE = Path(next(iter(find_spec("pybullet_data").submodule_search_locations)))  # type: ignore[union-attr, arg-type]
KUKA = PACKAGE / "kuka_iiwa" / "model.urdf"


@pytest.mark.parametrize("path", [KUKA, PACKAGE / "xarm" / "xarm6_robot.urdf"])
def test_a_robot_never_overlaps_by_its_own_geoms(path: Path) -> None:
    found = drive(path, frames=40, seed=3, rate=60.0)
    assert found.kind == "robot" and found.joints >= 6 and found.overlap == 0.0 and found.is_kept
    assert 0.0 < found.free < 1.0 and 0.5 < found.acceleration


def test_the_judge_sees_what_the_motion_would_do() -> None:
    model = av.load_avatar(KUKA)
    judge = OwnGeoms(KUKA, model)
    assert max(judge.deepest(q)[0] for q in driven(model, 60, 3, 60.0)) > 0.01
