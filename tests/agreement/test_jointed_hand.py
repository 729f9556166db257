"""PyBullet's jointed hand is led by as much force as a hand has: what leads a body breaks its fingers' limits in a corner."""

import numpy as np

from avatarsim.engine import Settings
from scenarios import catalog
from scenarios.measure.posture.limits import joint_limit_excess
from tests.agreement.rivals import PybulletEngine, needs_pybullet

FRAMES = 40
"""The hand is in the corner from the tenth on."""
OF_A_BODY: dict[str, object] = {"root_force": 2000.0, "hinge_force": 100.0, "solver_iterations": 50}
"""Settings for a body [N], [N m]."""


def worst_excess(options: dict[str, object]) -> float:
    """Largest excess [deg] over the limit of any joint."""
    scenario = catalog.get("hand_in_corner")
    scene = scenario.build()
    motion, engine = scenario.motion(scene, 0), PybulletEngine()
    engine.load(scene, Settings("tuned", options), scenario.dt)
    records = [engine.advance(motion(frame), scenario.dt) for frame in range(FRAMES)]
    engine.close()
    turns = np.array([record.shown.orientations[len(scene.bodies) :] for record in records])
    return float(np.degrees(joint_limit_excess(scene, turns, np.array([record.angles for record in records])).max()))


@needs_pybullet
def test_its_limits_hold_several_times_better() -> None:
    assert worst_excess({}) < 20.0 < 60.0 < worst_excess(OF_A_BODY)
