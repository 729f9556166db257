"""Between hand and thing: how far a carried thing falls short, slips, is squeezed aside, and how far a loaded hand sags."""

import numpy as np

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.building.expected import Carried, Pressed, Sag
from scenarios.measure.bodies.axes import up
from scenarios.measure.expecting import for_each
from scenarios.measure.value import Missing, Values

Flags = np.ndarray[tuple[int], np.dtype[np.bool_]]


@for_each("carried", Carried)
def carried(recording: Recording, scene: Scene, entry: Carried) -> Values:
    """Return height_missing [m] and grip_slip_max [m].

    height_missing: by how much a body rose less than the users of all its links, from the state at `since` to the one at `until`.
    grip_slip_max: farthest that its origin is, in the frame of any of its links, from where it was at `since`.
    """
    held = _within(recording, entry.since, entry.until)
    if not held.any():
        early = Missing("the recording ends before anything is carried", "scene")
        return {"height_missing": early, "grip_slip_max": early}
    body = recording.positions[held, scene.names.index(entry.body)]
    links, slips = [scene.names.index(name) for name in entry.links], []
    users = recording.raw_positions[held][:, [k - recording.links.start for k in links]]
    rise = ((users[-1] - users[0]).mean(axis=0) - (body[-1] - body[0])) @ up(scene)
    for link in links:
        turn = rotation.conjugate(recording.orientations[held, link])
        seen = rotation.rotate(turn, body - recording.positions[held, link])
        slips.append(np.linalg.norm(seen - seen[0], axis=1))
    return {"height_missing": float(np.maximum(rise, 0.0)), "grip_slip_max": float(np.max(slips))}


@for_each("pressed", Pressed)
def pressed(recording: Recording, scene: Scene, entry: Pressed) -> Values:
    """Return pressed_sideways_max [m]: farthest, at right angles to gravity, that a body is from where it was at `since`."""
    held = _within(recording, entry.since, entry.until)
    if not held.any():
        return {"pressed_sideways_max": Missing("the recording ends before anything is pressed", "scene")}
    body = recording.positions[held, scene.names.index(entry.body)]
    aside = np.linalg.norm(rotation.cross(body - body[0], up(scene)), axis=1)
    return {"pressed_sideways_max": float(aside.max())}


@for_each("sags", Sag)
def sags(recording: Recording, scene: Scene, entry: Sag) -> Values:
    """Return sag_error_max [m]: largest distance of a link from where it should be, `sag` below its user along gravity, from
    `since` to `until`."""
    held = _within(recording, entry.since, entry.until)
    if not held.any():
        return {"sag_error_max": Missing("the recording ends before the link is at rest", "scene")}
    link = scene.names.index(entry.link)
    lag = recording.positions[held, link] - recording.raw_positions[held, link - recording.links.start]
    return {"sag_error_max": float(np.linalg.norm(lag + entry.sag * up(scene), axis=1).max())}


def _within(recording: Recording, since: float, until: float) -> Flags:
    return np.asarray((recording.times >= since) & (recording.times <= until))
