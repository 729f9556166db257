"""Inverse kinematics of goals within and out of reach."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.live.drive.driver import FASTEST, FASTEST_TURN
from avatarsim.live.drive.pull import Goal, Pull, exterior_angle
from avatarsim.live.drive.tree import Tree, posture_of
from avatarsim.live.stages import NAMES, stage
from avatarsim.scene.tracker import rest
from avatarsim.spatial.rotation import difference
from tests.live.drive.stages_driven import driver, excess, fastest, random_sample, ticks
from tests.worlds.little_worlds import sliding_avatar

HANDLES = [(name, handle) for name in NAMES for handle in stage(name).handles[1:]]


@settings(max_examples=20)
@given(st.sampled_from(HANDLES), st.integers(0, 10_000))
def test_goals_of_postures_are_reached_to_a_millimetre(where: tuple[str, str], seed: int) -> None:
    name, handle = where
    scene, one = stage(name).scene, driver(name)
    tree = Tree(scene.avatars)
    link = scene.names.index(handle) - len(scene.bodies)
    goal = tree.pose(posture_of(random_sample(scene, seed)), link)[0]
    one.drag(handle, goal)
    samples = [scene.first_sample, *ticks(one, 240)]
    assert np.linalg.norm(one.pose(handle)[0] - goal) < 1e-3
    assert max(excess(scene, sample) for sample in samples[::20]) < 1e-6
    root, turn = fastest(scene, samples)
    # the second factor allows for the projection into a limit
    assert root <= FASTEST * 1.001 and turn <= FASTEST_TURN * 1.05


def test_a_place_and_an_orientation_are_reached_nearly_always() -> None:
    scene, tree = stage("gallery").scene, Tree(stage("gallery").scene.avatars)
    link, missed = [node.name for node in tree.nodes].index("right_wrist"), set[int]()
    for seed in range(65, 85):
        one = driver("gallery")
        place, turned = tree.pose(posture_of(random_sample(scene, seed, 0.3)), link)
        one.drag("human/right_wrist", place, turned)
        for _ in range(6):
            ticks(one, 60)
            reached = one.pose("human/right_wrist")
            if np.linalg.norm(reached[0] - place) < 2e-3 and np.linalg.norm(difference(reached[1], turned)) < 0.02:
                break
        else:
            missed.add(seed)
    # where limits stop a chain, a local method may stay in a local minimum: here 16 mm away
    assert missed <= {79}


@pytest.mark.parametrize(("name", "handle", "goal"), [
    ("gallery", "human/right_hand", (-1.5, -1.0, 3.5)), ("gallery", "human/head", (-2.2, 0.0, 4.0)),
    ("gallery", "human/left_hand", (3.0, 1.0, 1.2)), ("hand", "hand/thumb3", (1.0, 1.0, 0.2)),
])
def test_a_goal_out_of_reach_ends_in_a_posture_that_stays(name: str, handle: str, goal: tuple[float, float, float]) -> None:
    one = driver(name)
    one.drag(handle, goal)
    before, after = ticks(one, 601)[-2:]
    assert np.abs(after.positions - before.positions).max() < 1e-4
    assert np.abs(after.rotations - before.rotations).max() < 1e-4
    assert np.abs(after.angles - before.angles).max(initial=0.0) < 1e-4


@pytest.mark.parametrize(("name", "handle", "way_there"), [
    ("gallery", "human/left_foot", (0.0, 0.0, 0.4)), ("gallery", "human/right_foot", (0.3, 0.0, 0.5)),
    ("gallery", "human/right_hand", (0.02, 0.02, 0.3)), ("hand", "hand/middle3", (-0.015, 0.0, -0.02)),
])
def test_a_straight_limb_bends_and_the_root_stays(name: str, handle: str, way_there: tuple[float, float, float]) -> None:
    one, scene = driver(name), stage(name).scene
    goal = one.pose(handle)[0] + way_there
    one.drag(handle, goal)
    sample = ticks(one, 120)[-1]
    assert np.linalg.norm(one.pose(handle)[0] - goal) < 1e-3
    assert sample.positions[0] == pytest.approx(scene.first_sample.positions[0], abs=1e-3)


@pytest.mark.parametrize("x", [-0.2, 0.0, 0.2])
def test_a_knee_bends_forward_whichever_way_the_foot_goes_up(x: float) -> None:
    one = driver("gallery")
    one.drag("human/left_foot", one.pose("human/left_foot")[0] + (x, 0.0, 0.45))
    ticks(one, 120)
    hip, knee, ankle = (one.pose(f"human/left_{joint}")[0] for joint in ("hip", "knee", "ankle"))
    assert (knee - hip)[0] * (ankle - hip)[2] - (knee - hip)[2] * (ankle - hip)[0] < -0.01


def test_the_angle_of_a_triangle_is_that_of_its_sides() -> None:
    assert exterior_angle(1.0, 1.0, 2.0) == 0.0
    assert exterior_angle(1.0, 1.0, np.sqrt(2.0)) == pytest.approx(np.pi / 2.0)
    assert exterior_angle(3.0, 4.0, 0.5) == pytest.approx(np.pi)
    assert exterior_angle(0.0, 1.0, 1.0) == 0.0


def test_two_links_are_pulled_at_once() -> None:
    one = driver("gallery")
    goals = {"human/left_hand": (-1.9, 0.4, 1.3), "human/right_hand": (-1.8, -0.3, 1.5)}
    for handle, goal in goals.items():
        one.drag(handle, goal)
    ticks(one, 120)
    for handle, goal in goals.items():
        assert np.linalg.norm(one.pose(handle)[0] - goal) < 1e-3


def test_links_that_are_held_do_not_turn() -> None:
    scene = stage("gallery").scene
    tree, posture = Tree(scene.avatars), posture_of(scene.first_sample)
    names = [node.name for node in tree.nodes]
    tip, spine = names.index("left_hand"), names.index("spine1")
    pull = Pull(tree, (tip,), 0.2, frozenset({spine}))
    before = posture.turns[spine].copy()
    pull.solve(posture, [Goal(tip, (-1.9, 0.4, 1.3))], 1.0)
    assert np.array_equal(posture.turns[spine], before)
    assert Pull(tree, (0,), 0.2).solve(posture, [Goal(0, (0.0, 0.0, 0.0))], 1.0)


def test_a_goal_along_a_slide_is_reached_within_its_limits() -> None:
    avatar = sliding_avatar()
    tree, posture = Tree((avatar,)), posture_of(rest((avatar,)))
    slide = [node.name for node in tree.nodes].index("e")
    wanted = posture.copy()
    wanted.angles[3] = 0.7
    goal, pull = tree.pose(wanted, slide)[0], Pull(tree, (slide,), 0.2)
    for _ in range(100):
        pull.solve(posture, [Goal(slide, goal)], 0.5)
    assert posture.angles[3] == pytest.approx(0.7, abs=1e-4)
    pull.solve(posture, [Goal(slide, goal + (-5.0, 2.5, 1.0))], 0.5)
    assert posture.angles[3] <= 0.9
