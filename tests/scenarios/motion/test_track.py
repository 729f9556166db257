"""Tracks are cut, mirrored and led in without a jump; reach agrees with brute force over points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.errors import InvalidInput
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import solid
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.reach import reach
from scenarios.motion.mocap import load_clip, retimed
from scenarios.motion.track import LEAD_IN, Track, track_of

HUMAN = humanoid()


def numbered(frames: int) -> Track:
    """A track whose root is at x = frame."""
    positions = np.zeros((frames, 1, 3))
    positions[:, 0, 0] = np.arange(frames)
    return Track(positions, np.tile(rotation.IDENTITY, (frames, 1, 1)), np.zeros((frames, 0)))


def test_there_and_back_turns_without_a_pause() -> None:
    path = numbered(4).there_and_back(9).positions[:, 0, 0]
    assert path.tolist() == [0, 1, 2, 3, 2, 1, 0, 1, 2]


def test_backwards_begins_at_the_end() -> None:
    assert numbered(3).backwards().positions[:, 0, 0].tolist() == [2, 1, 0]


def test_times_are_those_of_the_end_of_the_frame_and_the_last_posture_stays() -> None:
    motion = numbered(3).motion()
    assert motion(0).time == pytest.approx(1.0 / 60.0)
    assert motion(59).time == pytest.approx(1.0) and motion(59).positions[0, 0] == 2.0
    with pytest.raises(InvalidInput, match="frame"):
        motion(-1)


def test_a_lead_in_goes_from_the_start_to_the_first_posture_in_small_steps() -> None:
    start = standing(HUMAN)
    clip = track_of(retimed(load_clip("punch")), HUMAN)
    led = clip.led_in(start)
    assert len(led) == len(clip) + LEAD_IN
    chain = np.concatenate([start.rotations[None], led.rotations[: LEAD_IN + 1]])
    turn = rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(chain[:-1]), chain[1:]))
    whole = rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(chain[:1]), chain[-1:]))[0]
    steps = np.linalg.norm(turn, axis=-1)
    # on a great circle the steps add up to the whole, and none is more than a twentieth of it
    assert steps.sum(axis=0) == pytest.approx(np.linalg.norm(whole, axis=-1), abs=1e-9)
    assert (steps.max(axis=0) <= 0.05 * np.linalg.norm(whole, axis=-1) + 1e-12).all()
    assert led.angles[LEAD_IN].tolist() == clip.angles[0].tolist()


def test_hinge_angles_come_in_the_order_of_the_links() -> None:
    clip = retimed(load_clip("walk"))
    track = track_of(clip, HUMAN)
    # a plain list by hand, in the order of the humanoid's file
    for column, name in enumerate(("right_knee", "right_elbow", "left_knee", "left_elbow")):
        assert track.angles[:, column].tolist() == clip.angles[name].tolist()


@given(st.integers(0, 2**32 - 1))
def test_reach_is_the_furthest_of_many_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    d = rng.normal(size=3)
    d /= np.linalg.norm(d)
    turn, place = rotation.normalised(rng.normal(size=4)), rng.normal(size=3)
    ball = rng.normal(size=(4000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    hull = ellipsoid_hull((0.3, 0.2, 0.1))
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    ends = np.array([0.0, 0.0, 0.35]) * np.sign(ball[:, 2:])
    for shape, points in (
        (Sphere(0.3), 0.3 * ball), (Ellipsoid((0.3, 0.2, 0.1)), ball * (0.3, 0.2, 0.1)),
        (Box((0.6, 0.4, 0.2)), corners * (0.3, 0.2, 0.1)), (Capsule(0.2, 0.7), 0.2 * ball + ends), (hull, hull.vertices),
    ):
        pieces = (Piece(shape, (0.1, 0.2, 0.3)),)
        avatar = rigid_avatar("probe", pieces, solid(pieces, 1.0))
        sample = TrackerSample(0.0, place.reshape(1, 3), turn.reshape(1, 4), np.zeros(0))
        there = place + rotation.rotate(turn, points + np.array([0.1, 0.2, 0.3]))
        found = reach((avatar,), (sample,), d)[0]
        assert -1e-12 <= found - (there @ d).max() < 2e-3
