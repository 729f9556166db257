"""Tunnelling: bodies and links outside their regions. An engine may overlap nothing and have walked through the wall."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from scenarios.measure.value import Values, measure
from scenarios.scenario import Region, Scenario

Array = NDArray[np.float64]


def outside(positions: Array, regions: tuple[Region, ...], names: tuple[str, ...]) -> NDArray[np.bool_]:
    """Return (F,) True where an origin among positions (F, n, 3) is outside its region, or is not a number."""
    wrong = np.zeros(len(positions), dtype=bool)
    for region in regions:
        centres = positions[:, list(region.indices(names))]
        wrong |= ~((centres >= region.low) & (centres <= region.high)).all(axis=(1, 2))
    return wrong


@measure
def wrong_side(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
    """Return wrong_side_frames: frames, with their sub-steps, in which something is outside its region. Empty without any."""
    if not scenario.regions:
        return {}
    wrong = outside(recording.positions, scenario.regions, scene.names)
    inside = outside(recording.inside_positions, scenario.regions, scene.names)
    wrong[recording.inside_frame[inside]] = True
    return {"wrong_side_frames": float(wrong.sum())}
