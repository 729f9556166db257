"""How many got through? The share of bodies with a region that were ever found outside it."""

import numpy as np

from avatarsim.scene.scene import Scene
from scenarios.measure.value import Values
from scenarios.record import Recording
from scenarios.scenario import Scenario


def escapes(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """escaped_bodies [%]: bodies with a region that were outside it in a state shown, or no number. Empty without regions."""
    named = sorted({k for region in scenario.regions for k in region.indices(scene.names)})
    if not named:
        return {}
    wrong = np.zeros(len(named), dtype=bool)
    for region in scenario.regions:
        for k in region.indices(scene.names):
            centres = recording.positions[:, k]
            wrong[named.index(k)] |= bool(~((centres >= region.low) & (centres <= region.high)).all())
    return {"escaped_bodies": 100.0 * float(wrong.mean())}
