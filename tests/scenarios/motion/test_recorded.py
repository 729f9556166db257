"""Recorded clips are retimed, repeated, placed and layered; tracks are cut, mirrored and started without a jump."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from avatarsim.assets.motions.deepmimic import read_clip
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.cases import driven
from scenarios.building.reach import reach
from scenarios.motion.mocap import UPPER, load_clip, placed, repeated, retimed, upper_body_of
from scenarios.motion.track import LEAD_IN, Track, track_of
from tests.assets.motions.clips import upright, written

Array = NDArray[np.float64]


def angle_between(a: Array, b: Array) -> Array:
    return np.asarray(np.linalg.norm(rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(a), b)), axis=-1))


def test_retiming_turns_at_a_constant_rate(tmp_path: Path) -> None:
    first, last = upright(1.0), upright(1.0)
    last[4:8] = [float(np.sqrt(0.5)), 0.0, float(np.sqrt(0.5)), 0.0]
    last[1] = 6.0
    clip = retimed(read_clip(written(tmp_path / "turn.txt", [first, last])))
    assert np.allclose(clip.times, np.arange(61) / 60.0)
    turned = angle_between(clip.rotations["root"][:1], clip.rotations["root"])
    assert np.allclose(turned, 0.5 * np.pi * clip.times, atol=1e-12)
    assert np.allclose(clip.root_positions[:, 0], 6.0 * clip.times)
    # half-way: an eighth of a turn about the vertical, by hand; and the short direction
    assert np.allclose(clip.rotations["root"][30], [np.cos(np.pi / 8), 0.0, 0.0, np.sin(np.pi / 8)], atol=1e-12)
    last[4:8] = [-1.0, 0.0, 0.0, 0.0]
    same = retimed(read_clip(written(tmp_path / "same.txt", [first, last])))
    assert angle_between(same.rotations["root"][:1], same.rotations["root"]).max() < 1e-12


def test_a_repeated_walk_goes_on_where_it_ended() -> None:
    once, thrice = load_clip("walk"), repeated(load_clip("walk"), 3)
    stride = once.root_positions[-1, 0] - once.root_positions[0, 0]
    assert thrice.times[-1] == pytest.approx(3.0 * once.times[-1])
    assert thrice.root_positions[-1, 0] == pytest.approx(3.0 * stride)
    largest = np.linalg.norm(np.diff(once.root_positions, axis=0), axis=1).max()
    assert np.linalg.norm(np.diff(thrice.root_positions, axis=0), axis=1).max() <= 1.5 * largest


def test_clips_that_do_not_exist_wrap_or_last_are_refused() -> None:
    with pytest.raises(InvalidInput, match="punch"):
        repeated(load_clip("punch"), 2)
    with pytest.raises(UnknownName, match="walk"):
        load_clip("swim")
    with pytest.raises(InvalidInput, match=r"spin.*3\.1"):
        upper_body_of(retimed(load_clip("spin")), 4.0, retimed(load_clip("walk")))


def test_each_link_of_two_layers_moves_as_in_its_own_clip() -> None:
    walk, spin = retimed(load_clip("walk")), retimed(load_clip("spin"))
    both = upper_body_of(spin, 10.0 / 60.0, walk)
    np.testing.assert_array_equal(both.times, walk.times)
    np.testing.assert_array_equal(both.root_positions, walk.root_positions)
    for link, values in {**both.rotations, **both.angles}.items():
        own, first = (spin, 10) if link in UPPER else (walk, 0)
        whole = {**own.rotations, **own.angles}[link]
        np.testing.assert_array_equal(values, whole[first : first + len(walk.times)])


def test_placed_clip_is_the_same_from_another_start() -> None:
    clip = load_clip("walk")
    there = placed(clip, 2.0, -1.0, np.pi / 2)
    assert np.allclose(there.root_positions[0], [2.0, -1.0, clip.root_positions[0, 2]])
    way, before = there.root_positions[-1] - there.root_positions[0], clip.root_positions[-1] - clip.root_positions[0]
    assert np.allclose(way, [-before[1], before[0], before[2]])
    forward, was = (rotation.rotate(played.rotations["root"][0], [1.0, 0.0, 0.0]) for played in (there, clip))
    assert np.allclose(forward, [-was[1], was[0], was[2]])
    assert there.rotations["chest"] is clip.rotations["chest"]


HUMAN = humanoid()


def numbered(frames: int) -> Track:
    """Return a track whose root is at x = frame."""
    positions = np.zeros((frames, 1, 3))
    positions[:, 0, 0] = np.arange(frames)
    return Track(positions, np.tile(rotation.IDENTITY, (frames, 1, 1)), np.zeros((frames, 0)))


def test_tracks_go_backwards_and_there_and_back_and_end_at_rest() -> None:
    """Times are those of the end of the frame, and the last posture stays."""
    assert numbered(4).there_and_back(9).positions[:, 0, 0].tolist() == [0, 1, 2, 3, 2, 1, 0, 1, 2]
    assert numbered(3).backwards().positions[:, 0, 0].tolist() == [2, 1, 0]
    motion = numbered(3).motion()
    assert motion(0).time == pytest.approx(1.0 / 60.0)
    assert motion(59).time == pytest.approx(1.0) and motion(59).positions[0, 0] == 2.0
    with pytest.raises(InvalidInput, match="frame"):
        motion(-1)


def test_lead_in_goes_to_the_first_posture_in_small_steps() -> None:
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
        avatar = driven("probe", Piece(shape, (0.1, 0.2, 0.3)), 1.0)
        sample = TrackerSample(0.0, place.reshape(1, 3), turn.reshape(1, 4), np.zeros(0))
        there = place + rotation.rotate(turn, points + np.array([0.1, 0.2, 0.3]))
        found = reach((avatar,), (sample,), d)[0]
        assert -1e-12 <= found - (there @ d).max() < 2e-3
