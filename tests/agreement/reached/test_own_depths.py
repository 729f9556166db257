"""Overlap by the engines' own functions against the judge's at the same poses: known to agree if those are called correctly.

MuJoCo's overlap is the distance of geoms at the shown poses: its contacts are one step old, and several contacts of one pair are
up to 3e-6 m off. PyBullet's closest points are off by the remaining margin of its hulls.
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
"""Factor on a figure that is known to one digit."""
SOFT: dict[str, object] = {"dt": FRAME, "hand_force": 5000.0, "pieces_as_links": False}
"""Settings of PyBullet with which a hand does overlap a table."""


def of_mujoco(engine: MujocoEngine) -> float:
    """Return the depth [m] of the deepest geom in the table, at the shown poses."""
    model, data = engine._world.model, engine._data
    mujoco.mj_kinematics(model, data)
    *hand, table = range(model.ngeom)
    return max(-float(mujoco.mj_geomDistance(model, data, table, geom, 1.0, None)) for geom in hand)


def of_pybullet(engine: object) -> float:
    """Return the largest depth of the closest points [m] at the shown poses."""
    client, parts = engine._client, engine._world.parts  # type: ignore[attr-defined]
    found = pybullet.getClosestPoints(parts[0].body, parts[1].body, 0.01, physicsClientId=client)
    return max((-point[8] for point in found), default=0.0)


def differences(engine: MujocoEngine, preset: str, options: dict[str, object], own: Callable[..., float]) -> list[float]:
    """Return differences of an engine and the judge [m], in frames in which the judge finds more than a tenth of a millimetre."""
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
