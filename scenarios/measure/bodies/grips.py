"""Between hand and thing: how far what is carried falls short, slips, is squeezed aside, and how far a loaded hand sags."""

import numpy as np

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from runfiles.record import Array, Recording
from scenarios.building.expected import Carried, Pressed, Sag
from scenarios.measure.expecting import expected
from scenarios.measure.value import Missing, Values, measure
from scenarios.scenario import Scenario

Flags = np.ndarray[tuple[int], np.dtype[np.bool_]]


@measure
def carried(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return height_missing [m] and grip_slip_max [m], the largest over expects["carried"]; empty where nothing is carried.

    height_missing: by how much a body rose less than the users of all its links, from the state at `since` to the one at `until`.
    grip_slip_max: farthest that its origin is, in the frame of any of its links, from where it was at `since`.
    """
    entries = expected(scenario, "carried", Carried)
    if not entries:
        return {}
    short, slips = [], []
    for entry in entries:
        held = _within(recording, entry.since, entry.until)
        if not held.any():
            early = Missing("the recording ends before anything is carried", "scene")
            return {"height_missing": early, "grip_slip_max": early}
        body = recording.positions[held, scene.names.index(entry.body)]
        links = [scene.names.index(name) for name in entry.links]
        users = recording.raw_positions[held][:, [k - recording.links.start for k in links]]
        rise = ((users[-1] - users[0]).mean(axis=0) - (body[-1] - body[0])) @ _up(scene)
        short.append(float(np.maximum(rise, 0.0)))
        for link in links:
            turn = rotation.conjugate(recording.orientations[held, link])
            seen = rotation.rotate(turn, body - recording.positions[held, link])
            slips.append(float(np.max(np.linalg.norm(seen - seen[0], axis=1))))
    return {"height_missing": float(np.max(short)), "grip_slip_max": float(np.max(slips))}


@measure
def pressed(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return pressed_sideways_max [m]: farthest, at right angles to gravity, that a body of expects["pressed"] is from where it
    was at `since`. Empty where nothing is pressed."""
    ways = []
    for entry in expected(scenario, "pressed", Pressed):
        held = _within(recording, entry.since, entry.until)
        if not held.any():
            return {"pressed_sideways_max": Missing("the recording ends before anything is pressed", "scene")}
        body = recording.positions[held, scene.names.index(entry.body)]
        ways.append(np.linalg.norm(rotation.cross(body - body[0], _up(scene)), axis=1).max())
    return {"pressed_sideways_max": float(np.max(ways))} if ways else {}


@measure
def sags(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return sag_error_max [m]: largest distance of a link of expects["sags"] from where it should be, `sag` below its user along
    gravity, from `since` to `until`. Empty where nothing sags."""
    errors = []
    for entry in expected(scenario, "sags", Sag):
        held = _within(recording, entry.since, entry.until)
        if not held.any():
            return {"sag_error_max": Missing("the recording ends before the link is at rest", "scene")}
        link = scene.names.index(entry.link)
        lag = recording.positions[held, link] - recording.raw_positions[held, link - recording.links.start]
        errors.append(np.linalg.norm(lag + entry.sag * _up(scene), axis=1).max())
    return {"sag_error_max": float(np.max(errors))} if errors else {}


def _within(recording: Recording, since: float, until: float) -> Flags:
    return np.asarray((recording.times >= since) & (recording.times <= until))


def _up(scene: Scene) -> Array:
    """Unit vector against gravity."""
    return -np.array(scene.gravity) / float(np.linalg.norm(scene.gravity))
