"""Bodies that should rest: their drift, their motion at the end, towers that have not fallen, and heights of piles."""

import numpy as np

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from scenarios.building.expected import Pile, Rest, Tower
from scenarios.measure.bodies.axes import up
from scenarios.measure.bodies.energy import kinetic
from scenarios.measure.expecting import expected, for_each
from scenarios.measure.value import Missing, Values, measure
from scenarios.scenario import Scenario


@measure
def at_rest(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return drift_max [m]: farthest that a body at rest is from where it was when it came to rest; rest_energy_end [J]: kinetic
    energy of all of them in the last state. Empty if no body is to rest."""
    rests = expected(scenario, "rests", Rest)
    if not rests:
        return {}
    if recording.times[-1] < max(entry.since for entry in rests):
        early = Missing("the recording ends before all is at rest", "scene")
        return {"drift_max": early, "rest_energy_end": early}
    drift, bodies = [0.0], []
    for entry in rests:
        own = [scene.names.index(name) for name in entry.bodies]
        path = recording.positions[recording.times >= entry.since][:, own]
        drift.append(float(np.max(np.linalg.norm(path - path[0], axis=-1))))
        bodies += [k for k in own if scene.roles[k] is Role.SIMULATED]
    masses = [mass for k in bodies if (mass := scene.bodies[k].mass) is not None]
    moving = kinetic(
        np.array([m.mass for m in masses]), np.array([m.inertia for m in masses]), recording.orientations[-1:, bodies],
        recording.velocities[-1:, bodies], recording.angular_velocities[-1:, bodies],
    )
    return {"drift_max": float(np.max(drift)), "rest_energy_end": float(moving.sum())}


STANDS = 1e-3
"""Distance [m] from its place up to which a body stays up: a landing may shift it by micrometres, a spring yield by a tenth of a
millimetre; a body that sinks or slides farther does not carry its load."""


@measure
def towers(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return towers_fallen [towers]: those whose body is ever over STANDS from its place, or no number, once it should rest.

    ratio_standing_max: the largest ratio of masses of which, and of all below, no tower fell; 0 if none. Empty without towers.
    """
    expectations = sorted(expected(scenario, "towers", Tower), key=lambda tower: tower.ratio)
    if not expectations:
        return {}
    standing = []
    for tower in expectations:
        shown = recording.positions[recording.times >= tower.since, scene.names.index(tower.body)]
        standing.append(len(shown) > 0 and bool((np.linalg.norm(shown - tower.place, axis=1) <= STANDS).all()))
    before_the_first_that_fell = expectations[: standing.index(False)] if False in standing else expectations
    return {
        "towers_fallen": float(standing.count(False)),
        "ratio_standing_max": max((tower.ratio for tower in before_the_first_that_fell), default=0.0),
    }


@for_each("piles", Pile)
def piles(recording: Recording, scene: Scene, pile: Pile) -> Values:
    """Return pile_height_error_max [%]: largest difference of the mean height of the bodies of a pile above its floor from the
    stated one, once it should rest."""
    settled = recording.times >= pile.since
    if not settled.any():
        return {"pile_height_error_max": Missing("the recording ends before the pile is at rest", "scene")}
    own, places = [scene.names.index(name) for name in pile.bodies], recording.positions[settled]
    height = (places[:, own].mean(axis=1) - places[:, scene.names.index(pile.floor)]) @ up(scene)
    return {"pile_height_error_max": float(100.0 * np.abs(height / pile.height - 1.0).max())}
