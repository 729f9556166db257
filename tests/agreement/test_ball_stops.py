"""PyBullet's balls at their limits: excess is found as the measure of limits finds it, and held back."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.joint import Ball, SwingTwist
from avatarsim.spatial import rotation
from reference.target_kernels import BEYOND, beyond_stops
from scenarios import catalog
from scenarios.measure.posture.joints import places
from scenarios.measure.posture.limits import joint_limit_excess, swing_twist
from tests.agreement.rivals import PybulletEngine, needs_pybullet
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


def worst_excess(force: float) -> float:
    """Largest excess [deg] over any limit while a user runs, legs brushing one another, motors holding so hard [N m]."""
    scenario = catalog.get("mocap_run")
    scene = scenario.build()
    motion, engine, first = scenario.motion(scene, 0), PybulletEngine(), len(scene.bodies)
    frames = [engine.load(scene, Settings("tuned", {"limit_force": force}), scenario.dt)]
    frames += [engine.advance(motion(frame), scenario.dt) for frame in range(scenario.short or scenario.frames)]
    engine.close()
    turns = np.array([frame.shown.orientations[first:] for frame in frames])
    return float(np.degrees(np.max(joint_limit_excess(scene, turns, np.array([frame.angles for frame in frames])))))


@needs_pybullet
def test_legs_that_meet_stay_within_a_few_degrees() -> None:
    assert any(isinstance(place.joint, Ball) for place in places(catalog.get("mocap_run").build()))
    assert worst_excess(5000.0) < 5.0 < 50.0 < worst_excess(0.0)


@needs_pybullet
@pytest.mark.parametrize("force", [0.0, 5000.0])
def test_a_scene_without_balls_is_what_it_was(force: float) -> None:
    scenario = catalog.get("hand_over_table")
    scene, engine = scenario.build(), PybulletEngine()
    engine.load(scene, Settings("tuned", {"limit_force": force}), scenario.dt)
    assert not engine._drive._stops
    engine.close()
