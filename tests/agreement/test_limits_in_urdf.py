"""Bullet's ball joints have limits where a URDF file gives them; what our adapter says of them, and whose lack it is.

Model and words of the limit: `spherical_joint_limit.urdf` of pybullet_data.
"""

import math
from collections.abc import Iterator
from pathlib import Path

import pytest

pybullet = pytest.importorskip("pybullet", exc_type=ImportError)
pybullet_data = pytest.importorskip("pybullet_data", exc_type=ImportError)

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


@pytest.mark.parametrize("upper", [0.4, 0.8, None])
def test_a_ball_joint_of_a_file_stops_at_its_limit_if_it_has_one(client: int, tmp_path: Path, upper: float | None) -> None:
    model = (Path(pybullet_data.getDataPath()) / "spherical_joint_limit.urdf").read_text()
    assert LIMIT in model
    path = tmp_path / "model.urdf"
    path.write_text(model.replace(LIMIT, LIMIT.replace(".8", str(upper)) if upper else ""))
    angle = swung(client, path)
    assert angle == pytest.approx(upper, abs=1e-3) if upper else angle > 1.2


@pytest.mark.parametrize("word", [
    "linkLowerLimits", "linkUpperLimits", "linkJointLowerLimits", "linkJointUpperLimits", "linkJointLimits",
])
def test_a_body_made_by_calls_has_no_word_for_limits(client: int, word: str) -> None:
    with pytest.raises(TypeError, match="invalid keyword"):
        pybullet.createMultiBody(0.0, physicsClientId=client, **{word: [1.0]})


def test_limits_that_bullet_has_are_no_lack_of_the_engine() -> None:
    """The adapter makes bodies by calls."""
    lacking = about("pybullet").unsupported["ball limits"]
    assert lacking.lacks == "adapter" and "joint_limit_excess_max" in lacking.metrics
