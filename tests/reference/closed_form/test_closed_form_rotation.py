"""Flip times of free rotation, and precession of a top, against numerical integration."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from reference.closed_form import flip_times, top_precession

Triple = tuple[float, float, float]


def integrated(moments: Triple, spin: Triple, until: float) -> list[float]:
    """Return zeros of the spin about the middle axis, by an eighth-order Runge-Kutta method."""
    i, mid = np.array(moments), sorted(range(3), key=lambda axis: moments[axis])[1]

    def rate(t: float, w: np.ndarray) -> np.ndarray:
        return np.cross(i * w, w) / i

    def crosses(t: float, w: np.ndarray) -> float:
        return float(w[mid])

    way = solve_ivp(rate, (0.0, until), spin, method="DOP853", rtol=1e-12, atol=1e-13, events=crosses, max_step=0.05)
    return [float(time) for time in way.t_events[0]]


def test_the_published_flips_of_a_box() -> None:
    i = (0.97 * 10.0 / 12.0, 0.82 * 10.0 / 12.0, 0.17 * 10.0 / 12.0)
    assert flip_times(i, (0.1, 5.0, 0.1), 8.0) == pytest.approx([1.166, 4.194, 7.223], abs=1e-3)
    assert flip_times(i, (0.1, 5.0, 0.1), 20.0) == pytest.approx(integrated(i, (0.1, 5.0, 0.1), 20.0), abs=1e-8)


@settings(max_examples=20, deadline=None)
@given(
    order=st.permutations([1.0, 1.7, 2.2]), spin=st.tuples(*[st.floats(0.3, 3.0)] * 3),
    signs=st.tuples(*[st.sampled_from([-1.0, 1.0])] * 3),
)
def test_flips_are_where_integration_puts_them(order: list[float], spin: Triple, signs: Triple) -> None:
    moments = (order[0], order[1], order[2])
    first = tuple(s * w for s, w in zip(signs, spin, strict=True))
    energy = sum(i * w * w for i, w in zip(moments, first, strict=True))
    square = sum((i * w) ** 2 for i, w in zip(moments, first, strict=True))
    # at the separatrix a flip takes for ever
    if abs(square / energy - 1.7) < 1e-2:
        return
    wanted = integrated(moments, (first[0], first[1], first[2]), 12.0)
    found = flip_times(moments, (first[0], first[1], first[2]), 12.0)
    near = [time for time in wanted if time < 11.9]
    assert list(found)[: len(near)] == pytest.approx(near, abs=1e-6)


def swung(across: float, along: float, mass: float, reach: float, spin: float, lean: float, nods: int) -> float:
    """Return the mean rate of precession over whole nods, from Lagrange's equation of the lean of a top on a smooth plane."""

    def rate(t: float, state: np.ndarray) -> list[float]:
        angle, nod, _ = state
        s, c = np.sin(angle), np.cos(angle)
        goes_round = along * spin * (np.cos(lean) - c) / (across * s * s)
        inertia = across + mass * reach**2 * s * s
        push = mass * 9.81 * reach * s + across * goes_round**2 * s * c - along * spin * goes_round * s
        return [nod, (push - mass * reach**2 * s * c * nod**2) / inertia, goes_round]

    def upright_again(t: float, state: np.ndarray) -> float:
        return float(state[1])

    upright_again.direction = -1.0  # type: ignore[attr-defined]  # scipy reads it
    way = solve_ivp(rate, (0.0, 2.0), [lean, 0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-14, events=upright_again)
    # the nod turns at its lowest and highest lean; of falling signs every one is a lowest
    times, angles = way.t_events[0], way.y_events[0][:, 2]
    return float((angles[nods] - angles[0]) / (times[nods] - times[0]))


@pytest.mark.parametrize(("spin", "lean"), [(200.0, 0.2), (120.0, 0.2), (90.0, 0.7), (-150.0, 1.2)])
def test_a_top_goes_round_as_integration_has_it(spin: float, lean: float) -> None:
    top = (3e-5, 4e-5, 0.1, 0.029)
    assert top_precession(*top, spin, lean, 9.81) == pytest.approx(swung(*top, spin, lean, 10), rel=1e-8)


def test_a_fast_top_goes_round_at_weight_times_reach_over_spin() -> None:
    fast = 0.1 * 9.81 * 0.029 / (4e-5 * 5000.0)
    assert top_precession(3e-5, 4e-5, 0.1, 0.029, 5000.0, 0.2, 9.81) == pytest.approx(fast, rel=1e-3)
