"""Did what was pushed go anywhere? An engine whose hand meets nothing overlaps nothing."""

from collections.abc import Mapping

import numpy as np

from avatarsim.scene.scene import Scene
from scenarios.measure.value import Values
from scenarios.record import Recording
from scenarios.scenario import Scenario


def travel(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """travel_missing [m]: largest shortfall of the ways that `expects["travel"]` states, body -> least way from its first place.

    The way is the straight distance of the last state shown, or of the farthest finite one. Empty if nothing is stated.
    """
    stated = scenario.expects.get("travel")
    if not isinstance(stated, Mapping):
        return {}
    missing = 0.0
    for name, least in stated.items():
        path = recording.positions[:, scene.names.index(name)]
        ways = np.linalg.norm(path - path[0], axis=1)
        ways = ways[np.isfinite(ways)]
        missing = max(missing, least - (float(ways.max()) if len(ways) else 0.0))
    return {"travel_missing": missing}
