"""Interpolation between two tracker samples: linear for places and hinge angles, spherical for rotations (slerp)."""

import numpy as np

from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation


def between(before: TrackerSample, after: TrackerSample, share: float) -> TrackerSample:
    """Return the posture at `share` (0 to 1) of the way from one sample to the next, as engines with own steps get it.

    `scene.tracker.between` differs in the last bits of rotations, and so in the figures of chaotic scenes.
    """
    links = len(before.positions)
    turned = rotation.slerp(before.rotations, after.rotations, np.full(links, share)) if links else before.rotations
    return TrackerSample(
        before.time + share * (after.time - before.time), before.positions + share * (after.positions - before.positions),
        turned, before.angles + share * (after.angles - before.angles),
    )
