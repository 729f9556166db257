"""Traps: left along a path that is followed to its end, waited in where there is no way out, and nothing overlaps meanwhile."""

import numpy as np
import pytest

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.settings import PostureSettings
from reference.judging.judge import Judge
from tests.planner.scenes import DT, Run, held_arm, moved
from tests.worlds.little_worlds import at, hand
from tests.worlds.traps import BEHIND, POST, boomed, closed_pocket, limbed, pocket, tube

SETTINGS = PostureSettings()


def scene_of(bodies: tuple[Body, ...], avatar: Avatar, start: Vector) -> Scene:
    """An avatar that begins at `start` among bodies."""
    return Scene("s", bodies, (avatar,), start=at(rest((avatar,)), start))


def watched(run: Run, target: TrackerSample, frames: int) -> np.ndarray:
    """Places (frames + 1, 3) of the first root; nothing overlaps in any frame."""
    judge, root = Judge(run.scene), len(run.scene.bodies)
    places = [run.record.shown.positions[root]]
    for _ in range(frames):
        run.go(target, 1)
        shown = run.record.shown
        assert judge.overlaps(shown.positions, shown.orientations).deepest == 0.0
        places.append(shown.positions[root])
    return np.array(places)


@pytest.mark.parametrize("seed", range(3))
def test_a_dead_end_is_left_within_the_motion_budget(seed: int) -> None:
    run = Run(scene_of(pocket(), limbed(), (-0.1, 0.0, 0.0)), seed)
    target = moved(run.scene, BEHIND)
    places = watched(run, target, 300)
    assert run.said["following"] > 0 and run.far(target) < 1e-6
    # the first frame holds the way of the target itself
    assert np.linalg.norm(np.diff(places[1:], axis=0), axis=1).max() <= SETTINGS.catch_up_move * DT * (1.0 + 1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_a_dead_end_is_left_along_one_path_without_delay(seed: int) -> None:
    """Within the 114 frames that it took at most before paths had a price."""
    run = Run(scene_of(pocket(), limbed(), (-0.1, 0.0, 0.0)), seed)
    target, follows, paths = moved(run.scene, BEHIND), False, 0
    for _ in range(114):
        run.go(target, 1)
        before, follows = follows, bool(run.record.statuses.get("following"))
        paths += follows and not before
    assert run.far(target) < 1e-6 and paths == 1


def test_where_there_is_no_way_out_the_avatar_waits_or_seeks_and_says_so() -> None:
    run = Run(scene_of(closed_pocket(), limbed(), (-0.12, 0.0, 0.0)))
    places = watched(run, moved(run.scene, BEHIND), 180)
    assert (places[:, 0] < 0.0).all() and "following" not in run.said
    assert run.said["waiting"] + run.said["planning"] > 180 - 2 * SETTINGS.stall_time / DT - 2


def test_a_boom_behind_a_post_is_led_round_it() -> None:
    run = Run(scene_of(POST, boomed(), (0.0, 0.0, 0.0)))
    target = moved(run.scene, (0.0, 0.3, 0.0))
    watched(run, target, 240)
    assert run.said["following"] > 0 and run.far(target) < 1e-6


def test_two_hands_that_cannot_pass_each_other_wait_and_say_so() -> None:
    pair = (hand(name="one"), hand(name="other"))
    home = rest(pair)

    def places(one: float) -> TrackerSample:
        positions = home.positions.copy()
        positions[:, 0] = (one, -one)
        return TrackerSample(0.0, positions, home.rotations, home.angles)

    run = Run(Scene("tube", tube(), pair, start=places(-0.3)))
    watched(run, places(0.3), 90)
    one, other = run.record.shown.positions[4:, 0]
    assert one < other and run.record.statuses == {"waiting": 2}


@pytest.mark.parametrize("seed", range(8))
def test_a_path_is_followed_to_its_end(seed: int) -> None:
    """The path of this arm ends at its target, and is left there, not where its end first comes within reach of a few frames."""
    scene, target = held_arm()
    run, follows = Run(scene, seed), False
    for _ in range(180):
        run.go(target, 1)
        before, follows = follows, bool(run.record.statuses.get("following"))
        if before and not follows:
            break
    assert before and not follows and run.far(target) < 1e-3
