"""Time kept: 0 for closed forms with impacts inside frames, the injected share where time stops or runs fast."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from reference.closed_form import bounce_state
from runfiles.record import Recording
from scenarios.measure.bodies.time_kept import time_kept
from tests.scenarios.examples import DT, drop_scene, resting
from tests.scenarios.measure.test_metamorphic import run

BALL = 1
FRAMES = 60


def moved(place: Callable[[float], Sequence[float]], velocity: Callable[[float], Sequence[float]]) -> Recording:
    """Return a recording of the ball along a closed form."""
    recording = resting(drop_scene(), FRAMES)
    recording.positions[:, BALL] = [place(float(t)) for t in recording.times]
    recording.velocities[:, BALL] = [velocity(float(t)) for t in recording.times]
    return recording


def figures(recording: Recording) -> tuple[float, float]:
    found = time_kept(recording, drop_scene())
    return float(str(found["time_kept_error"])), float(str(found["stalled_bodies"]))


def uniform(speed: float) -> Recording:
    return moved(lambda t: (speed * t, 0.0, 1.0), lambda t: (speed, 0.0, 0.0))


def test_an_injected_share_of_the_way_comes_out() -> None:
    """The share is found by time_kept_error, and by stalled_bodies below a fifth."""
    recording = uniform(2.0)
    assert figures(recording) == pytest.approx((0.0, 0.0), abs=1e-12)
    for share, stalled in ((0.7, 0.0), (0.21, 0.0), (0.19, 100.0), (0.0, 100.0), (-0.5, 100.0)):
        late = replace(recording, positions=recording.positions * np.array([share, 1.0, 1.0]))
        assert figures(late) == pytest.approx((1.0 - share, stalled), abs=1e-12)
    ahead = replace(recording, positions=recording.positions * np.array([1.3, 1.0, 1.0]))
    assert figures(ahead) == pytest.approx((0.3, 0.0), abs=1e-12)


def test_ways_gone_too_far_do_not_make_up_for_a_body_that_stalls() -> None:
    recording = uniform(1.0)
    for row, stalled in ((1, 0.0), (3, 50.0)):
        stopped = np.arange(FRAMES) // row % 2 == 0
        recording.positions[1:, BALL, 0] = np.cumsum(np.where(stopped, 0.0, 2.0 * DT))
        assert figures(recording) == pytest.approx((0.0, stalled), abs=1e-12)


@pytest.mark.parametrize(("row", "stalled"), [(1, 0.0), (3, 25.0), (5, 25.0), (15, 25.0)])
def test_creeping_body_lacks_its_share_and_stalls_after_three(row: int, stalled: float) -> None:
    recording = uniform(1.0)
    creeps = np.arange(FRAMES) // row % 4 == 3
    recording.positions[1:, BALL, 0] = np.cumsum(np.where(creeps, 3e-8, DT))
    assert figures(recording) == pytest.approx((0.25, stalled), abs=1e-5)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.8, 1.0])
def test_a_ball_that_bounces_within_frames_keeps_its_time(restitution: float) -> None:
    def state(t: float) -> tuple[float, float]:
        return bounce_state(1.0, restitution, 9.81, t)

    error, stalled = figures(moved(lambda t: (0.7 * t, 0.0, 0.1 + state(t)[0]), lambda t: (0.7, 0.0, state(t)[1])))
    assert error < 1e-3 and stalled == 0.0


def test_frozen_ball_cannot_hide_behind_an_impact() -> None:
    """The velocity along the floor predicts the motion, for any effect of the floor on the normal part."""
    signs = np.where(np.arange(FRAMES + 1) % 2, 1.0, -1.0)
    recording = resting(drop_scene(), FRAMES)
    recording.velocities[:, BALL] = np.stack([np.full(FRAMES + 1, 0.9), np.zeros(FRAMES + 1), signs], axis=1)
    assert figures(recording) == pytest.approx((1.0, 100.0))
    # if the whole velocity reverses, the ball may not move at all: this proves neither
    recording.velocities[:, BALL, 0] = 0.0
    assert figures(recording) == (0.0, 0.0)


def test_rolling_body_off_its_centre_of_mass_keeps_its_time() -> None:
    """The origin differs from the centre of mass, as it may for a hull."""
    scene = drop_scene()
    ball = scene.bodies[BALL]
    assert ball.mass is not None
    off = replace(scene, bodies=(scene.bodies[0], replace(ball, mass=replace(ball.mass, centre=(0.0, 0.05, 0.0)))))
    recording, angle = resting(off, FRAMES), 10.0 * np.arange(FRAMES + 1) * DT
    turn = np.stack([np.cos(0.5 * angle), *np.zeros((2, FRAMES + 1)), np.sin(0.5 * angle)], axis=1)
    arm = 0.05 * np.stack([-np.sin(angle), np.cos(angle), 0.0 * angle], axis=1)
    recording.orientations[:, BALL] = turn
    recording.positions[:, BALL] = np.stack([angle / 10.0, 0.0 * angle, 0.0 * angle + 1.0], axis=1) - arm
    recording.velocities[:, BALL, 0] = 1.0
    found = time_kept(recording, off)
    assert found["time_kept_error"] == pytest.approx(0.0, abs=1e-12) and found["stalled_bodies"] == 0.0


def test_slow_bodies_do_not_count_and_nan_stays_nan() -> None:
    slow = resting(drop_scene(), FRAMES)
    slow.velocities[:, BALL, 0] = 0.019
    assert figures(slow) == (0.0, 0.0)
    slow.velocities[:, BALL, 0] = 0.021
    assert figures(slow) == pytest.approx((1.0, 100.0))
    slow.positions[7, BALL, 2] = np.nan
    assert np.isnan(figures(slow)).all()


@pytest.mark.parametrize("name", ["ball_drop", "bounce_ladder", "newton_cradle", "slide_to_roll", "stop_distance", "log_roll"])
def test_exact_scenes_of_the_catalogue_keep_their_time(name: str) -> None:
    _, scene, recording = run("avatarsim", name, 60)
    found = time_kept(recording, scene)
    assert found["time_kept_error"] == pytest.approx(0.0, abs=1e-4) and found["stalled_bodies"] == 0.0
