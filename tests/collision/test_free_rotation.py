"""Free rotation against a general integrator and its invariants."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from avatarsim.collision.path import make_series, spun, tumbled

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

INERTIA = np.array([[0.8, 0.1, 0.0], [0.1, 1.1, -0.05], [0.0, -0.05, 0.6]])


def as_columns(m: np.ndarray):
    """A matrix as the kernels want it."""
    return tuple(tuple(column) for column in m.T)


def step(turn: np.ndarray, w: np.ndarray, t: float, inertia: np.ndarray = INERTIA) -> tuple[np.ndarray, np.ndarray]:
    """`tumbled` in numpy's terms."""
    c, rate = tumbled(as_columns(inertia), as_columns(np.linalg.inv(inertia)), as_columns(turn), tuple(w), t, make_series())
    return np.array(c).T, np.array(rate)


def test_agrees_with_an_integrator() -> None:
    turn, w = Rotation.from_rotvec([0.3, -1.0, 0.5]).as_matrix(), np.array([2.0, 5.0, -1.0])

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        r, body = y[:9].reshape(3, 3), y[9:]
        hat = np.array([[0, -body[2], body[1]], [body[2], 0, -body[0]], [-body[1], body[0], 0]])
        return np.concatenate([(r @ hat).ravel(), np.linalg.solve(INERTIA, np.cross(INERTIA @ body, body))])

    start = np.concatenate([turn.ravel(), turn.T @ w])
    end = solve_ivp(rate, (0.0, 1.3), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    r, rate_end = step(turn, w, 1.3)
    np.testing.assert_allclose(r, end[:9].reshape(3, 3), atol=1e-9)
    np.testing.assert_allclose(r.T @ rate_end, end[9:], atol=1e-9)


@settings(max_examples=50)
@given(st.tuples(*[st.floats(-30.0, 30.0)] * 3), st.floats(0.0, 0.2))
def test_conserves_momentum_and_energy(w: tuple[float, float, float], t: float) -> None:
    turn = Rotation.from_rotvec([0.3, -1.0, 0.5]).as_matrix()
    r, after = step(turn, np.array(w), t)
    np.testing.assert_allclose(r @ r.T, np.eye(3), atol=1e-14)
    before_l, after_l = turn @ INERTIA @ turn.T @ w, r @ INERTIA @ r.T @ after
    scale = np.linalg.norm(before_l) + 1e-300
    np.testing.assert_allclose(after_l / scale, before_l / scale, atol=1e-13)
    assert after @ after_l == pytest.approx(w @ before_l, rel=1e-12)


def test_a_slender_rod_at_100_rad_per_s_for_a_minute() -> None:
    inertia, turn = np.diag([1.0, 1.0, 1e-3]), np.eye(3)
    w = np.array([1.0, 0.5, 100.0])
    momentum, energy = inertia @ w, w @ inertia @ w
    for _ in range(200):
        turn, w = step(turn, w, 0.3, inertia)
    np.testing.assert_allclose(turn @ inertia @ turn.T @ w, momentum, rtol=1e-11)
    assert w @ turn @ inertia @ turn.T @ w == pytest.approx(energy, rel=1e-10)


def test_constant_spin_is_a_rotation_vector() -> None:
    w, turn = np.array([0.3, -2.0, 1.0]), Rotation.from_rotvec([1.0, 0.2, 0.1]).as_matrix()
    expected = Rotation.from_rotvec(0.7 * w).as_matrix() @ turn
    np.testing.assert_allclose(np.array(spun(as_columns(turn), tuple(w), 0.7)).T, expected, atol=1e-14)
    np.testing.assert_array_equal(np.array(spun(as_columns(turn), (0.0, 0.0, 0.0), 0.7)).T, turn)
