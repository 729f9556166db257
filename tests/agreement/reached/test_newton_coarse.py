"""Restitution at 60 steps per second, where a step is a large part of an impact: the mean of eight phases, as it is known.

Referred to the height that a ball fell from. Over the speed of its last falling state, which is g dt / 2 slower than it should be
there, 1 is 1.037 (g dt / v is 0.037).
"""

from math import sqrt

import numpy as np
import pytest

from tests.agreement.reached.bodies import BALL, GRAVITY
from tests.agreement.reached.test_newton import ASKED, HALF_A_DIGIT, PHASES, at_surface, dropped

MEAN = (0.013, 0.101, 0.269, 0.505, 0.826, 1.035)
"""Known mean over eight phases of MuJoCo's restitution of each of ASKED."""
WORST = (0.100, 0.200, 0.093, 0.030, 0.033, 0.035)
"""Known largest error of a phase."""


@pytest.mark.parametrize("k", range(len(ASKED)), ids=[f"e={asked}" for asked in ASKED])
def test_means_over_phases_are_as_near_as_known(k: int) -> None:
    found, balls = dropped("mujoco", 60), range(PHASES * k, PHASES * k + PHASES)
    # what is left of the fall's energy in the last falling state, and of that in the first rising one above the floor
    speed = found.velocities[:, :, 2]
    energy = speed**2 + 2.0 * GRAVITY * (found.places[:, :, 2] - BALL.radius)
    lasts = [int(np.argmax(speed[:, ball] > 0.0)) - 1 for ball in balls]
    seen = np.array([
        at_surface(ball, found) * sqrt(energy[last, ball] / energy[0, ball]) for ball, last in zip(balls, lasts, strict=True)
    ])
    assert abs(seen.mean() - ASKED[k]) <= abs(MEAN[k] - ASKED[k]) + HALF_A_DIGIT
    assert np.abs(seen - ASKED[k]).max() <= WORST[k] + HALF_A_DIGIT
