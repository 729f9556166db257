"""Thinning of a recording once it has been measured: every pose shown is kept with all its bits, few of those inside frames.

Sub-steps and events are nine tenths of what an engine gives, and what they are for is measured while the run has them. Later
questions ask only in which frames something was on the wrong side inside: one snapshot of each such frame is
kept. Velocities of links are measured too by then, and are a quarter of a recording: no later question asks for them, and no
number stands in their place. Those of bodies stay, for the energy that pages draw.
"""

from dataclasses import fields, replace

import numpy as np

from avatarsim.scene.scene import Scene
from runfiles.record import Array, Recording
from scenarios.measure.side import outside
from scenarios.scenario import Scenario


def thinned(recording: Recording, scenario: Scenario, scene: Scene) -> Recording:
    """`recording` with the first snapshot of every frame inside which something is outside its region, and no other, and with the
    velocities of bodies only."""
    wrong = np.flatnonzero(outside(recording.inside_positions, scenario.regions, scene.names))
    _, first = np.unique(recording.inside_frame[wrong], return_index=True)
    rows = wrong[first]
    inside = [entry.name for entry in fields(recording) if entry.name.startswith("inside_")]
    few = replace(recording, **{name: getattr(recording, name)[rows] for name in inside})
    return replace(
        few, velocities=_of_bodies(recording, recording.velocities),
        angular_velocities=_of_bodies(recording, recording.angular_velocities),
    )


def _of_bodies(recording: Recording, velocities: Array) -> Array:
    """(F+1, n, 3) with no number for the links."""
    found = velocities.copy()
    found[:, recording.links] = np.nan
    return found
