"""Three hinges in place of a ball joint: equal posture at the start, and twist that stays within its range."""

import mujoco
import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput
from avatarsim.scene.joint import SwingTwist
from avatarsim.spatial import rotation
from reference.in_mujoco import three_hinges
from reference.in_mujoco.engine import MujocoEngine
from scenarios import catalog

LIMIT = SwingTwist((0.0, 0.6, -0.8), (0.0, 0.8, -0.6), 1.2, (-0.4, 0.9))


@pytest.mark.parametrize("seed", range(6))
def test_three_turns_by_its_angles_are_the_turn_of_the_ball(seed: int) -> None:
    rng = np.random.default_rng(seed)
    orientation, turn = (rotation.normalised(rng.normal(size=4)) for _ in range(2))
    found, made = three_hinges.angles(LIMIT, orientation, turn), three_hinges.middle(LIMIT)
    for axis, angle in zip(three_hinges.axes(LIMIT), found, strict=True):
        made = rotation.multiply(made, rotation.from_axis_angle(axis, angle))
    wanted = rotation.multiply(orientation, turn)
    assert abs(float(np.dot(made, wanted))) == pytest.approx(1.0, abs=1e-12) and abs(found[1]) <= 0.5 * np.pi
    assert np.allclose(rotation.rotate(three_hinges.middle(LIMIT), LIMIT.axis), LIMIT.centre)


def test_a_body_of_hinges_starts_as_one_of_balls() -> None:
    scenario, shown = catalog.get("mocap_spin"), {}
    scene, engine = scenario.build(), MujocoEngine()
    for joints in ("balls", "hinges"):
        shown[joints] = engine.load(scene, Settings("tuned", {"ball_joints": joints}), scenario.dt).shown
    assert np.allclose(shown["balls"].positions, shown["hinges"].positions, atol=1e-9)
    turned = np.abs(np.sum(shown["balls"].orientations * shown["hinges"].orientations, axis=1))
    assert np.allclose(turned, 1.0, atol=1e-12)
    model, motion = engine._model, scenario.motion(scene, 0)
    thirds = [j for j in range(model.njnt) if model.joint(j).name.endswith(".2")]
    assert len(thirds) > 3 and not (model.jnt_type == int(mujoco.mjtJoint.mjJNT_BALL)).any()
    beyond = 0.0
    for k in range(40):
        engine.advance(motion(k), scenario.dt)
        for j in thirds:
            low, high = model.jnt_range[j]
            angle = engine._data.qpos[model.jnt_qposadr[j]]
            beyond = max(beyond, low - angle, angle - high)
    assert beyond < np.radians(3.0)


def test_servos_are_in_balls_only() -> None:
    scenario = catalog.get("driven_10cm_wall")
    with pytest.raises(InvalidInput, match="ball_joints"):
        MujocoEngine().load(scenario.build(), Settings("servos", {"ball_joints": "hinges"}), scenario.dt)
