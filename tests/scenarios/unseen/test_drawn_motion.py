"""Drawn motions: a seed gives the same bits, they start free, are smooth enough for a human, and meet what is in the room."""

import numpy as np
import pytest

from avatarsim.model.world import build
from avatarsim.pose_queries import require_free
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked, link_poses_each
from reference.judging.judge import Judge
from scenarios import unseen
from scenarios.unseen.drawn_motion import FASTEST, LED_IN

ROOMS = sorted(unseen.scenarios())
SEEDS = (1, 2, 123_456_789)


def samples(name: str, seed: int) -> tuple[Scene, list[TrackerSample]]:
    scenario = unseen.get(name)
    scene = scenario.build()
    motion = scenario.motion(scene, seed)
    return scene, [scene.first_sample, *(checked(motion(k), scene.avatars) for k in range(scenario.frames))]


def bits(found: list[TrackerSample]) -> bytes:
    return b"".join(array.tobytes() for sample in found for array in (sample.positions, sample.rotations, sample.angles))


def test_there_is_a_scene_for_each_of_the_five_rooms_and_one_at_90_hz() -> None:
    assert ROOMS == ["unseen_corridor", "unseen_door", "unseen_door_90hz", "unseen_floor", "unseen_gallery", "unseen_wall"]


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
        assert np.isfinite(positions).all() and speed.max() <= 1.02 * FASTEST
        # the first frames lead from standing into the motion, from rest and without a jump; an arc is longer than its chord
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
