"""Two traps of MuJoCo that are not stepped into: its depth of a capsule in a box, and actuators that leak through walls."""

import mujoco
import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece
from avatarsim.spatial import rotation
from reference.in_mujoco.engine import MujocoEngine
from reference.judging.judge import Judge
from tests.agreement.runs import FRAME
from tests.agreement.scenes import arm, hand_over_table

HALF = np.array([0.2, 0.15, 0.1])
"""Half edges of the box [m]."""
RADIUS, LONG = 0.03, 0.3
"""Of the capsule [m]."""
NET = 2e-3
"""What the net may miss [m]: neighbours are 8 mrad off at most, and the farthest corners 0.25 m away."""
BESIDE = """
<mujoco><option gravity="0 0 0"/><worldbody><geom type="box" size="0.2 0.15 0.1"/>
<body><freejoint/><geom type="capsule" size="0.03 0.15"/></body></worldbody></mujoco>
"""
DRIVEN = """
<mujoco><option gravity="0 0 0" timestep="{step}" integrator="{integrator}"><flag refsafe="disable"/></option>
<default><geom solref=".002 1" solimp=".9999 .9999 .001"/></default>
<worldbody><geom type="box" size="0.5 1 1" pos="0.7 0 0"/>
<body><joint name="x" type="slide" axis="1 0 0"/><geom type="sphere" size="0.03" mass="0.5"/></body></worldbody>
<actuator><general joint="x" gainprm="1000" biastype="affine" biasprm="0 -1000 -40"/></actuator></mujoco>
"""
"""A hand on a servo of K = 1000, R = 40 before a wall whose face is at 0.2 m."""


def sampled_depth(place: np.ndarray, turn: np.ndarray) -> float:
    """The least way out over all directions of a fine net: at least the depth, and NET more at most."""
    k = np.arange(60_000) + 0.5
    z, around = 1.0 - 2.0 * k / 60_000, np.pi * (1.0 + np.sqrt(5.0)) * k
    net = np.stack([np.sqrt(1.0 - z * z) * np.cos(around), np.sqrt(1.0 - z * z) * np.sin(around), z], axis=1)
    along = rotation.rotate(turn, np.array([0.0, 0.0, 0.5 * LONG]))
    net = np.vstack([net, np.eye(3), -np.eye(3)])
    # support of the box minus that of the capsule from the other side
    return float(np.min(np.abs(net) @ HALF + np.abs(net @ along) + RADIUS + net @ -place))


def capsules() -> list[tuple[np.ndarray, np.ndarray]]:
    """Capsules whose middle is in the box, anyhow."""
    random = np.random.default_rng(0)
    turns = random.normal(size=(40, 4))
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    return list(zip(random.uniform(-1.0, 1.0, (40, 3)) * HALF, turns, strict=True))


def test_7_mujoco_underrates_a_capsule_deep_in_a_box() -> None:
    """The trap is real: most depths are wrong, by up to some centimetres."""
    model = mujoco.MjModel.from_xml_string(BESIDE)
    data, short = mujoco.MjData(model), []
    for place, turn in capsules():
        data.qpos[:3], data.qpos[3:] = place, turn
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        own = max([0.0, *(-contact.dist for contact in data.contact)])
        short.append(sampled_depth(place, turn) - own)
    assert np.mean(np.array(short) > 1e-3) > 0.5 and max(short) > 0.05


def test_7_the_judge_does_not() -> None:
    pieces = (Piece(Capsule(RADIUS, LONG)),)
    box = fixed("box", (Piece(Box((0.4, 0.3, 0.2))),), "wood")
    judge = Judge(Scene("deep", (box, simulated("capsule", pieces, "wood", solid(pieces, 1.0)))))
    for place, turn in capsules():
        found = judge.overlaps(np.array([[0.0, 0.0, 0.0], place]), np.array([[1.0, 0.0, 0.0, 0.0], turn])).deepest
        sampled = sampled_depth(place, turn)
        assert sampled - NET <= found <= sampled + 1e-9


def held(integrator: str) -> float:
    """How deep [m] the servo's hand is in the wall after it was held 10 cm inside for two seconds."""
    model = mujoco.MjModel.from_xml_string(DRIVEN.format(step=1.0 / 60.0, integrator=integrator))
    data = mujoco.MjData(model)
    for frame in range(120):
        data.ctrl[0] = min(0.27, (frame + 1) / 60.0)
        mujoco.mj_step(model, data)
    return abs(float(data.qpos[0]) - 0.17)


def test_9_a_servo_with_damping_leaks_through_walls_unless_the_step_is_discrete() -> None:
    """The trap is real: held in the wall, or thrown out of the world, under IMPLICITFAST."""
    assert held("implicitfast") > 1e-3
    assert held("discrete") < 1e-4


@pytest.mark.parametrize("preset", ["default", "tuned"])
@pytest.mark.parametrize("scene", [hand_over_table(), arm()], ids=["hand", "arm"])
def test_9_no_scene_is_driven_by_an_actuator(scene: Scene, preset: str) -> None:
    """Links are welded to mocap bodies: no servo, so no damping outside the constraint that a step would leave out."""
    engine = MujocoEngine()
    engine.load(scene, Settings(preset), FRAME)
    model = engine._world.model
    assert model.nu == 0 and model.neq >= len(scene.links)
    assert not model.dof_damping.any()
    engine.close()
