"""A recording for tests of its file."""

from dataclasses import replace

import numpy as np

from runfiles.record import Recording
from tests.scenarios.examples import DT, drop_scene, resting, with_inside


def full() -> Recording:
    """Return a recording with every field filled, nan and minus zero among the numbers."""
    base = resting(drop_scene(), 3)
    rng = np.random.default_rng(7)
    p, v = np.tile(base.positions[0], (5, 1, 1)), rng.normal(size=(5, 2, 3))
    p[:, 1] = rng.normal(size=(5, 3))
    p[3, 1, 2], v[:, 0] = np.nan, -0.0
    filled = with_inside(base, [0.001, 0.002, 0.02, 0.03, 0.03], [1, 1, 2, 2, 2], ["step"] * 3 + ["approach", "impact"], p, v)
    return replace(
        filled,
        meta={"dt": DT, "scene": "drop", "unsupported": {"a": "b"}},
        counts={"pairs": np.arange(4)},
        statuses={"OUT_OF_ITERATIONS": np.array([0, 1, 0, 2])},
        frame_times_ns=np.arange(6).reshape(2, 3),
    )
