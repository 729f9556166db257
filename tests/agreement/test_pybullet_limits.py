"""Limits of PyBullet's joints: the excess of balls equals that of the metric of limits, and is limited."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.joint import Ball, SwingTwist
from avatarsim.spatial import rotation
from reference.target_kernels import BEYOND, beyond_stops
from scenarios import catalog
from scenarios.measure.posture.joints import places
from scenarios.measure.posture.limits import swing_twist
from tests.agreement.rivals import PybulletEngine, needs_pybullet
from tests.agreement.runs import limit_excess, loaded, of_catalog
from tests.agreement.scenes import turned


def test_beyond_is_what_the_measure_of_limits_calls_beyond() -> None:
    draw, n = np.random.default_rng(5), 2000
    axis, centre = np.array([0.6, 0.0, 0.8]), np.array([0.0, 1.0, 0.0])
    limits = SwingTwist(tuple(axis), tuple(centre), 1.2, (-0.4, 0.9))
    rest, frame = np.array(turned(1)), np.array(turned(2))
    turns = rotation.normalised(draw.normal(size=(n, 4)))
    swing, twist = swing_twist(limits, rotation.multiply(rest, turns))
    wanted = (swing > limits.swing + BEYOND) | (twist < limits.twist[0] - BEYOND) | (twist > limits.twist[1] + BEYOND)
    states = rotation.multiply(rotation.conjugate(frame), rotation.multiply(turns, frame))[:, [1, 2, 3, 0]]
    left = rotation.multiply(rotation.multiply(rotation.conjugate(rotation.between(axis, centre)), rest), frame)
    found = np.zeros(n, dtype=np.bool_)
    beyond_stops(
        states, np.tile(left, (n, 1)), np.tile(rotation.conjugate(frame), (n, 1)), np.tile(axis, (n, 1)),
        np.tile([limits.swing, *limits.twist], (n, 1)), found,
    )
    assert 0.1 * n < wanted.sum() < 0.95 * n
    assert (found == wanted).all()


def worst_excess(name: str, frames: int | None, options: dict[str, object]) -> float:
    """Return the largest excess [deg] over any limit in a scene of the catalogue."""
    return float(limit_excess(*of_catalog(PybulletEngine(), name, Settings("tuned", options), frames)).max())


@needs_pybullet
def test_limits_and_motors_keep_balls_of_legs_that_meet() -> None:
    scenario = catalog.get("mocap_run")
    assert any(isinstance(place.joint, Ball) for place in places(scenario.build()))
    assert worst_excess("mocap_run", scenario.short, {}) < 12.0
    assert worst_excess("mocap_run", scenario.short, {"ball_limits": False}) < 5.0
    assert worst_excess("mocap_run", scenario.short, {"limit_force": 0.0}) < 25.0
    assert worst_excess("mocap_run", scenario.short, {"limit_force": 0.0, "ball_limits": False}) > 50.0


@needs_pybullet
def test_a_hand_in_a_corner_led_by_a_hand_keeps_its_limits() -> None:
    """The hand is in the corner from the tenth frame on; forces strong enough for a body violate its fingers' limits."""
    assert worst_excess("hand_in_corner", 40, {}) < 20.0
    assert worst_excess("hand_in_corner", 40, {"root_force": 2000.0, "hinge_force": 100.0, "solver_iterations": 50}) > 60.0


@needs_pybullet
@pytest.mark.parametrize("force", [0.0, 5000.0])
def test_scenes_without_balls_have_no_stops(force: float) -> None:
    scenario = catalog.get("hand_over_table")
    engine = loaded(PybulletEngine(), scenario.build(), Settings("tuned", {"limit_force": force}), scenario.dt)
    assert not engine._drive._stops
    engine.close()
