"""The conversions of docs/units_and_frames.md, run as they are printed: handedness, round trips, known poses, other programs."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import solid
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import checked
from avatarsim.spatial import rotation

PAGE = (Path(__file__).parents[2] / "docs" / "units_and_frames.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)

FORWARD, LEFT, UP = np.eye(3)
"""Of avatarsim, by the choice of the page."""
AXES = {
    "openxr": {"forward": (0, 0, -1), "left": (-1, 0, 0), "up": (0, 1, 0)},
    "unity": {"forward": (0, 0, 1), "left": (-1, 0, 0), "up": (0, 1, 0)},
    "ros": {"forward": (1, 0, 0), "left": (0, 1, 0), "up": (0, 0, 1)},
}
"""Axes as the systems' own documentation states them."""
NOTHING = np.array([0.0, 0.0, 0.0, 1.0])
"""The identity, scalar last."""


def page() -> dict[str, Any]:
    """Return names that all blocks of the page define, run in order."""
    names: dict[str, Any] = {}
    for block in BLOCKS:
        exec(block, names)
    return names


NAMES = page()


def pair(system: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return conversion from a system, and back."""
    return NAMES[f"from_{system}"], NAMES[f"to_{system}"]


def turned(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Return `vector` turned by a quaternion x, y, z, w: Hamilton's formula, which is the same in systems of both hands."""
    return rotation.rotate(np.roll(quaternion, 1, axis=-1), vector)


def drawn(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return random positions (count, 3) and unit quaternions (count, 4), the same in every run."""
    rng = np.random.default_rng(20)
    q = rng.normal(size=(count, 4))
    return rng.normal(size=(count, 3)), q / np.linalg.norm(q, axis=-1, keepdims=True)


@pytest.mark.parametrize("system", AXES)
def test_forward_left_and_up_are_what_the_system_calls_so(system: str) -> None:
    there, _ = pair(system)
    for name, expected in (("forward", FORWARD), ("left", LEFT), ("up", UP)):
        np.testing.assert_array_equal(there(AXES[system][name], NOTHING)[0], expected)


@pytest.mark.parametrize("system", AXES)
def test_there_and_back(system: str) -> None:
    there, back = pair(system)
    p, q = drawn(100)
    for found, given in zip(back(*there(p, q)), (p, q), strict=True):
        np.testing.assert_array_equal(found, given)
    for found, given in zip(there(*back(p, q)), (p, q), strict=True):
        np.testing.assert_array_equal(found, given)


@pytest.mark.parametrize("system", AXES)
def test_turning_and_converting_commute(system: str) -> None:
    there, _ = pair(system)
    p, q = drawn(100)
    _, here = there(p, q)
    np.testing.assert_allclose(there(turned(q, p), q)[0], rotation.rotate(here, there(p, q)[0]), atol=1e-14)


def test_a_grip_pose_is_a_sample_that_the_engine_takes() -> None:
    fist = (Piece(Sphere(0.04)),)
    single = np.array([0.1, 0.2, 0.3, 0.9], dtype=np.float32)
    sample = NAMES["hand_from_openxr"](0.5, (0.1, 1.5, -0.4), single / np.linalg.norm(single))
    assert checked(sample, (rigid_avatar("hand", fist, solid(fist, 0.5)),)) is sample
    np.testing.assert_allclose(sample.positions, [[0.4, -0.1, 1.5]])


FREE_BODY = """<mujoco><worldbody><body>
<freejoint/><geom type="box" pos=".4 0 0" size=".1 .2 .3" mass="1"/>
</body></worldbody></mujoco>"""


def test_mujoco_itself_agrees() -> None:
    model = mujoco.MjModel.from_xml_string(FREE_BODY)
    np.testing.assert_array_equal(model.opt.gravity, (0.0, 0.0, -9.81))
    data = mujoco.MjData(model)
    (p,), (q,) = drawn(1)
    spin, velocity = np.array([0.3, -0.5, 0.7]), np.array([1.0, 2.0, 3.0])
    data.qpos[:], data.qvel[:] = NAMES["to_mujoco"](p, q, velocity, spin)
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.xmat[1].reshape(3, 3), rotation.to_matrix(q), atol=1e-14)
    # MuJoCo's word for the velocity of the body's frame, rotation first, in world axes
    found = np.zeros(6)
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, 1, found, 0)
    np.testing.assert_allclose(found, np.concatenate([spin, velocity]), atol=1e-14)
    for back, given in zip(NAMES["from_mujoco"](data.qpos, data.qvel), (p, q, velocity, spin), strict=True):
        np.testing.assert_allclose(back, given, atol=1e-14)
