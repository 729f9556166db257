"""Poses of links for coordinates, and coordinates for goals of links."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from avatarsim.assets.models.coordinates import coordinates_of
from avatarsim.assets.models.load import load_avatar, load_room
from avatarsim.assets.models.model import Model
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.joint import Coupling
from tests.assets.motions.robots import held, robot
from tests.cleaning.rated import coordinates, home, mixed, two_arms, two_arms_text


@pytest.fixture(scope="module")
def arms(tmp_path_factory: pytest.TempPathFactory) -> Model:
    """Return the robot of two arms."""
    return two_arms(tmp_path_factory.mktemp("arms"))


def test_poses_are_those_of_mujoco(arms: Model) -> None:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(two_arms_text())
    data, rng = mujoco.MjData(model), np.random.default_rng(1)
    for _ in range(5):
        data.qpos[:] = rng.uniform(-1.5, 0.2, 8)
        mujoco.mj_kinematics(model, data)
        for name, (place, turn) in arms.pose(data.qpos.copy()).items():
            assert place == pytest.approx(data.body(name).xpos, abs=1e-12)
            assert abs(turn @ data.body(name).xquat) == pytest.approx(1.0, abs=1e-12)


@settings(max_examples=40)
@example(152)
@example(523)
@given(st.integers(0, 10**6))
def test_reachable_places_are_reached_within_limits(arms: Model, seed: int) -> None:
    """In the examples an arm is nearly stretched."""
    rng = np.random.default_rng(seed)
    there = rng.uniform([-1.2, -1.5, -2.0, -1.5] * 2, [1.2, 1.5, -0.4, 1.5] * 2)
    goals = {name: arms.pose(there)[name][0] for name in ("left palm", "right palm")}
    found = arms.reach(goals)
    assert (found >= [-1.5, -2.5, -2.4, -2.0] * 2).all() and (found <= [1.5, 2.5, 0.2, 2.0] * 2).all()
    for name, goal in goals.items():
        assert arms.pose(found)[name][0] == pytest.approx(goal, abs=1e-6)


def test_a_place_out_of_reach_is_pointed_at(arms: Model) -> None:
    found = arms.reach({"left palm": (0.0, 0.6, -3.0)})
    shoulder, palm = (arms.pose(found)[name][0] for name in ("left upper", "left palm"))
    away, along = np.array([0.0, 0.6, -3.0]) - shoulder, palm - shoulder
    assert np.linalg.norm(along) == pytest.approx(0.65, abs=1e-3)
    assert along @ away == pytest.approx(np.linalg.norm(along) * np.linalg.norm(away), rel=1e-4)


def test_a_free_root_stays_and_a_ball_keeps_its_limits() -> None:
    model, start = mixed(), home(mixed())
    goal = model.pose(start)["c"][0] + [0.4, 0.1, -0.5]
    found = model.reach({"c": goal}, start=start)
    assert np.array_equal(found[:7], start[:7])
    before, after = (np.linalg.norm(model.pose(q)["c"][0] - goal) for q in (start, found))
    assert after < 0.5 * before
    assert np.linalg.norm(found[coordinates(model).width - 7 : coordinates(model).width - 3]) == pytest.approx(1.0)


def test_what_is_no_goal_is_refused(arms: Model, tmp_path: Path) -> None:
    assert np.array_equal(arms.reach({}), np.zeros(8))
    assert (arms.reach({}, start=np.full(8, 3.0)) <= [1.5, 2.5, 0.2, 2.0] * 2).all()
    with pytest.raises(UnknownName):
        arms.reach({"hand": (0.0, 0.0, 0.0)})
    for goal in ((0.0, 0.0), (0.0, 0.0, float("nan")), "there", (0.0, 0.0, 1e12)):
        with pytest.raises(InvalidInput):
            arms.reach({"left palm": goal})
    for q in (np.zeros(7), np.full(8, np.nan)):
        with pytest.raises(InvalidInput):
            arms.pose(q)
        with pytest.raises(InvalidInput):
            arms.reach({"left palm": (0.0, 0.0, 0.0)}, start=q)
    with pytest.raises(InvalidInput):
        load_room("floor").pose(np.zeros(8))
    (tmp_path / "a.xml").write_text(two_arms_text())
    assert load_avatar(tmp_path / "a.xml").reach({"left palm": (0.2, 0.3, 0.4)}).shape == (8,)


def test_coordinates_by_the_names_of_joints() -> None:
    model = robot()
    q = model.at({"left_elbow": 0.7, "floating_base": (1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 2.0)})
    # the file's own order, and its own reference: the elbow's zero is at 0.25
    assert q.tolist() == [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.7]
    further = model.at({"waist": 0.2}, start=q)
    assert further.tolist() == [*q[:7], 0.2, *q[8:]]
    assert model.pose(further)["pelvis"][0].tolist() == [1.0, 2.0, 3.0]


def test_a_joint_that_follows_another_goes_along() -> None:
    avatar = robot(free=False).avatar
    assert avatar is not None
    avatar = replace(avatar, couplings=(Coupling(2, 1, 0.5),))
    model = Model(avatar, coordinates_of(avatar), (), ())
    assert model.at({"left_arm": 0.4}).tolist() == [0.0, 0.4, 0.2, 0.0]
    with pytest.raises(UnknownName):
        model.at({"left_forearm": 0.2})


def test_values_that_fit_no_joint_are_refused() -> None:
    with pytest.raises(UnknownName, match="left_elbow"):
        robot().at({"left_elbo": 0.7})
    with pytest.raises(UnknownName):
        held().at({"left_shoulder": 0.7})
    for name, value in (("waist", (0.1, 0.2)), ("waist", float("nan")), ("floating_base", (0.0, 0.0, 1.0)), ("waist", "left")):
        with pytest.raises(InvalidInput, match=name):
            robot().at({name: value})
    with pytest.raises(InvalidInput):
        robot().at({}, start=np.zeros(3))
