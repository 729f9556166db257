"""Is what a hand grasps still up there at the end? The last height of bodies against their first."""

import numpy as np

from avatarsim.scene.scene import Scene
from scenarios.measure.value import Values
from scenarios.record import Recording
from scenarios.scenario import Scenario


def grasp(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """grasped_fall_end [m]: how far the origin of a body named in `expects["grasped"]` is, in the last state, below where it was
    in the first, against gravity; the largest of them, at least 0; nan where it is nowhere. Empty if none is named."""
    names = scenario.expects.get("grasped")
    if not isinstance(names, tuple):
        return {}
    down = np.array(scene.gravity) / np.linalg.norm(scene.gravity)
    own = [scene.names.index(name) for name in names]
    fallen = (recording.positions[-1, own] - recording.positions[0, own]) @ down
    return {"grasped_fall_end": float(np.max(np.maximum(fallen, 0.0)))}
