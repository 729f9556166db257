"""Rent or buy: a path is kept until waiting has cost as much as it costs, counted node by node in plain Python, then followed."""

from typing import NamedTuple

import numpy as np
import pytest

from avatarsim.ik.kinematics import parts_of, tangent_error
from avatarsim.ik.make import make_solver
from avatarsim.ik.objective import value_of
from avatarsim.ik.state import Avatars, Rig
from avatarsim.model.skeleton import Posture
from avatarsim.model.world import World, build
from avatarsim.planner.goal_test import aim_at_tracker, buy
from avatarsim.planner.planning_avatar import place_planning_avatar
from avatarsim.planner.rrt_connect import begin_search, search
from avatarsim.planner.state import GOAL_NODE, NONE, Outcome, Phase, Plan, PlanningAvatar, make_planner, plan_is_sound
from avatarsim.planner.tree import add_node, get_node
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from avatarsim.settings import PostureSettings
from tests.planner.scenes import Run, behind_the_wall, moved, walker
from tests.worlds.little_worlds import at, block

SETTINGS = PostureSettings()


class Planner(NamedTuple):
    """The planner of a world with one avatar."""

    world: World
    avatars: Avatars
    plan: Plan
    planning_avatar: PlanningAvatar

    @property
    def rig(self) -> Rig:
        """Return the world as its avatar has it."""
        return Rig(self.world.geometry, self.world.skeleton, self.avatars)

    def value(self, posture: Posture, target: Posture) -> float:
        """Return the objective [m^2] of a posture."""
        g = self.planning_avatar
        for mine, other in zip(g.posture, posture, strict=True):
            mine[:] = other
        place_planning_avatar(self.rig, 0, g)
        aim_at_tracker(self.rig, 0, target, g)
        tangent_error(self.rig, 0, posture, target, g.scratch.objective.error)
        return float(value_of(self.rig, 0, g.state, g.poses, g.scratch.objective)[0])

    def slice(self, target: Posture, work: int = 800) -> Outcome:
        """Run one slice of a search from the current posture of the world."""
        w, value = self.world, self.value(self.world.posture, target)
        return Outcome(
            search(self.rig, SETTINGS, 0, target, target, w.posture, w.poses, value, False, work, self.plan, self.planning_avatar)
        )


def planner_of(scene: Scene) -> Planner:
    """Return a planner at the scene's start."""
    world = build(scene)
    solver = make_solver(world.geometry, world.skeleton, world.posture, world.poses)
    up = np.array([0.0, 0.0, -9.8])
    plan, planning_avatar = make_planner(world.geometry, world.skeleton, *solver[:2], world.posture, world.poses, up, 0)
    begin_search(Rig(world.geometry, world.skeleton, solver[0]), 0, world.posture, plan)
    return Planner(world, solver[0], plan, planning_avatar)


def displaced(posture: Posture, way: np.ndarray, angle: float = 0.0) -> Posture:
    """Return a posture with its root elsewhere, and its hinges turned."""
    root = posture.root.copy()
    root[0] += way
    return Posture(root, posture.turn.copy(), posture.angle + angle)


@pytest.mark.parametrize("seed", range(5))
def test_a_path_is_bought_once_waiting_has_cost_as_much(seed: int) -> None:
    rng, avatar = np.random.default_rng(seed), walker()
    at_start = planner_of(Scene("s", (), (avatar,), start=rest((avatar,))))
    world, avatars, plan, planning_avatar = at_start
    skel, shown, s = world.skeleton, world.posture, plan.searches
    target = displaced(shown, np.array([0.5, 0.0, 0.0]), 0.1)
    nodes = [displaced(shown, rng.normal(scale=0.6, size=3), float(rng.normal(scale=0.3))) for _ in range(4)]
    path = (shown, *nodes, target)
    s.count[0] = 0
    for k, node in enumerate(path):
        plan.path[0, k] = add_node(at_start.rig, 0, node, NONE, 0, plan)
    s.length[0], s.phase[0] = len(path), Phase.CUT

    def lasts(one: Posture, other: Posture) -> float:
        """Return the time [s] of an edge at the catch-up speeds: of the joint or root that takes longest."""
        way = np.zeros(int(skel.first_dof[-1]))
        tangent_error(at_start.rig, 0, one, other, way)
        parts = [parts_of(skel, link, way) for link in range(len(skel.kind))]
        return max(max(moved / SETTINGS.catch_up_move, turned / SETTINGS.catch_up_turn) for moved, turned in parts)

    values, times = [at_start.value(node, target) for node in path], [lasts(path[k], path[k + 1]) for k in range(5)]
    cost = sum(times[k] * max(0.0, 0.5 * (values[k] + values[k + 1]) - values[0]) for k in range(5))
    assert cost > 0.0

    def bought(share: float, before: float) -> Outcome:
        s.paid[0], s.lasts[0] = share * cost, before
        return Outcome(buy(at_start.rig, SETTINGS, 0, target, target, shown, values[0], plan, planning_avatar))

    for share, found in ((0.0, Outcome.SEARCHING), (0.999, Outcome.SEARCHING), (1.001, Outcome.FOUND), (9.0, Outcome.FOUND)):
        assert bought(share, sum(times)) == found and s.lasts[0] == pytest.approx(sum(times))
    # not before a frame of shortcuts
    assert bought(9.0, 0.0) == Outcome.SEARCHING


