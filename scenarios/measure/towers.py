"""How heavy a body does a light one carry? Towers that stand, by the ratio of their masses."""

import numpy as np

from avatarsim.scene.scene import Scene
from scenarios.expected import Tower
from scenarios.measure.expecting import expected
from scenarios.measure.value import Values
from scenarios.record import Recording
from scenarios.scenario import Scenario

STANDS = 1e-3
"""Distance [m] from its place up to which a body stands: a landing may shift it by micrometres, a spring yield by a tenth of a
millimetre; who sinks or slides farther does not carry what it should."""


def towers(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """towers_fallen [towers]: those whose body is ever farther than STANDS from its place, or no number, once it should rest.

    ratio_standing_max: the largest ratio of masses of which, and of all below, the towers stand; 0 if none. Empty without towers.
    """
    asked = sorted(expected(scenario, "towers", Tower), key=lambda tower: tower.ratio)
    if not asked:
        return {}
    standing = []
    for tower in asked:
        shown = recording.positions[recording.times >= tower.since, scene.names.index(tower.body)]
        standing.append(len(shown) > 0 and bool((np.linalg.norm(shown - tower.place, axis=1) <= STANDS).all()))
    before_the_first_that_fell = asked[: standing.index(False)] if False in standing else asked
    return {
        "towers_fallen": float(standing.count(False)),
        "ratio_standing_max": max((tower.ratio for tower in before_the_first_that_fell), default=0.0),
    }
