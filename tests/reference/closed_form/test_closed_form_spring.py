"""The spring against a second derivation."""

import pytest
from scipy.integrate import solve_ivp

from reference import closed_form as exact


def integrated(rate, start, time):
    """Return state at `time` by an eighth-order Runge-Kutta method."""
    return solve_ivp(rate, (0.0, time), start, method="DOP853", rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("mass", [0.1, 0.4, 1.0, 10.0])
@pytest.mark.parametrize("time", [0.001, 0.05, 0.3])
def test_spring_state_is_what_integration_gives(mass, time):
    end = integrated(lambda t, s: [s[1], (-1000.0 * s[0] - 40.0 * s[1]) / mass], [0.2, -1.5], time).y[:, -1]
    assert exact.spring_state(0.2, -1.5, mass, 1000.0, 40.0, time) == pytest.approx(end, abs=1e-9)
