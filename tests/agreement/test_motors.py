"""MuJoCo's avatars driven by motors: hinges and balls end at their targets, and no joint overshoots."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from reference.in_mujoco.engine import MujocoEngine
from tests.agreement.runs import FRAME, limit_excess, loaded, played
from tests.agreement.scenes import LIMITS, chain, every_joint, posture, swung

MOTORS: dict[str, object] = {
    "drive": "motors", "motor_force": 0.0, "integrator": "DISCRETE", "refsafe": False, "contact": "soft", "contact_steps": 0.1,
    "limit_steps": 0.1,
}
"""Options of motors. Without DISCRETE, contacts and limits are solved without the damping of the servos that press on them."""


def settled(scene: Scene, goal: TrackerSample, options: dict[str, object], frames: int = 120) -> tuple[MujocoEngine, list[float]]:
    """Return the engine after `frames` with the target `goal`, and the largest error [m] of a link in each frame."""
    engine = loaded(MujocoEngine(), scene, Settings("tuned", options))
    there, off = engine._targets.posture(goal)[0], list[float]()
    for k in range(frames):
        asked = TrackerSample((k + 1) * FRAME, goal.positions, goal.rotations, goal.angles)
        shown = engine.advance(asked, FRAME).shown
        off.append(float(np.linalg.norm(shown.positions - there, axis=1).max()))
    return engine, off


def test_hinges_of_a_free_avatar_end_where_they_are_asked_to_be() -> None:
    """Four hinges, three of them about one centre, on a root that moves and turns."""
    avatar = Avatar("hinged", tuple(link for link in every_joint().links if link.name in ("root", "one", "three")))
    _, off = settled(Scene("hinged", (), (avatar,), start=posture(avatar, 0)), posture(avatar, 1), MOTORS)
    assert off[-1] < 1e-4


def test_balls_arrive_without_swinging_on() -> None:
    """Three balls in a row return from a swing of 0.4 rad; with MuJoCo's own damping of balls they overshoot by 0.25 m."""
    engine, off = settled(Scene("chain", (), (chain(),), start=swung(20)), swung(0), {**MOTORS, "lead": 0.0})
    assert off[-1] < 1e-6 and np.abs(engine._data.qvel).max() < 1e-6
    arrived = int(np.argmax(np.array(off) < 5e-3))
    assert max(off[arrived:]) < 8e-3


def test_leading_ahead_follows_a_swing_several_times_nearer() -> None:
    """Checked from half a second on: at the start no engine can predict that the tracker will move."""
    scene, off = Scene("chain", (), (chain(),), start=swung(0)), {}
    for lead in (0.0, 1.0):
        engine = loaded(MujocoEngine(), scene, Settings("tuned", {**MOTORS, "lead": lead}))
        found = [engine.advance(swung(k), FRAME).shown.positions - engine._targets.posture(swung(k))[0] for k in range(1, 120)]
        off[lead] = float(np.linalg.norm(found[30:], axis=2).max())
    assert off[1.0] < 0.25 * off[0.0]


def test_no_ball_is_led_beyond_its_limits() -> None:
    """The target is 1.5 rad where 0.8 rad are allowed."""
    scene = Scene("cone", (), (chain(LIMITS),), start=swung(0, 0.0))
    frames = played(MujocoEngine(), scene, [swung(k, 1.5) for k in range(1, 90)], Settings("tuned", MOTORS))
    assert limit_excess(scene, frames).max() < 0.05


def test_torques_stay_within_the_limit_that_is_set() -> None:
    scene = Scene("chain", (), (chain(),), start=swung(20))
    engine, _ = settled(scene, swung(0), {**MOTORS, "motor_force": 3.0}, 1)
    forces = np.linalg.norm(engine._data.actuator_force.reshape(-1, 3), axis=1)
    assert forces.max() == pytest.approx(3.0)


@pytest.mark.parametrize(("options", "error"), [
    ({"drive": "strings"}, UnknownName), ({"drive": "motors", "motor_stiffness": 0.0}, InvalidInput),
    ({"drive": "motors", "motor_damping_ratio": -1.0}, InvalidInput), ({"drive": "motors", "motor_force": -1.0}, InvalidInput),
])
def test_words_and_figures_that_mean_nothing_are_refused(options: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error):
        MujocoEngine().load(Scene("chain", (), (chain(),), start=swung(0)), Settings("tuned", options), FRAME)
