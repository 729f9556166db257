"""The interval holds the truth, and is as wide as the noise."""

import numpy as np
import pytest

from reports.summaries.noise import BLOCK, interval


def test_the_same_frames_twice() -> None:
    times = np.random.default_rng(0).gamma(4.0, 10.0, 300)
    assert interval(times, times, 50.0) == (1.0, 1.0)
    assert interval(times, 1.5 * times, 95.0) == pytest.approx((1.5, 1.5))


@pytest.mark.parametrize("truth", [0.8, 1.0, 1.3])
def test_independent_noise_is_seen(truth: float) -> None:
    draw = np.random.default_rng(1)
    old, new = draw.gamma(16.0, 1.0, 400), truth * draw.gamma(16.0, 1.0, 400)
    found = interval(old, new, 50.0)
    assert found is not None and found[0] < truth < found[1] and found[1] - found[0] < 0.3 * truth


def test_too_few_frames_say_nothing() -> None:
    assert interval(np.ones(3 * BLOCK - 1), np.ones(500), 50.0) is None
    assert interval(np.full(100, np.nan), np.ones(100), 50.0) is None
