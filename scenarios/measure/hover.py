"""Visible gap in contact: median distance of an avatar's links from what they touch, over the states in which one is near."""

import numpy as np
from numpy.typing import NDArray

from scenarios.measure.smoothness import NEAR
from scenarios.measure.value import Missing, Values

Array = NDArray[np.float64]


def contact_gap(gaps: Array) -> Values:
    """contact_gap_p50 [m] from `gaps` (F+1,) [m], the smallest distance of a link from what it may not overlap in each state
    shown, negative where it overlaps: the median over states with at most NEAR, where an overlap is a gap of 0. An engine that
    keeps links off by a margin has that margin here. A gap that is no number is in contact and the worst."""
    near = gaps[~(gaps > NEAR)]
    if not near.size:
        return {"contact_gap_p50": Missing("in no state that was shown is a link near anything", "scene")}
    return {"contact_gap_p50": float(np.median(np.maximum(near, 0.0)))}
