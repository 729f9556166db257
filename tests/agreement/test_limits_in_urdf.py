"""Bullet's ball joints have limits where a URDF file gives them; what our adapter says of them, and whose lack it is.

Model and words of the limit: `spherical_joint_limit.urdf` of pybullet_data.
"""

import math
from collections.abc import Iterator
from pathlib import Path

import pytest

pybullet = pytest.importorskip("pybullet", exc_type=ImportError)
pybullet_data = pytest.importorskip("pybullet_data", exc_type=ImportError)

from reference.in_pybullet.presets import DEFAULT  # noqa: E402
from runfiles.engines import about  # noqa: E402

LIMIT = '<limit effort="1000.0" lower="0.2" upper=".8" twist=".3"/>'
SECONDS, STEP = 5.0, 1.0 / 240.0


@pytest.fixture
def client() -> Iterator[int]:
    made = pybullet.connect(pybullet.DIRECT)
    yield made
    pybullet.disconnect(physicsClientId=made)


def swung(client: int, path: Path) -> float:
    """Angle [rad] at which the free ball joint of a model rests that gravity draws along x."""
    body = pybullet.loadURDF(str(path), [0.0, 0.0, 2.0], useFixedBase=True, physicsClientId=client)
    pybullet.setJointMotorControlMultiDof(
        body, 0, controlMode=pybullet.POSITION_CONTROL, targetPosition=[0.0, 0.0, 0.0, 1.0], targetVelocity=[0.0] * 3,
        velocityGain=0.0, force=[0.0] * 3, physicsClientId=client,
    )
    pybullet.setGravity(9.0, 0.0, 0.0, physicsClientId=client)
    for _ in range(round(SECONDS / STEP)):
        pybullet.stepSimulation(physicsClientId=client)
    x, y, z, w = pybullet.getJointStateMultiDof(body, 0, physicsClientId=client)[0]
    return 2.0 * math.atan2(math.hypot(x, y, z), abs(w))


@pytest.mark.parametrize("upper", [0.4, 0.8])
def test_a_ball_joint_of_a_file_stops_at_its_limit(client: int, tmp_path: Path, upper: float) -> None:
    told = (Path(pybullet_data.getDataPath()) / "spherical_joint_limit.urdf").read_text()
    assert LIMIT in told
    path = tmp_path / "limited.urdf"
    path.write_text(told.replace(LIMIT, LIMIT.replace(".8", str(upper))))
    assert swung(client, path) == pytest.approx(upper, abs=1e-3)


def test_a_ball_joint_of_a_file_without_limits_goes_on(client: int, tmp_path: Path) -> None:
    told = (Path(pybullet_data.getDataPath()) / "spherical_joint_limit.urdf").read_text()
    path = tmp_path / "free.urdf"
    path.write_text(told.replace(LIMIT, ""))
    assert swung(client, path) > 1.2


@pytest.mark.parametrize("word", [
    "linkLowerLimits", "linkUpperLimits", "linkJointLowerLimits", "linkJointUpperLimits", "linkJointLimits",
])
def test_a_body_made_by_calls_has_no_word_for_limits(client: int, word: str) -> None:
    with pytest.raises(TypeError, match="invalid keyword"):
        pybullet.createMultiBody(0.0, physicsClientId=client, **{word: [1.0]})


def test_limits_that_bullet_has_are_no_lack_of_the_engine() -> None:
    """Whose lack it is that PyBullet's ball joints go beyond their limits: our adapter's, which makes bodies by calls."""
    lacking = about("pybullet").unsupported["ball limits"]
    assert lacking.lacks == "adapter" and "joint_limit_excess_max" in lacking.metrics
    found = [issue for issue in about("pybullet").issues if "createMultiBody" in issue.text]
    assert found and all(issue.cause == "adapter" for issue in found)


def test_a_constraint_as_it_is_made_has_the_force_that_its_reason_names(client: int) -> None:
    body = pybullet.createMultiBody(1.0, physicsClientId=client)
    made = pybullet.createConstraint(body, -1, -1, -1, pybullet.JOINT_FIXED, *[[0.0] * 3] * 3, physicsClientId=client)
    force = pybullet.getConstraintInfo(made, physicsClientId=client)[10]
    assert f"as it is made has {force:g}" in DEFAULT["root_force"].reason
    assert DEFAULT["root_force"].value != force and "our setting" in DEFAULT["root_force"].reason
