"""Spring, coach and trainee, and reach against a second derivation each."""

from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from reference import closed_form as exact


def integrated(rate, start, time):
    """State at `time` by an eighth-order Runge-Kutta method."""
    return solve_ivp(rate, (0.0, time), start, method="DOP853", rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("mass", [0.1, 0.4, 1.0, 10.0])
@pytest.mark.parametrize("time", [0.001, 0.05, 0.3])
def test_spring_state_is_what_integration_gives(mass, time):
    end = integrated(lambda t, s: [s[1], (-1000.0 * s[0] - 40.0 * s[1]) / mass], [0.2, -1.5], time).y[:, -1]
    assert exact.spring_state(0.2, -1.5, mass, 1000.0, 40.0, time) == pytest.approx(end, abs=1e-9)


def test_spring_overshoot_is_the_deepest_swing():
    times = np.linspace(0.0, 1.0, 20_001)
    deepest = min(exact.spring_state(1.0, 0.0, 1.0, 1000.0, 40.0, float(t))[0] for t in times)
    assert exact.spring_overshoot(1.0, 1000.0, 40.0) == pytest.approx(-deepest, abs=1e-6)
    assert exact.spring_overshoot(1.0, 1000.0, 40.0) == pytest.approx(0.0769, abs=5e-5)
    assert exact.damping_ratio(1.0, 1000.0, 40.0) == pytest.approx(0.632, abs=5e-4)
    assert exact.spring_overshoot(0.4, 1000.0, 40.0) == 0.0


def test_semi_implicit_spring_grows_just_beyond_the_stable_step():
    def radius(step):
        # v' = v - dt (K x + R v) / m, x' = x + dt v'
        v = np.array([-1000.0 * step, 1.0 - 40.0 * step])
        return max(abs(np.linalg.eigvals(np.array([np.array([1.0, 0.0]) + step * v, v]))))

    edge = exact.spring_stable_step(1.0, 1000.0, 40.0)
    assert edge == pytest.approx(0.0348, abs=5e-5)
    assert radius(0.999 * edge) < 1.0 < radius(1.001 * edge)


def test_coach_and_trainee_return_exponentially_and_lag_behind_a_moving_coach():
    still = integrated(lambda t, s: [-s[0] / 0.2], [0.3], 0.5).y[0, -1]
    assert exact.coach_offset(0.3, 0.5, 0.2) == pytest.approx(still, abs=1e-11)
    # the coach runs away at 1.5 per second for many time constants
    late = integrated(lambda t, s: [1.5 - s[0] / 0.2], [0.0], 8.0).y[0, -1]
    assert exact.coach_steady_offset(1.5, 0.2) == pytest.approx(late, abs=1e-9)


@given(shoulder=st.floats(-3, 3), elbow=st.floats(0.01, 3.1))
def test_reach_angles_bring_the_tip_to_the_goal(shoulder, elbow):
    x = 0.3 * cos(shoulder) + 0.25 * cos(shoulder + elbow)
    y = 0.3 * sin(shoulder) + 0.25 * sin(shoulder + elbow)
    a, b = exact.reach_angles(0.3, 0.25, x, y)
    assert b == pytest.approx(elbow, abs=1e-6)
    assert (0.3 * cos(a) + 0.25 * cos(a + b), 0.3 * sin(a) + 0.25 * sin(a + b)) == pytest.approx((x, y), abs=1e-9)


@pytest.mark.parametrize("goal", [(1.0, 0.5), (0.02, 0.01), (0.3, 0.1)])
def test_reach_shortfall_is_the_least_over_all_elbows(goal):
    reached = [hypot(0.3 + 0.2 * cos(b), 0.2 * sin(b)) for b in np.linspace(0.0, pi, 20_001)]
    least = min(abs(hypot(*goal) - r) for r in reached)
    assert exact.reach_shortfall((0.3, 0.2), goal) == pytest.approx(least, abs=1e-4)
    a, b = exact.reach_angles(0.3, 0.2, *goal)
    tip = (0.3 * cos(a) + 0.2 * cos(a + b), 0.3 * sin(a) + 0.2 * sin(a + b))
    assert hypot(tip[0] - goal[0], tip[1] - goal[1]) == pytest.approx(exact.reach_shortfall((0.3, 0.2), goal), abs=1e-7)
