"""Eq. 6: m x'' = -K x - R x', solved exactly for any frame time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from avatarsim.coupling.equation_6 import coupled
from avatarsim.settings import CouplingSettings

SPRING, DAMPING = CouplingSettings()
"""K [N/m] that the authors found to work well, and R [N s/m] that goes with it: critical for 0.4 kg."""

START, PUSH = (0.1, -0.02, 0.0), (0.0, 1.0, -3.0)


def integrated(mass: float, damping: float, t: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the plain twin: a general integrator."""
    solution = solve_ivp(
        lambda _, y: np.concatenate([y[3:], (-SPRING * y[:3] - damping * y[3:]) / mass]), (0.0, t), [*START, *PUSH],
        method="DOP853", rtol=1e-12, atol=1e-14,
    )
    return solution.y[:3, -1], solution.y[3:, -1]


@pytest.mark.parametrize("mass", [0.1, 0.3999999, 0.4, 0.4000001, 1.0, 10.0])
@pytest.mark.parametrize("t", [1.0 / 1000.0, 1.0 / 60.0, 1.0 / 30.0, 0.5])
def test_agrees_with_an_integrator(mass: float, t: float) -> None:
    """Over-damped below 0.4 kg, critical at it, under-damped above."""
    x, v = coupled(mass, SPRING, DAMPING, START, PUSH, t)
    expected_x, expected_v = integrated(mass, DAMPING, t)
    np.testing.assert_allclose(x, expected_x, atol=1e-10)
    np.testing.assert_allclose(v, expected_v, atol=1e-9)


def test_the_authors_values_overshoot_as_a_ratio_of_0_632_must() -> None:
    """m = 1 kg: damping ratio 20/sqrt(1000), overshoot exp(-pi zeta / sqrt(1 - zeta^2)) = 7.69 %."""
    times = np.linspace(0.0, 1.0, 20001)
    lowest = min(coupled(1.0, SPRING, DAMPING, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), t)[0][0] for t in times)
    zeta = DAMPING / (2.0 * np.sqrt(SPRING))
    assert -lowest == pytest.approx(np.exp(-np.pi * zeta / np.sqrt(1.0 - zeta**2)), rel=1e-6)
    assert -lowest == pytest.approx(0.0769, abs=5e-5)


@given(mass=st.floats(0.01, 100.0), damping=st.floats(0.0, 2000.0), t=st.floats(0.0, 1.0))
def test_two_half_frames_are_one_frame(mass: float, damping: float, t: float) -> None:
    """Exactness means that the frame time does not matter."""
    x, v = coupled(mass, SPRING, damping, START, PUSH, t)
    half = coupled(mass, SPRING, damping, *coupled(mass, SPRING, damping, START, PUSH, 0.5 * t), 0.5 * t)
    np.testing.assert_allclose(half[0], x, atol=1e-11)
    np.testing.assert_allclose(half[1], v, atol=1e-8)


@given(mass=st.floats(1e-3, 100.0), damping=st.floats(0.0, 1e6), t=st.floats(0.0, 10.0))
def test_energy_never_grows(mass: float, damping: float, t: float) -> None:
    """Stable beyond 34.8 ms, where semi-implicit Euler is not, and however stiff."""
    x, v = coupled(mass, SPRING, damping, START, PUSH, t)
    before = mass * np.dot(PUSH, PUSH) + SPRING * np.dot(START, START)
    assert mass * np.dot(v, v) + SPRING * np.dot(x, x) <= before * (1.0 + 1e-9)
