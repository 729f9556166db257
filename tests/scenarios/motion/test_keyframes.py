"""Scripted motion: through its keys, smooth, with no two repetitions alike, and equal for equal seeds."""

import numpy as np
import pytest

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Sphere
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.cases import driven
from scenarios.motion.keyframes import again_and_again, minimum_jerk, posed, through
from scenarios.motion.rigid_hands import eased, led
from scenarios.scenario import RENDERED

HUMAN = humanoid()
START = standing(HUMAN)


def lifted(random: np.random.Generator) -> TrackerSample:
    return posed(HUMAN, START, {"left_shoulder": (0.0, -90.0 + random.normal(0.0, 5.0), 0.0)}, {"left_elbow": (40.0,)})


def test_minimum_jerk_starts_and_ends_at_rest() -> None:
    u = np.linspace(0.0, 1.0, 1001)
    way = minimum_jerk(u)
    assert way[0] == 0.0 and way[-1] == pytest.approx(1.0)
    speed = np.gradient(way, u)
    assert speed[0] == pytest.approx(0.0, abs=1e-4) and speed[-1] == pytest.approx(0.0, abs=1e-4)
    assert speed.max() == pytest.approx(1.875, abs=1e-3)


def test_a_track_goes_through_its_keys_and_then_rests() -> None:
    up = posed(HUMAN, START, {"left_shoulder": (0.0, -90.0, 0.0)}, {"left_elbow": (40.0,)}, (0.1, 0.0, 0.0))
    track = through(START, [(0.5, up), (1.0, START)], 70)
    assert track.posture(29).time == pytest.approx(30 * RENDERED)
    assert np.allclose(track.posture(29).rotations, up.rotations) and np.allclose(track.posture(29).angles, up.angles)
    assert track.posture(29).positions[0, 0] == pytest.approx(0.1)
    assert np.allclose(track.posture(59).rotations, START.rotations) and np.allclose(track.posture(69).angles, START.angles)


def test_longer_track_of_a_seed_begins_as_a_shorter_one() -> None:
    def ready(random: np.random.Generator) -> TrackerSample:
        return START

    short, long, other = (again_and_again(START, ready, lifted, *how) for how in ((200, 0), (400, 0), (200, 1)))
    assert np.array_equal(short.rotations, long.rotations[:200])
    assert not np.allclose(short.rotations, other.rotations)


def test_wrong_keys_and_joints_are_refused() -> None:
    with pytest.raises(InvalidInput, match="times of the keys"):
        through(START, [(0.5, START), (0.5, START)], 10)
    with pytest.raises(UnknownName, match="left_shoulder"):
        posed(HUMAN, START, {"left_sholder": (0.0, 0.0, 0.0)})


def test_a_led_hand_is_where_it_should_be_at_the_end_of_a_frame() -> None:
    scene = Scene("led", (), (driven("hand", Sphere(0.1), 1.0), driven("other", Sphere(0.1), 1.0)))
    sample = led(lambda time: ((time, 2.0 * time, 0.5), (0.0, -time, 0.0)))(scene, 0)(5)
    assert sample.time == pytest.approx(6 * RENDERED)
    assert sample.positions.tolist() == [[sample.time, 2.0 * sample.time, 0.5], [0.0, -sample.time, 0.0]]


def test_a_way_is_eased_from_rest_to_rest() -> None:
    shares = np.array([eased(time, 1.0, 3.0) for time in np.linspace(0.0, 4.0, 401)])
    assert shares[0] == shares[100] == 0.0 and shares[200] == pytest.approx(0.5) and shares[300] == shares[-1] == 1.0
    steps = np.diff(shares)
    assert (steps >= 0.0).all() and steps[101] < 0.01 * steps.max() and steps[298] < 0.01 * steps.max()
