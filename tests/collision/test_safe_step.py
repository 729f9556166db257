"""The first root of gap + v t + a t^2 / 2, where subtraction would lose it."""

import pytest

from avatarsim.collision.motion_bounds import earliest_touch


@pytest.mark.nojit
@pytest.mark.parametrize("gap", [1e-18, 1e-16, 1e-12, 1e-6])
def test_a_body_thrown_up_from_the_ground_comes_back_when_it_does(gap: float) -> None:
    """From 0.05 m/s the way back takes 2 v / g; a gap of rounding size made it 7 microseconds late."""
    v, g = 0.04893894, 9.81
    expected = (v + (v * v + 2.0 * g * gap) ** 0.5) / g
    assert earliest_touch(gap, v, -g, 1.0) == pytest.approx(expected, rel=1e-14)
