"""What is kept of a recording once it has been measured: every state shown with all its bits, few of those inside frames.

Sub-steps and events are nine tenths of what an engine gives, and what they are for is measured while the run has them. Later
questions (`scenarios.beside`) ask only in which frames something was on the wrong side inside: one snapshot of each such frame is
kept.
"""

from dataclasses import fields, replace

import numpy as np

from avatarsim.scene.scene import Scene
from scenarios.measure.side import outside
from scenarios.record import Recording
from scenarios.scenario import Scenario


def thinned(recording: Recording, scenario: Scenario, scene: Scene) -> Recording:
    """`recording` with the first snapshot of every frame inside which something is outside its region, and no other."""
    wrong = np.flatnonzero(outside(recording.inside_positions, scenario.regions, scene.names))
    _, first = np.unique(recording.inside_frame[wrong], return_index=True)
    rows = wrong[first]
    inside = [entry.name for entry in fields(recording) if entry.name.startswith("inside_")]
    return replace(recording, **{name: getattr(recording, name)[rows] for name in inside})
