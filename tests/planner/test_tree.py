"""The trees of the planner against lists: postures to the bit, nearest nodes, paths, and which nodes a path keeps."""

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.ik.make import make_solver
from avatarsim.ik.state import Rig
from avatarsim.model.skeleton import Posture
from avatarsim.model.world import build
from avatarsim.planner.state import NONE, Plan, make_planner, plan_is_sound
from avatarsim.planner.tree import AIM, add_node, get_node, keep_path, nearest_node, put_node, square_distance, trace_path
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from avatarsim.spatial import rotation
from tests.worlds.little_worlds import sliding_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


class Little(NamedTuple):
    """The planner of a tree with every kind of joint, and its first posture."""

    rig: Rig
    plan: Plan
    posture: Posture


def fresh() -> Little:
    """Return an empty tree."""
    avatar = sliding_avatar()
    world = build(Scene("s", (), (avatar,), start=rest((avatar,))))
    solver = make_solver(world.geometry, world.skeleton, world.posture, world.poses)
    plan, _ = make_planner(
        world.geometry, world.skeleton, *solver[:2], world.posture, world.poses, np.array([0.0, 0.0, -9.8]), 0
    )
    return Little(Rig(world.geometry, world.skeleton, solver[0]), plan, world.posture)


def drawn(posture: Posture, seed: int) -> Posture:
    """Return any posture."""
    rng, count = np.random.default_rng(seed), len(posture.root)
    turn = rotation.to_matrix(rotation.normalised(rng.normal(size=(count, 4))))
    return Posture(rng.normal(size=(count, 3)), turn, rng.normal(size=posture.angle.shape))


def test_a_node_gives_back_the_posture_that_it_got_to_the_bit() -> None:
    at = fresh()
    for seed in range(3):
        k = add_node(at.rig, 0, drawn(at.posture, seed), NONE, 0, at.plan)
        found = drawn(at.posture, 9)
        get_node(at.rig, 0, k, at.plan, found)
        assert k == seed and np.array_equal(found.root[0], drawn(at.posture, seed).root[0])
        put_node(at.rig, 0, found, AIM, at.plan)
        assert np.array_equal(at.plan.node[0, AIM], at.plan.node[0, k]) and np.any(at.plan.node[0, k])


def test_the_distance_is_that_of_the_objective_near_by() -> None:
    at = fresh()
    one, w = at.posture, at.rig.avatars.turn_weight
    moved = Posture(one.root.copy(), one.turn.copy(), one.angle.copy())
    moved.root[0] += (0.03, 0.0, 0.04)
    slide = at.rig.skel.first_dof[5]
    moved.angle[at.rig.skel.first_dof[2]] += 0.2
    moved.angle[slide] += 0.1
    moved.turn[1] = moved.turn[1] @ rotation.to_matrix(rotation.from_axis_angle((1.0, 0.0, 0.0), 0.01))
    for k, posture in enumerate((one, moved)):
        put_node(at.rig, 0, posture, k, at.plan)
    wanted = 7 * 0.05**2 + w[slide] * 0.1**2 + w[at.rig.skel.first_dof[2]] * 0.2**2 + w[at.rig.skel.first_dof[1]] * 0.01**2
    assert square_distance(at.rig, 0, 0, 1, at.plan) == pytest.approx(wanted, rel=1e-4)


@given(st.lists(st.tuples(st.floats(-2.0, 2.0), st.integers(0, 1)), min_size=2, max_size=20), st.floats(-2.0, 2.0))
def test_the_nearest_node_of_a_tree_is_found(nodes: list[tuple[float, int]], aim: float) -> None:
    at = fresh()
    for x, tree in nodes:
        at.posture.root[0] = (x, 0.0, 0.0)
        add_node(at.rig, 0, at.posture, NONE, tree, at.plan)
    at.posture.root[0] = (aim, 0.0, 0.0)
    put_node(at.rig, 0, at.posture, AIM, at.plan)
    mine = [abs(x - aim) for x, tree in nodes if tree == 1]
    if mine:
        found = nearest_node(at.rig, 0, AIM, 1, at.plan)
        assert nodes[found][1] == 1 and abs(nodes[found][0] - aim) == pytest.approx(min(mine), abs=1e-9)


def grown(parents: list[int]) -> tuple[Little, list[int]]:
    """Return trees 0 and 1 with roots at nodes 0 and 1; each further node follows one before it."""
    at = fresh()
    before = [NONE, NONE]
    for k, parent in enumerate(parents):
        before.append(parent % (k + 2))
    for k, parent in enumerate(before):
        at.posture.root[0] = (float(k), 0.0, 0.0)
        add_node(at.rig, 0, at.posture, parent, k, at.plan)
    return at, before


def to_root(before: list[int], k: int) -> list[int]:
    """Return nodes from k to its root."""
    return [k, *to_root(before, before[k])] if before[k] >= 0 else [k]


@settings(max_examples=30)
@given(st.lists(st.integers(0, 10**6), max_size=40), st.data())
def test_a_path_joins_both_trees_and_alone_is_kept(parents: list[int], data: st.DataObject) -> None:
    at, before = grown(parents)
    nodes = st.integers(0, len(before) - 1)
    one = data.draw(nodes.filter(lambda k: to_root(before, k)[-1] == 0))
    here = data.draw(nodes.filter(lambda k: to_root(before, k)[-1] == 0))
    other = data.draw(nodes.filter(lambda k: to_root(before, k)[-1] == 1))
    trace_path(0, here, one, other, at.plan)
    up, down = to_root(before, here), to_root(before, one)
    both = max(set(up) & set(down))
    through = up[: up.index(both)] + [both] + down[: down.index(both)][::-1]
    s, wanted = at.plan.searches, through + to_root(before, other)
    assert at.plan.path[0, : s.length[0]].tolist() == wanted
    s.place[0] = place = data.draw(st.integers(0, len(wanted) - 1))
    keep_path(0, at.plan)
    kept = at.plan.path[0, : s.length[0]]
    assert s.place[0] == 0 and s.count[0] == len(kept) and plan_is_sound(at.plan)
    assert at.plan.node[0, kept, 0].tolist() == [float(k) for k in wanted[place:]]


@pytest.mark.parametrize(("name", "value"), [("at", 7), ("begun", 9), ("place", 5), ("cut_to", 5), ("meeting", 7), ("here", 7)])
def test_a_plan_that_names_what_is_not_there_is_not_sound(name: str, value: int) -> None:
    at, _ = grown([0, 1, 2])
    trace_path(0, 0, 2, 3, at.plan)
    assert plan_is_sound(at.plan)
    getattr(at.plan.searches, name)[0] = value
    assert not plan_is_sound(at.plan)


def test_a_tree_from_bytes_that_runs_in_a_circle_is_not_sound() -> None:
    at, _ = grown([0, 1, 2])
    at.plan.before[0, 2] = 4
    assert not plan_is_sound(at.plan)
