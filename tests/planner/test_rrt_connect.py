"""Rent or buy: a path is followed once waiting has cost what the path costs, counted node by node in plain Python."""

import numpy as np
import pytest

from avatarsim.ik.kinematics import parts_of, tangent_error
from avatarsim.ik.make import make_solver
from avatarsim.ik.objective import value_of
from avatarsim.planner.ghost import put_ghost
from avatarsim.planner.make import make_planner
from avatarsim.planner.rrt_connect import aim_at_target, is_worth_it
from avatarsim.planner.state import NONE
from avatarsim.planner.tree import add_node, get_node
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from avatarsim.settings import PostureSettings
from avatarsim.world.skeleton import Posture
from avatarsim.world.world import build
from tests.planner.scenes import walker

SETTINGS = PostureSettings()


def displaced(posture: Posture, way: np.ndarray, angle: float) -> Posture:
    """A posture with its root elsewhere, and its hinges turned."""
    return Posture(posture.root + way, posture.turn.copy(), posture.angle + angle)


@pytest.mark.parametrize("seed", range(5))
def test_a_path_is_bought_once_waiting_has_cost_as_much(seed: int) -> None:
    rng, avatar = np.random.default_rng(seed), walker()
    world = build(Scene("s", (), (avatar,), start=rest((avatar,))))
    geo, skel, shown = world.geometry, world.skeleton, world.posture
    solver = make_solver(geo, skel, shown, world.poses)
    avatars, up = solver[0], np.array([0.0, 0.0, -9.8])
    plan, ghost = make_planner(geo, skel, *solver[:2], shown, world.poses, up, 0)
    target = displaced(shown, np.array([0.5, 0.0, 0.0]), 0.1)
    nodes = [displaced(shown, rng.normal(scale=0.6, size=3), float(rng.normal(scale=0.3))) for _ in range(4)]
    for k, node in enumerate((shown, *nodes, target)):
        plan.path[0, k] = add_node(skel, avatars, 0, node, NONE, 0, plan)
    plan.searches.length[0] = 6

    def objective(k: int) -> float:
        """The objective at a node of the path."""
        get_node(skel, avatars, 0, plan.path[0, k], plan, ghost.posture)
        put_ghost(geo, skel, avatars, 0, ghost)
        aim_at_target(skel, avatars, 0, target, target, ghost)
        return float(value_of(skel, avatars, 0, ghost.state, ghost.poses, ghost.scratch.objective)[0])

    def lasts(one: Posture, other: Posture) -> float:
        """Time [s] of an edge at the catch-up speeds: of the joint or root that takes longest."""
        way = np.zeros(int(skel.first_dof[-1]))
        tangent_error(skel, avatars, 0, one, other, way)
        parts = [parts_of(skel, link, way) for link in range(len(skel.kind))]
        return max(max(moved / SETTINGS.catch_up_move, turned / SETTINGS.catch_up_turn) for moved, turned in parts)

    path, values = (shown, *nodes, target), [objective(k) for k in range(6)]
    cost = sum(
        lasts(path[k], path[k + 1]) * max(0.0, 0.5 * (values[k] + values[k + 1]) - values[0]) for k in range(5)
    )
    assert cost > 0.0
    for share, worth in ((0.0, False), (0.999, False), (1.001, True), (9.0, True)):
        plan.searches.paid[0] = share * cost
        assert is_worth_it(geo, skel, avatars, SETTINGS, 0, target, target, shown, values[0], plan, ghost) == worth
