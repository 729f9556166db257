"""What engines say of their own overlap, and what the judge finds at the same poses: they are known to agree when asked right.

MuJoCo is asked for the distance of geoms at the poses that are shown: its contacts are a step old, and where it makes several of
a pair they are up to 3e-6 m off. PyBullet's closest points are off by the margin that its hulls are left.
"""

from collections.abc import Callable

import mujoco
import numpy as np

from avatarsim.engine import Settings
from reference.in_mujoco.engine import MujocoEngine
from reference.judging.judge import Judge
from tests.agreement.rivals import PybulletEngine, needs_pybullet, pybullet
from tests.agreement.runs import FRAME
from tests.agreement.scenes import hand_over_table, pressed

FRAMES = 40
AGREES = {"mujoco": 1e-10, "pybullet": 1e-6}
"""Known difference of the deepest overlap of hulls and a box [m], median over frames."""
DIGIT = 1.5
"""Figures of one digit, as multiples."""
SOFT: dict[str, object] = {"dt": FRAME, "hand_force": 5000.0, "pieces_as_links": False}
"""Settings of PyBullet with which a hand overlaps a table at all."""


def of_mujoco(engine: MujocoEngine) -> float:
    """Depth [m] of the deepest geom in the table, at the poses that are shown."""
    model, data = engine._world.model, engine._data
    mujoco.mj_kinematics(model, data)
    *hand, table = range(model.ngeom)
    return max(-float(mujoco.mj_geomDistance(model, data, table, geom, 1.0, None)) for geom in hand)


def of_pybullet(engine: object) -> float:
    """Deepest of the closest points [m] at the poses that are shown."""
    client, parts = engine._client, engine._world.parts  # type: ignore[attr-defined]
    found = pybullet.getClosestPoints(parts[0].body, parts[1].body, 0.01, physicsClientId=client)
    return max((-point[8] for point in found), default=0.0)


def differences(engine: MujocoEngine, preset: str, options: dict[str, object], own: Callable[..., float]) -> list[float]:
    """By how much an engine and the judge differ [m], in frames in which the judge finds more than a tenth of a millimetre."""
    scene = hand_over_table()
    judge, found = Judge(scene), []
    engine.load(scene, Settings(preset, options), FRAME)
    for frame in range(1, FRAMES + 1):
        shown = engine.advance(pressed(frame), FRAME).shown
        deepest = judge.overlaps(shown.positions, shown.orientations).deepest
        if deepest > 1e-4:
            found.append(abs(own(engine) - deepest))
    engine.close()
    return found


def test_mujoco_and_the_judge_agree_on_hulls_in_a_box() -> None:
    found = differences(MujocoEngine(), "default", {}, of_mujoco)
    assert len(found) >= 5
    assert np.median(found) <= DIGIT * AGREES["mujoco"]


@needs_pybullet
def test_pybullet_and_the_judge_agree_on_hulls_in_a_box() -> None:
    found = differences(PybulletEngine(), "tuned", SOFT, of_pybullet)
    assert len(found) >= 2
    assert np.median(found) <= DIGIT * AGREES["pybullet"]
