"""Edited clips, and motions drawn by seed: smooth enough for a human, free at the start, and in contact with the room."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.assets.motions.deepmimic import Clip
from avatarsim.model.world import build
from avatarsim.pose_queries import require_free
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked, link_poses_each, poses_of_links
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from scenarios import unseen
from scenarios.building.avatars.humanoid import humanoid
from scenarios.motion.mocap import load_clip, retimed
from scenarios.motion.track import track_of
from scenarios.scenario import RENDERED
from scenarios.unseen.clips import FASTEST, SLOWEST, cut, faded, heading, mirrored, warped
from scenarios.unseen.drawn_motion import FASTEST as FASTEST_LINK
from scenarios.unseen.drawn_motion import LED_IN

HUMAN = humanoid()
NAMES = [link.name for link in HUMAN.links]
WALK, SPIN, KICK = (retimed(load_clip(name)) for name in ("walk", "spin", "kick"))


def poses(clip: Clip) -> tuple[np.ndarray, np.ndarray]:
    track = track_of(clip, HUMAN)
    return poses_of_links((HUMAN,), track.positions, track.rotations, track.angles)


@pytest.mark.parametrize("clip", [WALK, KICK], ids=lambda clip: clip.name)
def test_a_mirrored_posture_is_the_posture_in_the_mirror(clip: Clip) -> None:
    """By forward kinematics, each link has the mirrored pose of the one on the other side."""
    sides = {"left": "right", "right": "left"}
    swapped = [NAMES.index("_".join(sides.get(part, part) for part in name.split("_"))) for name in NAMES]
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
    """The root's height of the clip equals its time, so the result shows the warp."""
    clip = cut(SPIN, 0, 150)
    root = clip.root_positions.copy()
    root[:, 2] = clip.times
    told = warped(Clip("clock", False, clip.times, root, clip.rotations, clip.angles), np.random.default_rng(seed))
    rate = np.diff(told.root_positions[:, 2]) / RENDERED
    assert (rate >= SLOWEST - 1e-9).all() and (rate <= FASTEST + 1e-9).all()
    assert told.root_positions[0, 2] == 0.0 and clip.times[-1] - told.root_positions[-1, 2] < FASTEST * RENDERED
    # smooth: a rate changes by a small share from frame to frame
    assert np.abs(np.diff(np.log(rate))).max() < 0.06


@pytest.mark.parametrize("turn", [-1.5, 0.0, 0.7])
def test_a_fade_is_continuous_and_ends_in_the_other_clip(turn: float) -> None:
    joined = faded(WALK, cut(KICK, 10, 80), 30, turn)
    assert len(joined.times) == len(WALK.times) + 80 - 30
    np.testing.assert_array_equal(joined.root_positions[:46], WALK.root_positions[:46])
    # no step of the root is longer than the longest of both clips plus the motion of the fade itself
    step = np.linalg.norm(np.diff(joined.root_positions, axis=0), axis=1)
    longest = max(np.linalg.norm(np.diff(c.root_positions, axis=0), axis=1).max() for c in (WALK, KICK))
    assert step.max() < longest + 0.02
    wanted = heading(KICK, 40) - heading(KICK, 10) + heading(WALK, 46) + turn
    assert np.cos(heading(joined, 46 + 30) - wanted) == pytest.approx(1.0, abs=1e-12)
    for link in ("left_hip", "chest"):
        np.testing.assert_array_equal(joined.rotations[link][76:], KICK.rotations[link][40:90])


ROOMS = sorted(unseen.scenarios())
SEEDS = (1, 2, 123_456_789)


def samples(name: str, seed: int) -> tuple[Scene, list[TrackerSample]]:
    scenario = unseen.get(name)
    scene = scenario.build()
    motion = scenario.motion(scene, seed)
    return scene, [scene.first_sample, *(checked(motion(k), scene.avatars) for k in range(scenario.frames))]


def bits(found: list[TrackerSample]) -> bytes:
    return b"".join(array.tobytes() for sample in found for array in (sample.positions, sample.rotations, sample.angles))


def test_a_seed_is_one_motion_and_another_seed_or_room_another() -> None:
    first = bits(samples("unseen_floor", 5)[1])
    assert bits(samples("unseen_floor", 5)[1]) == first
    others = [bits(samples(name, seed)[1]) for name, seed in (("unseen_floor", 6), ("unseen_wall", 5), ("unseen_corridor", 5))]
    assert len({first, *others}) == 4


@pytest.mark.parametrize("name", ROOMS)
def test_motions_are_plausible_start_free_and_run_into_something(name: str) -> None:
    overlapping, ways = 0, []
    for seed in SEEDS:
        scene, found = samples(name, seed)
        require_free(build(scene))
        frame = unseen.get(name).dt
        assert len(found) == unseen.get(name).frames + 1 == round(10.0 / frame) + 1
        positions, orientations = link_poses_each(scene.avatars, found)
        speed = np.linalg.norm(np.diff(positions, axis=0), axis=-1) / frame
        assert np.isfinite(positions).all() and speed.max() <= 1.02 * FASTEST_LINK
        # the first frames go from standing to the motion, from rest and without a jump; an arc is longer than its chord
        assert speed[:20].max() <= 2.0 * LED_IN and speed[0].max() < 0.3
        ways.append(np.ptp(positions[:, 0, :2], axis=0).max())
        bodies = len(scene.bodies)
        state = np.tile([body.position for body in scene.bodies], (len(found), 1, 1))
        turn = np.tile([body.orientation for body in scene.bodies], (len(found), 1, 1))
        depths = Judge(scene).link_depths(np.concatenate([state, positions], axis=1)[::10],
                                          np.concatenate([turn, orientations], axis=1)[::10])
        assert positions.shape[1] + bodies == len(scene.names) and depths[0] == 0.0
        overlapping += int((depths > 1e-3).sum())
    assert overlapping > 10 and max(ways) > 0.8