def test_a_dear_path_is_kept_and_shortened_until_it_is_paid() -> None:
    scene, sample = behind_the_wall(walker())
    planner = planner_of(moved_to_the_wall(scene))
    s, target, took = planner.plan.searches, displaced(planner.world.posture, np.array([0.85, 0.0, 0.0])), list[float]()
    for _ in range(200):
        assert planner.slice(target) == Outcome.SEARCHING
        assert not took or s.phase[0] >= Phase.CUT
        if s.lasts[0] > 0.0:
            took.append(float(s.lasts[0]))
        if len(took) > 30:
            break
    assert len(took) > 30 and took[-1] < 0.8 * took[0] and took == sorted(took, reverse=True)
    s.paid[0] = 1e9
    assert planner.slice(target) == Outcome.FOUND


def test_a_path_begins_where_the_avatar_is_by_then() -> None:
    scene, _ = behind_the_wall(walker())
    planner = planner_of(moved_to_the_wall(scene))
    s, shown = planner.plan.searches, planner.world.posture
    target, first = displaced(shown, np.array([0.85, 0.0, 0.0])), displaced(shown, np.zeros(3))
    for _ in range(40):
        shown.root[0] += (0.0, -0.02, 0.0)
        planner.slice(target)
    assert s.phase[0] >= Phase.CUT and plan_is_sound(planner.plan)
    places = []
    for k in range(s.length[0]):
        get_node(planner.rig, 0, planner.plan.path[0, k], planner.plan, first)
        places.append(first.root[0].copy())
    assert np.linalg.norm(places[0] - shown.root[0]) < 0.15 and np.linalg.norm(places[-1] - target.root[0]) < 0.1


def moved_to_the_wall(scene: Scene) -> Scene:
    """Return the same with the avatar right before the wall."""
    return Scene(scene.name, scene.bodies, scene.avatars, start=at(scene.first_sample, (0.54, 0.0, 0.0)))


@pytest.mark.parametrize(("frames", "is_led"), [(10, False), (30, False), (240, True)])
def test_led_around_a_table_only_once_waiting_has_paid(frames: int, is_led: bool) -> None:
    avatar = walker()
    scene = Scene("table", (block("table", (0.0, 0.0, -0.55), (5.0, 5.0, 0.1)),), (avatar,), start=rest((avatar,)))
    run, below = Run(scene), moved(scene, (0.0, 0.0, -1.2))
    run.go(below, frames)
    assert ("following" in run.said) == is_led
    if not is_led:
        run.go(scene.first_sample, 30)
        assert "following" not in run.said and run.far(scene.first_sample) < 1e-6


def test_a_kept_path_follows_a_near_target_or_is_stale() -> None:
    scene, _ = behind_the_wall(walker())
    planner = planner_of(moved_to_the_wall(scene))
    s, start = planner.plan.searches, planner.world.posture
    target = displaced(start, np.array([0.85, 0.0, 0.0]))
    while s.lasts[0] == 0.0:
        planner.slice(target)
    for k in range(12):
        target = displaced(start, np.array([0.85 + 0.03 * k, 0.02 * k, 0.0]))
        for _ in range(4):
            assert planner.slice(target) == Outcome.SEARCHING
    end = displaced(start, np.zeros(3))
    get_node(planner.rig, 0, planner.plan.path[0, s.length[0] - 1], planner.plan, end)
    assert np.linalg.norm(end.root[0] - target.root[0]) < 0.05
    assert planner.slice(displaced(start, np.array([-0.3, 0.0, 0.0]))) == Outcome.STALE


def test_a_stale_goal_ends_its_search() -> None:
    scene, _ = behind_the_wall(walker())
    planner = planner_of(moved_to_the_wall(scene))
    s, start = planner.plan.searches, planner.world.posture
    while s.phase[0] == Phase.GOAL:
        planner.slice(displaced(start, np.array([0.85, 0.0, 0.0])), 30)
    assert s.count[0] > GOAL_NODE and plan_is_sound(planner.plan)
    assert planner.slice(displaced(start, np.array([-0.3, 0.0, 0.0]))) == Outcome.STALE
