"""Bodies that slide until they stop: how far, and how straight."""

import numpy as np

from avatarsim.scene.scene import Scene
from scenarios.expected import Stop
from scenarios.measure.expecting import expected
from scenarios.measure.value import Values
from scenarios.record import Recording
from scenarios.scenario import Scenario


def stops(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """stop_distance_error_max [%]: largest |way - closed form| of the last state, along the closed form's direction;
    stop_direction_error_max [deg]: largest angle between the two ways, 90 where a body never moved. Empty without stops.

    A recording that ends before a body should have stopped compares what it has: an engine that never moves is not excused.
    """
    entries = expected(scenario, "stops", Stop)
    if not entries:
        return {}
    ways, angles = [], []
    for entry in entries:
        path = recording.positions[:, scene.names.index(entry.body)]
        way, along = path[-1] - path[0], np.array(entry.direction)
        ahead = float(way @ along)
        ways.append(100.0 * abs(ahead - entry.distance) / entry.distance)
        angles.append(float(np.degrees(np.arctan2(np.linalg.norm(way - ahead * along), ahead))) if way.any() else 90.0)
    return {"stop_distance_error_max": float(np.max(ways)), "stop_direction_error_max": float(np.max(angles))}
