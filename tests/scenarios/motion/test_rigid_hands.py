"""Rigid hands are where their places say at the end of each frame, and go from rest to rest."""

import numpy as np
import pytest

from scenarios.catalog.contact import flat_hands
from scenarios.motion.rigid_hands import eased, led
from scenarios.scenario import RENDERED


def test_a_led_hand_is_where_it_should_be_at_the_end_of_a_frame() -> None:
    motion = led(lambda time: ((time, 2.0 * time, 0.5), (0.0, -time, 0.0)))(flat_hands.SCENARIOS[1].build(), 0)
    sample = motion(5)
    assert sample.time == pytest.approx(6 * RENDERED)
    assert sample.positions.tolist() == [[sample.time, 2.0 * sample.time, 0.5], [0.0, -sample.time, 0.0]]


def test_a_way_is_eased_from_rest_to_rest() -> None:
    shares = np.array([eased(time, 1.0, 3.0) for time in np.linspace(0.0, 4.0, 401)])
    assert shares[0] == shares[100] == 0.0 and shares[200] == pytest.approx(0.5) and shares[300] == shares[-1] == 1.0
    steps = np.diff(shares)
    assert (steps >= 0.0).all() and steps[101] < 0.01 * steps.max() and steps[298] < 0.01 * steps.max()
