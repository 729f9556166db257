"""Edited clips: the mirror is a mirror, a warp keeps order and rate, a fade keeps the root where it is."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.assets.motions.deepmimic import Clip
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.motion.mocap import UPPER, load_clip, retimed
from scenarios.motion.track import track_of
from scenarios.scenario import RENDERED
from scenarios.unseen.clips import FASTEST, SLOWEST, cut, faded, heading, layered, mirrored, warped

HUMAN = humanoid()
NAMES = [link.name for link in HUMAN.links]
WALK, SPIN, KICK = (retimed(load_clip(name)) for name in ("walk", "spin", "kick"))


def poses(clip: Clip) -> tuple[np.ndarray, np.ndarray]:
    track = track_of(clip, HUMAN)
    return poses_of_links((HUMAN,), track.positions, track.rotations, track.angles)


@pytest.mark.parametrize("clip", [WALK, KICK], ids=lambda clip: clip.name)
def test_a_mirrored_posture_is_the_posture_in_the_mirror(clip: Clip) -> None:
    """By forward kinematics: each link origin lies where the mirror has that of the other side, each link is turned likewise."""
    swapped = [NAMES.index({"left": "right", "right": "left"}.get(n.partition("_")[0], n.partition("_")[0]) + n.partition("_")[1]
                           + n.partition("_")[2]) for n in NAMES]
    (p, q), (mirror_p, mirror_q) = poses(clip), poses(mirrored(clip))
    flip = np.diag([1.0, -1.0, 1.0])
    np.testing.assert_allclose(mirror_p, (p @ flip)[:, swapped], atol=1e-12)
    np.testing.assert_allclose(rotation.to_matrix(mirror_q), (flip @ rotation.to_matrix(q) @ flip)[:, swapped], atol=1e-12)
    twice = mirrored(mirrored(clip))
    assert all((twice.rotations[link] == clip.rotations[link]).all() for link in clip.rotations)
    assert all((twice.angles[link] == clip.angles[link]).all() for link in clip.angles)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_warp_stays_between_its_rates_and_keeps_both_ends(seed: int) -> None:
    """Of a clip whose root's height is its own time, which the warp so writes down."""
    clip = cut(SPIN, 0, 150)
    root = clip.root_positions.copy()
    root[:, 2] = clip.times
    told = warped(Clip("clock", False, clip.times, root, clip.rotations, clip.angles), np.random.default_rng(seed))
    rate = np.diff(told.root_positions[:, 2]) / RENDERED
    assert (rate >= SLOWEST - 1e-9).all() and (rate <= FASTEST + 1e-9).all()
    assert told.root_positions[0, 2] == 0.0 and clip.times[-1] - told.root_positions[-1, 2] < FASTEST * RENDERED
    # smooth: a rate changes by a small share from frame to frame
    assert np.abs(np.diff(np.log(rate))).max() < 0.06


def test_layers_take_legs_of_one_and_arms_of_the_other() -> None:
    both = layered(SPIN, WALK)
    count = len(WALK.times)
    for link, values in {**both.rotations, **both.angles}.items():
        source = SPIN if link in UPPER else WALK
        np.testing.assert_array_equal(values, {**source.rotations, **source.angles}[link][:count])


@pytest.mark.parametrize("turn", [-1.5, 0.0, 0.7])
def test_a_fade_is_continuous_and_ends_in_the_other_clip(turn: float) -> None:
    joined = faded(WALK, cut(KICK, 10, 80), 30, turn)
    assert len(joined.times) == len(WALK.times) + 80 - 30
    np.testing.assert_array_equal(joined.root_positions[:46], WALK.root_positions[:46])
    # no step of the root is longer than the longest of both, and what the fade itself brings them together by
    step = np.linalg.norm(np.diff(joined.root_positions, axis=0), axis=1)
    longest = max(np.linalg.norm(np.diff(c.root_positions, axis=0), axis=1).max() for c in (WALK, KICK))
    assert step.max() < longest + 0.02
    wanted = heading(KICK, 40) - heading(KICK, 10) + heading(WALK, 46) + turn
    assert np.cos(heading(joined, 46 + 30) - wanted) == pytest.approx(1.0, abs=1e-12)
    for link in ("left_hip", "chest"):
        np.testing.assert_array_equal(joined.rotations[link][76:], KICK.rotations[link][40:90])


def test_short_clips_fade_over_half_of_the_shorter() -> None:
    joined = faded(cut(WALK, 0, 10), cut(SPIN, 0, 6), 30)
    assert len(joined.times) == 10 + 6 - 3
