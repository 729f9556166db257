"""Where bodies end up: outside their region, short of the way that they are pushed, or fallen out of a hand."""

from collections.abc import Mapping

import numpy as np

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import link_poses
from runfiles.record import Recording
from scenarios.measure.value import Values, measure
from scenarios.scenario import REFUSAL, Scenario


@measure
def escapes(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return escaped_bodies [%]: bodies with a region that were outside it in a state, or no number. Empty without regions."""
    named = sorted({k for region in scenario.regions for k in region.indices(scene.names)})
    if not named:
        return {}
    wrong = np.zeros(len(named), dtype=bool)
    for region in scenario.regions:
        for k in region.indices(scene.names):
            centres = recording.positions[:, k]
            wrong[named.index(k)] |= bool(~((centres >= region.low) & (centres <= region.high)).all())
    return {"escaped_bodies": 100.0 * float(wrong.mean())}


@measure
def travel(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return travel_missing [m]: largest shortfall of the ways in `expects["travel"]`, body -> least way from its first place.

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


@measure
def start_moved(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return start_moved_max [m]: farthest that the origin of a body or link is, in the first state shown, from where the scene
    puts it. Empty unless the scene overlaps there."""
    if not scenario.expects.get(REFUSAL):
        return {}
    places = [np.array([body.position for body in scene.bodies]).reshape(-1, 3)]
    places.append(link_poses(scene.avatars, scene.first_sample)[0])
    ways = np.linalg.norm(recording.positions[0] - np.vstack(places), axis=1)
    return {"start_moved_max": float(ways.max(initial=0.0))}


@measure
def grasp(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return grasped_fall_end [m]: how far the origin of a body named in `expects["grasped"]` is, in the last state, below where
    it was in the first, against gravity; the largest of them, at least 0; nan where it is nowhere. Empty if none is named."""
    names = scenario.expects.get("grasped")
    if not isinstance(names, tuple):
        return {}
    down = np.array(scene.gravity) / np.linalg.norm(scene.gravity)
    own = [scene.names.index(name) for name in names]
    fallen = (recording.positions[-1, own] - recording.positions[0, own]) @ down
    return {"grasped_fall_end": float(np.max(np.maximum(fallen, 0.0)))}
