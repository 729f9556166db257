"""When a ball bounces, and when it has done bouncing, against the closed form."""

import numpy as np

from avatarsim.scene.scene import Scene
from reference.closed_form import bounce_time, zeno_time
from scenarios.measure.bounce import JITTER, LATE, Flight, flight, impacts
from scenarios.measure.expecting import expected
from scenarios.measure.timeline import timeline
from scenarios.measure.value import Missing, Value, Values
from scenarios.record import Recording
from scenarios.scenario import Drop, Scenario

ENDED = 1e-9
"""Speed [m/s] below which a ball has stopped bouncing; a bounce of 1e-9 m/s is lower than an atom."""


def _flight(recording: Recording, scene: Scene, drop: Drop) -> Flight:
    pair = [scene.names.index(drop.ball), scene.names.index(drop.floor)]
    return flight(timeline(recording, pair), drop, np.array(scene.gravity))


def bounce_times(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """bounce_time_error_max [s]: the n-th impact faster than 0.1 m/s against the closed form's, over all drops. One that did not
    happen within the recording is the engine's fault. Empty without drops."""
    drops = expected(scenario, "drops", Drop)
    errors: list[float] = []
    for drop in drops:
        way = _flight(recording, scene, drop)
        seen = [impact.time for impact in impacts(way) if impact.before > JITTER]
        speed, n = float(np.sqrt(2.0 * drop.height * way.gravity)), 1
        # twice the limit: an impact just below or above it must not decide whether the count is right
        while speed > 2.0 * JITTER and (due := bounce_time(drop.height, drop.restitution, way.gravity, n)) + LATE < way.time[-1]:
            if n > len(seen):
                return {"bounce_time_error_max": Missing(f"impact {n} of {drop.ball} was not seen", "engine")}
            errors.append(abs(seen[n - 1] - due))
            speed, n = speed * drop.restitution, n + 1
    if not drops:
        return {}
    early: Value = Missing("the recording ends before the first impact", "scene")
    return {"bounce_time_error_max": max(errors) if errors else early}


def zeno_ends(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """zeno_end_error_max [s]: difference of the first instant from which on a ball is at rest from the closed form's, over all
    drops with restitution below 1, if the scene asks by expects["zeno"]."""
    if not scenario.expects.get("zeno"):
        return {}
    errors: list[float] = []
    for drop in expected(scenario, "drops", Drop):
        way = _flight(recording, scene, drop)
        end = zeno_time(drop.height, drop.restitution, way.gravity)
        if end + LATE > way.time[-1]:
            continue
        moving = np.flatnonzero(~(np.abs(way.speed) <= ENDED))
        rests_from = int(moving[-1]) + 1 if len(moving) else 0
        if rests_from == len(way.time) or rests_from == 0:
            why = "never came to rest" if rests_from else "never moved"
            return {"zeno_end_error_max": Missing(f"{drop.ball} {why}", "engine")}
        errors.append(abs(float(way.time[rests_from]) - end))
    early: Value = Missing("the recording ends before a ball comes to rest", "scene")
    return {"zeno_end_error_max": max(errors) if errors else early}
