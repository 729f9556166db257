"""Angular velocity of bodies whose rotation vector grows evenly, against finite differences of the rotation itself."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.path import of_rotation_vector

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def rates(t: float, w: np.ndarray, alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angular velocity and acceleration after t seconds of the path exp(w t + alpha t^2 / 2)."""
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
