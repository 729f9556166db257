"""Stalled avatars and traps: which are led along which path, statuses and costs of frames, and nothing overlaps meanwhile."""

import numpy as np
import pytest

from avatarsim.planner.supervisor import LEAST_SLICE
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.settings import PostureSettings
from reference.judging.judge import Judge
from tests.planner.scenes import DT, Run, behind_the_wall, held_arm, moved, palm, walker
from tests.worlds.little_worlds import at, block, hand
from tests.worlds.traps import BEHIND, POST, boomed, closed_pocket, limbed, pocket, tube

SETTINGS = PostureSettings()
SECONDS = 60


def test_a_door_is_passed_within_the_motion_budget() -> None:
    scene, target = behind_the_wall(walker())
    run, judge = Run(scene), Judge(scene)
    before, first = run.record.shown.positions[3], True
    for record in (one for _ in range(3 * SECONDS) for one in run.go(target, 1)):
        shown = record.shown
        assert judge.overlaps(shown.positions, shown.orientations).deepest == 0.0
        moved_by = float(np.linalg.norm(shown.positions[3] - before))
        # the first frame has the jump of the target in its budget
        assert first or moved_by <= SETTINGS.catch_up_move * DT * 1.2
        before, first = shown.positions[3], False
    assert run.far(target) < 1e-3 and run.said["planning"] > 0 and run.said["following"] > 0
    assert run.record.statuses == {}


@pytest.mark.parametrize(("around", "is_led"), [(0, False), (1, False), (2, True)])
def test_a_hand_without_joints_is_led_only_if_asked_for(around: int, is_led: bool) -> None:
    scene, target = behind_the_wall(palm())
    run = Run(scene, around=around)
    run.go(target, 5 * SECONDS)
    assert (run.far(target) < 1e-3) == is_led and ("following" in run.said) == is_led
    assert is_led or run.said["waiting"] > SECONDS


def test_an_arm_that_a_post_holds_folds_to_get_past_it() -> None:
    scene, target = held_arm()
    stuck, run = Run(scene, around=0), Run(scene)
    stuck.go(target, 3 * SECONDS)
    run.go(target, 3 * SECONDS)
    assert stuck.far(target) > 0.05 and run.far(target) < 1e-3 and run.said["following"] > 0


def test_what_presses_on_a_table_is_led_nowhere() -> None:
    avatar = walker()
    table = block("table", (0.0, 0.0, -0.55), (3.0, 3.0, 0.1))
    scene = Scene("table", (table,), (avatar,), start=rest((avatar,)))
    target = moved(scene, (0.0, 0.0, -0.4))
    run = Run(scene)
    run.go(target, 2 * SECONDS)
    assert run.far(target) > SETTINGS.near and run.said["waiting"] > SECONDS and "following" not in run.said


def test_same_seed_same_bits_and_another_seed_another_path() -> None:
    scene, target = behind_the_wall(walker())
    runs = [[record.state_hash() for record in Run(scene, seed).go(target, SECONDS)] for seed in (1, 1, 2)]
    assert runs[0] == runs[1] and runs[0] != runs[2]


@pytest.mark.parametrize("seed", range(3))
def test_snapshots_are_sound_in_every_frame_of_a_search(seed: int) -> None:
    scene, target = behind_the_wall(walker())
    run, other = Run(scene, seed), Run(scene)
    while run.far(target) > 1e-3:
        run.go(target, 1)
        other.engine.restore(run.engine.snapshot())
    assert run.said["planning"] > 0 and run.said["following"] > 0


def test_an_avatar_waits_while_its_path_is_blocked() -> None:
    one = walker()
    plug = hand((Piece(Box((0.2, 1.4, 2.6))),), "plug")
    alone, _ = behind_the_wall(one)
    start = rest((one, plug))
    start.positions[3] = (2.6, 1.5, 0.9)
    # with friction on the wall it pushes the plug aside while it plans
    scene = Scene("blocked", alone.bodies, (one, plug), start=start, narrow=("friction",))
    judge = Judge(scene)

    def goal(is_shut: bool) -> TrackerSample:
        positions = start.positions.copy()
        positions[:3, 0] += 1.4
        if is_shut:
            positions[3, 0] = 0.86
        return TrackerSample(0.0, positions, start.rotations, start.angles)

    run, shut = Run(scene), goal(True)
    while not run.record.statuses.get("following"):
        run.go(goal(False), 1)
    for _ in range(SECONDS):
        run.go(shut, 1)
        shown = run.record.shown
        assert judge.overlaps(shown.positions, shown.orientations).deepest == 0.0
    assert shown.positions[len(alone.bodies), 0] < 0.9 and run.record.statuses == {"planning": 1, "waiting": 1}
    run.go(goal(False), 5 * SECONDS)
    assert run.far(goal(False)) < 1e-3


@pytest.mark.parametrize("work", [300, 1200])
def test_searches_keep_to_two_thirds_of_the_work(work: int) -> None:
    scene, target = behind_the_wall(walker())
    spent = [record.counts["plan_work"] for record in Run(scene, work=work).go(target, SECONDS)]
    assert 0 < max(spent) <= 2 * work // 3 + LEAST_SLICE


def test_a_path_whose_end_is_no_nearer_is_dropped() -> None:
    scene, target = behind_the_wall(walker())
    run, home = Run(scene), scene.first_sample
    while not run.record.statuses.get("following"):
        run.go(target, 1)
    run.go(home, 1)
    assert not run.record.statuses.get("following")
    run.go(home, SECONDS)
    assert run.far(home) < 1e-3


def test_two_avatars_are_led_at_once() -> None:
    one, other = walker(), palm()
    alone, _ = behind_the_wall(one)
    start = rest((one, other))
    start.positions[3] = (0.0, -1.5, 0.3)
    scene = Scene("both", alone.bodies, (one, other), start=start)
    positions = start.positions.copy()
    positions[[0, 3], 0] += 1.4
    goal = TrackerSample(0.0, positions, start.rotations, start.angles)
    run = Run(scene, around=2)
    run.go(goal, 6 * SECONDS)
    assert run.far(goal) < 1e-3 and run.said["following"] > SECONDS


def scene_of(bodies: tuple[Body, ...], avatar: Avatar, start: Vector) -> Scene:
    """Return an avatar that begins at `start` among bodies."""
    return Scene("s", bodies, (avatar,), start=at(rest((avatar,)), start))


def watched(run: Run, target: TrackerSample, frames: int) -> np.ndarray:
    """Return places (frames + 1, 3) of the first root; nothing overlaps in any frame."""
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


def test_without_a_way_out_the_avatar_waits_and_says_so() -> None:
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
    assert before and not follows and run.far(target) < 1e-2
    for _ in range(8):
        far = run.far(target)
        run.go(target, 1)
        assert run.far(target) <= max(far, 1e-9), "it comes to rest there and does not go beyond"
    assert run.far(target) < 1e-3
