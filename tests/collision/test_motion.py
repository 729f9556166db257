"""Paths of bodies in free and driven rotation, and bounds of their points' motion."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.collision.motion_bounds import ROUNDED, arm_about, turning
from avatarsim.collision.path import FREE, HELD, STILL, make_paths, make_series, of_rotation_vector, spun, tumbled
from avatarsim.spatial import rotation
from tests.collision.dense import Flying

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

INERTIA = np.array([[0.8, 0.1, 0.0], [0.1, 1.1, -0.05], [0.0, -0.05, 0.6]])


def as_columns(m: np.ndarray):
    """Return a matrix as the kernels take it."""
    return tuple(tuple(column) for column in m.T)


def step(turn: np.ndarray, w: np.ndarray, t: float, inertia: np.ndarray = INERTIA) -> tuple[np.ndarray, np.ndarray]:
    """Return `tumbled` in numpy's terms."""
    c, rate = tumbled(as_columns(inertia), as_columns(np.linalg.inv(inertia)), as_columns(turn), tuple(w), t, make_series())
    return np.array(c).T, np.array(rate)


def test_agrees_with_an_integrator() -> None:
    """At the end of the way; its rate there follows from the momentum, below."""
    turn, w, still = Rotation.from_rotvec([0.3, -1.0, 0.5]), np.array([2.0, 5.0, -1.0]), np.zeros(3)
    expected = Flying(still[None], still, turn, still, w, still, INERTIA).turns(np.array([0.0, 1.3]))[-1]
    np.testing.assert_allclose(step(turn.as_matrix(), w, 1.3)[0], expected, atol=1e-9)


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


def rates(t: float, w: np.ndarray, alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the angular velocity and acceleration after t seconds of the path exp(w t + alpha t^2 / 2)."""
    theta = w * t + 0.5 * alpha * t * t
    spin, twist = of_rotation_vector(tuple(theta), tuple(w + alpha * t), tuple(alpha))
    return np.array(spin), np.array(twist)


@pytest.mark.parametrize("t", [0.0, 0.02, 0.3, 1.1])
def test_the_true_spin_of_a_held_body(t: float) -> None:
    w, alpha, dt = np.array([0.7, -1.0, 0.4]), np.array([-2.0, 0.5, 3.0]), 1e-5

    def turn(at: float) -> Rotation:
        return Rotation.from_rotvec(w * at + 0.5 * alpha * at * at)

    spin, twist = rates(t, w, alpha)
    np.testing.assert_allclose(spin, (turn(t + dt) * turn(t - dt).inv()).as_rotvec() / (2.0 * dt), atol=1e-8)
    after, before = rates(t + dt, w, alpha)[0], rates(t - dt, w, alpha)[0]
    np.testing.assert_allclose(twist, (after - before) / (2.0 * dt), atol=1e-8)


def test_series_and_closed_form_meet() -> None:
    """Both sides of the angle at which the one takes over from the other."""
    axis, rate, gain = np.array([0.6, 0.0, 0.8]), (1.0, 2.0, -3.0), (0.5, 4.0, 1.0)
    low = of_rotation_vector(tuple(0.5 * (1.0 - 1e-12) * axis), rate, gain)
    high = of_rotation_vector(tuple(0.5 * (1.0 + 1e-12) * axis), rate, gain)
    np.testing.assert_allclose(np.array(low), np.array(high), rtol=0.0, atol=1e-9)


STEP = 1e-4


def of_vector(theta: np.ndarray) -> np.ndarray:
    """Return the rotation matrix exp(theta)."""
    return rotation.to_matrix(rotation.from_rotation_vector(theta))


def body(kind: int, round_: bool, spin, twist, time: float = 0.0):
    """Return one body's path."""
    paths = make_paths(np.eye(3)[None], np.eye(3)[None], np.array([int(round_)]))
    paths.kind[0], paths.w[0], paths.angular[0], paths.time[0] = kind, spin, twist, time
    return paths


@pytest.mark.nojit
@pytest.mark.boundscheck
def test_what_turns_about_its_axis_moves_no_point_of_it() -> None:
    on, off = (0.0, 0.2, 0.0), (0.0, 0.2, 0.1)
    spin, twist = (0.0, 40.0, 0.0), (0.0, -30.0, 0.0)
    for paths in (body(HELD, False, spin, twist), body(FREE, True, spin, (0.0, 0.0, 0.0))):
        assert arm_about(paths, 0, on, 0.01) == pytest.approx(ROUNDED * 0.2)
        assert arm_about(paths, 0, off, 0.01) == pytest.approx(0.1, rel=1e-8)
    whole = float(np.linalg.norm(off))
    assert arm_about(body(FREE, False, spin, (0.0, 0.0, 0.0)), 0, off, 0.01) == whole
    assert arm_about(body(STILL, False, spin, twist), 0, off, 0.01) == whole
    # whose spin may end meanwhile has no axis that one knows
    assert arm_about(body(HELD, False, (0.0, 1e-3, 0.0), twist), 0, off, 0.01) == whole


@pytest.mark.parametrize("across", [0.0, 1e-3, 1.0, 30.0])
def test_points_keep_within_the_bounds_of_their_arm(across: float) -> None:
    """Acceleration and jerk of a held body's points, by differences, at any time of the horizon."""
    rng = np.random.default_rng(int(1e3 * across))
    for _ in range(30):
        spin, horizon = rng.normal(size=3) * rng.choice([5.0, 40.0]), 0.01
        tilted = rng.normal(size=3)
        tilted -= spin * (spin @ tilted) / (spin @ spin)
        twist = rng.uniform(-1.0, 1.0) * spin + across * tilted
        start = rng.uniform(0.0, 0.005)
        point = rng.normal(size=3)
        if rng.random() < 0.5:
            point = 0.2 * spin / np.linalg.norm(spin) + 1e-3 * point
        paths = body(HELD, False, spin + start * twist, twist, start)
        turned = of_vector(spin * start + 0.5 * start * start * twist) @ point
        arm = arm_about(paths, 0, tuple(turned), horizon)
        speed, gain, jerk = turning(paths, 0, False, horizon)
        for t in start + np.linspace(0.0, horizon, 5):
            at = [of_vector(spin * s + 0.5 * s * s * twist) @ point for s in t + STEP * np.arange(-2, 3)]
            second = np.linalg.norm(at[3] - 2.0 * at[2] + at[1]) / STEP**2
            third = np.linalg.norm(at[4] - 2.0 * at[3] + 2.0 * at[1] - at[0]) / (2.0 * STEP**3)
            noise = 1e-15 * np.linalg.norm(point)
            assert second <= (speed * speed + gain) * arm * (1.0 + 1e-3) + 8.0 * noise / STEP**2
            assert third <= jerk * arm * (1.0 + 1e-2) + 8.0 * noise / STEP**3
