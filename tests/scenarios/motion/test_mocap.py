"""Recorded clips of pybullet_data: each of them holds postures, and they are retimed, repeated and placed."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from avatarsim.assets.motions.deepmimic import COLUMNS, read_clip
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.spatial import rotation
from scenarios.motion.mocap import UPPER, clip_names, load_clip, placed, repeated, retimed, upper_body_of
from tests.assets.motions.clips import upright, written

Array = NDArray[np.float64]


def angle_between(a: Array, b: Array) -> Array:
    return np.asarray(np.linalg.norm(rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(a), b)), axis=-1))


def test_the_fifteen_human_clips_are_there() -> None:
    assert len(clip_names()) == 15 and {"walk", "punch", "getup_facedown"} <= set(clip_names()) and COLUMNS == 44


@pytest.mark.parametrize("name", ["backflip", "crawl", "kick", "punch", "walk", "getup_facedown", "spin"])
def test_a_clip_holds_sound_postures(name: str) -> None:
    clip = load_clip(name)
    frames = len(clip.times)
    assert (np.diff(clip.times) > 0.0).all()
    assert clip.root_positions.shape == (frames, 3)
    assert len(clip.rotations) == 9 and len(clip.angles) == 4
    for values in clip.rotations.values():
        assert values.shape == (frames, 4)
        assert np.abs(np.linalg.norm(values, axis=1) - 1.0).max() < 1e-12
    # a human's root is above the floor, and below two metres: the third axis is up
    assert clip.root_positions[:, 2].min() > 0.0 and clip.root_positions[:, 2].max() < 2.0


def test_retiming_turns_at_a_constant_rate(tmp_path: Path) -> None:
    first, last = upright(1.0), upright(1.0)
    last[4:8] = [float(np.sqrt(0.5)), 0.0, float(np.sqrt(0.5)), 0.0]
    last[1] = 6.0
    clip = retimed(read_clip(written(tmp_path / "turn.txt", [first, last])))
    assert np.allclose(clip.times, np.arange(61) / 60.0)
    turned = angle_between(clip.rotations["root"][:1], clip.rotations["root"])
    assert np.allclose(turned, 0.5 * np.pi * clip.times, atol=1e-12)
    assert np.allclose(clip.root_positions[:, 0], 6.0 * clip.times)
    # half-way: an eighth of a turn about up, by hand
    assert np.allclose(clip.rotations["root"][30], [np.cos(np.pi / 8), 0.0, 0.0, np.sin(np.pi / 8)], atol=1e-12)


def test_retiming_passes_through_what_was_recorded() -> None:
    clip = load_clip("getup_facedown")
    step = clip.times[1] / 4.0
    fine = retimed(clip, float(step))
    assert angle_between(fine.rotations["neck"][4], clip.rotations["neck"][1]) < 1e-12
    assert fine.angles["left_knee"][4] == pytest.approx(clip.angles["left_knee"][1], abs=1e-12)


def test_retiming_goes_the_short_way_round(tmp_path: Path) -> None:
    first, last = upright(1.0), upright(1.0)
    last[4:8] = [-1.0, 0.0, 0.0, 0.0]
    clip = retimed(read_clip(written(tmp_path / "same.txt", [first, last])))
    assert angle_between(clip.rotations["root"][:1], clip.rotations["root"]).max() < 1e-12


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


def test_a_placed_clip_begins_where_it_is_put_and_is_otherwise_the_same() -> None:
    clip = load_clip("walk")
    there = placed(clip, 2.0, -1.0, np.pi / 2)
    assert np.allclose(there.root_positions[0], [2.0, -1.0, clip.root_positions[0, 2]])
    way, before = there.root_positions[-1] - there.root_positions[0], clip.root_positions[-1] - clip.root_positions[0]
    assert np.allclose(way, [-before[1], before[0], before[2]])
    forward, was = (rotation.rotate(played.rotations["root"][0], [1.0, 0.0, 0.0]) for played in (there, clip))
    assert np.allclose(forward, [-was[1], was[0], was[2]])
    assert there.rotations["chest"] is clip.rotations["chest"]
