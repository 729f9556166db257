"""Bounds of how points of turning bodies move, by their distance from the axis, against their motion itself."""

import numpy as np
import pytest

from avatarsim.collision.motion_bounds import ROUNDED, arm_about, turning
from avatarsim.collision.path import FREE, HELD, STILL, make_paths
from avatarsim.spatial import rotation

STEP = 1e-4


def of_vector(theta: np.ndarray) -> np.ndarray:
    """The rotation matrix exp(theta)."""
    return rotation.to_matrix(rotation.from_rotation_vector(theta))


def body(kind: int, round_: bool, spin, twist, time: float = 0.0):
    """One body's path."""
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
