"""Gaps that a posture keeps: a wedged pair comes nearer than an accepted one, which comes nearer than the one aimed at."""

import pytest

from avatarsim.ik.gaps import least_gap, wedged_gap


@pytest.mark.parametrize("stand_off", [1e-5, 1e-3, 0.1])
def test_gaps_are_ordered_and_never_overlap(stand_off: float) -> None:
    assert 0.0 < wedged_gap(stand_off) < least_gap(stand_off) < stand_off


def test_gaps_scale_with_the_stand_off() -> None:
    assert least_gap(2e-3) == pytest.approx(2.0 * least_gap(1e-3))
    assert wedged_gap(2e-3) == pytest.approx(2.0 * wedged_gap(1e-3))
