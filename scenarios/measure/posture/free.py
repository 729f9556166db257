"""Free targets: frames in which the raw tracker's own posture overlaps nothing, is on the right side and within the limits."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from scenarios.measure.overlap import SEEN
from scenarios.measure.posture.limits import joint_limit_excess, reach_cone_excess
from scenarios.measure.side import outside
from scenarios.scenario import Scenario

Array = NDArray[np.float64]
LinkDepths = Callable[[Array, Array], Array]
"""(F,) deepest overlap [m] of F states (F, n, 3), (F, n, 4) in which a link takes part."""

ROUNDING = 1e-8
"""Angle [rad] beyond a limit that still counts as within: the error that turning poses back into angles may make."""


def raw_states(recording: Recording) -> tuple[Array, Array]:
    """Return positions and orientations (F+1, n, .): links where the raw tracker has them, bodies where they were shown."""
    positions, orientations = recording.positions.copy(), recording.orientations.copy()
    positions[:, recording.links] = recording.raw_positions
    orientations[:, recording.links] = recording.raw_orientations
    return positions, orientations


def free_frames(recording: Recording, scenario: Scenario, scene: Scene, link_depths: LinkDepths) -> NDArray[np.bool_]:
    """Return (F+1,) True where the raw posture is one that could be shown."""
    if not scene.links:
        return np.ones(recording.frames + 1, dtype=bool)
    positions, orientations = raw_states(recording)
    excess = joint_limit_excess(scene, recording.raw_orientations, recording.raw_angles)
    excess = np.maximum(excess, reach_cone_excess(scene, recording.raw_orientations))
    free = ~outside(positions, scenario.regions, scene.names) & (excess <= ROUNDING)
    # the judge is called last and only where it can still decide: it is by far the dearest
    free[free] = link_depths(positions[free], orientations[free]) <= SEEN
    return np.asarray(free)
