"""Couplings in the posture solver: matrices, gradients and rows are those of the joints that move by themselves, x = G x'."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.errors import InvalidScene
from avatarsim.ik.constraints import add_contact
from avatarsim.ik.couplings import share_budget
from avatarsim.ik.motion_budget import bound_step
from avatarsim.ik.objective import model
from avatarsim.ik.target import clip_avatar
from avatarsim.model.couplings import elimination_parents, fold, follow_leaders, set_followers
from avatarsim.model.dynamics import make_linkage
from avatarsim.rigid.linkage_couplings import fold_limits, fold_matrix
from avatarsim.scene.joint import Coupling
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from tests.ik.solvers import Solver, copied, metric_of, point_rates, random_posture, solver_of
from tests.worlds.little_worlds import sliding_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

COUPLINGS = (Coupling(2, 0, 0.4, 0.1), Coupling(3, 1, 0.2, 0.3), Coupling(4, 0, -0.4))
"""A hinge of one limb and the slide of another follow the two hinges of a third, and so does a hinge that the slide carries."""

LOOSE = Scene("loose", (), (sliding_avatar(), sliding_avatar("n")))
COUPLED = replace(LOOSE, name="coupled", avatars=tuple(replace(one, couplings=COUPLINGS) for one in LOOSE.avatars))
FREE, BOUND = solver_of(LOOSE), solver_of(COUPLED)


def reduction(found: Solver) -> np.ndarray:
    """Return G (nd, nd): columns of followers are zero."""
    skel = found.world.skeleton
    whole = np.eye(len(found.avatars.joint_of))
    for (b, a), (ratio, _) in zip(skel.follow, skel.ratio, strict=True):
        whole[b] = 0.0
        whole[b, a] = ratio
    return whole


def both_at(seed: int, by: float) -> tuple[Solver, Solver, np.ndarray]:
    """The loose and the coupled avatars at one posture that keeps couplings, with one target that does; degrees that lead."""
    posture = random_posture(BOUND, seed)
    set_followers(BOUND.world.skeleton, 0, len(posture.angle), 0.0, posture)
    BOUND.take(posture)
    target = BOUND.after(reduction(BOUND) @ np.random.default_rng(seed).normal(0.0, by, len(posture.angle)))
    for found in (FREE, BOUND):
        found.take(posture)
        found.follow(target)
        for avatar in range(found.count):
            model(found.rig, avatar, found.state, found.world.poses, found.working.objective)
    leads = np.ones(len(posture.angle), dtype=np.bool_)
    leads[BOUND.world.skeleton.follow[:, 0]] = False
    return FREE, BOUND, leads


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("by", [0.02, 0.5])
def test_metric_and_newton_step_are_of_the_joints_that_lead(seed: int, by: float) -> None:
    free, bound, leads = both_at(seed, by)
    whole, dense = reduction(bound), metric_of(free)
    wanted = whole.T @ dense @ whole
    found = metric_of(bound)
    assert found[np.ix_(leads, leads)] == pytest.approx(wanted[np.ix_(leads, leads)], abs=1e-10)
    assert found[~leads][:, ~leads] == pytest.approx(np.eye(int((~leads).sum())), abs=1e-12)
    assert found[np.ix_(leads, ~leads)] == pytest.approx(0.0, abs=1e-12)
    pull = whole.T @ dense @ free.working.objective.newton
    newton = bound.working.objective.newton
    assert newton[leads] == pytest.approx(np.linalg.solve(wanted[np.ix_(leads, leads)], pull[leads]), abs=1e-9)


@given(st.integers(0, 10**6))
def test_the_factor_of_a_reduced_matrix_lies_on_tree_paths(seed: int) -> None:
    """By a dense factor of a random matrix of the pattern that a random tree of links has."""
    rng = np.random.default_rng(seed)
    links = int(rng.integers(2, 9))
    parent = [-1, *(int(rng.integers(0, k)) for k in range(1, links))]
    related = np.eye(links, dtype=np.bool_)
    for k in range(1, links):
        related[k] |= related[parent[k]]
    counts = rng.integers(0, 3, links)
    first = np.concatenate([[0], np.cumsum(counts)])
    nd = int(first[-1])
    order = rng.permutation(nd)
    follow = [(int(max(a, b)), int(min(a, b))) for a, b in zip(order[::2], order[1::2], strict=False) if rng.random() < 0.4]
    skel: Any = SimpleNamespace(kind=np.zeros(links), first_dof=first, related=related, follow=np.array(follow).reshape(-1, 2))
    parents = elimination_parents(skel)
    joint_of = np.repeat(np.arange(links), counts)
    rows = rng.normal(size=(nd, nd)) * related[np.ix_(joint_of, joint_of)]
    whole = np.eye(nd)
    for b, a in follow:
        whole[b] = 0.0
        whole[b, a] = 2.0
    # the mass matrix of such a tree is J^T J, each row of which is of one link and those that carry it
    matrix = whole.T @ rows.T @ rows @ whole
    for b, _ in follow:
        matrix[b, b] = 1.0
    flipped = np.linalg.cholesky(matrix[::-1, ::-1] + 1e-6 * np.eye(nd))[::-1, ::-1].T if nd else matrix
    for k in range(nd):
        chain, at = set(), k
        while at >= 0:
            chain.add(at)
            at = int(parents[at])
        assert set(np.flatnonzero(np.abs(flipped[k]) > 1e-9).tolist()) <= chain


@pytest.mark.parametrize("seed", range(3))
def test_rows_bounds_and_steps_are_those_of_the_joints_that_lead(seed: int) -> None:
    _, bound, leads = both_at(seed, 0.1)
    skel, s, whole = bound.world.skeleton, bound.working, reduction(bound)
    bound.solve_for_all()
    s.rows.used[0], link = 0, 6
    piece = int(bound.world.geometry.first_shape[skel.first + link])
    normal = np.array([0.6, 0.0, 0.8])
    at: Any = tuple((bound.world.poses.position[skel.first + link] + (0.1, 0.2, 0.3)).tolist())
    add_contact(bound.rig, piece, 0, (0.6, 0.0, 0.8), at, at, 0.0, bound.world.poses, bound.state.axes, s.still, s)
    own = slice(0, int(bound.avatars.first_dof[1]))
    rates = normal @ point_rates(bound, link, np.array([0.1, 0.2, 0.3])) @ whole
    other = normal @ point_rates(bound, 0, np.array(at) - bound.world.poses.position[skel.first]) @ whole
    assert s.rows.jacobian[0, own] == pytest.approx((rates - other)[own], abs=1e-12)
    bound.state.budget.turn[:], bound.state.budget.turned[:], bound.state.budget.move[:] = 0.5, 0.0, 0.05
    for avatar in range(bound.count):
        bound_step(bound.rig, avatar, bound.world.posture, bound.state.budget, s)
    for end in (s.low, s.high):
        step = np.where(leads, end, 0.0)
        follow_leaders(skel, 0, len(step), step)
        assert np.abs(step[skel.follow[:, 0]]).max() <= 0.5 + 1e-12
        assert np.abs(step[int(skel.first_dof[5])]) <= 0.05 + 1e-12
        angle = bound.world.posture.angle + step
        assert (angle >= skel.limits[:, 0] - 1e-12).all() and (angle <= skel.limits[:, 1] + 1e-12).all()


def test_a_followers_budget_shortens_its_leaders_step() -> None:
    skel, step = BOUND.world.skeleton, np.zeros(len(BOUND.avatars.joint_of))
    (b, a), ratio = skel.follow[0], skel.ratio[0, 0]
    step[a], step[b] = 1.0, 0.1
    share_budget(skel, 0, len(step), step)
    follow_leaders(skel, 0, len(step), step)
    assert step[a] == pytest.approx(0.1 / ratio) or step[a] == 0.0
    step[a], step[skel.follow[:, 0]] = 1.0, 0.0
    for k, (one, leader) in enumerate(skel.follow):
        step[one] = skel.ratio[k, 0] * step[leader]
    share_budget(skel, 0, len(step), step)
    assert step[a] == 1.0


def test_a_target_is_pulled_to_its_leader() -> None:
    skel, found = BOUND.world.skeleton, BOUND
    posture = random_posture(found, 3)
    posture.turn[:] = np.eye(3)
    set_followers(skel, 0, len(posture.angle), 0.0, posture)
    for off, legal in ((1e-14, 1), (1e-3, 0)):
        asked = copied(posture)
        asked.angle[skel.follow[1, 0]] += off
        clip_avatar(found.rig, 0, asked, found.state.tracking, found.working.target)
        assert found.state.tracking.is_legal[0] == legal
        assert found.working.target.angle[skel.follow[1, 0]] == posture.angle[skel.follow[1, 0]]


def test_a_mass_matrix_under_load_is_reduced_as_well() -> None:
    linkage, rng = make_linkage(COUPLED), np.random.default_rng(0)
    high = int(BOUND.avatars.first_dof[1])
    rows = rng.normal(size=(high, high))
    dense, whole = rows @ rows.T, reduction(BOUND)[:high, :high]
    linkage.matrix[:high, :high] = dense
    fold_matrix(linkage, 0, high)
    followers = BOUND.world.skeleton.follow[: len(COUPLINGS), 0]
    wanted = whole.T @ dense @ whole
    wanted[followers, followers] = 1.0
    assert linkage.matrix[:high, :high] == pytest.approx(wanted, abs=1e-12)
    momentum = rng.normal(size=high)
    reduced = momentum.copy()
    fold(BOUND.world.skeleton, 0, high, reduced)
    assert reduced == pytest.approx(whole.T @ momentum)
    linkage.bounds[:, 0], linkage.bounds[:, 1] = -1.0, 2.0
    fold_limits(linkage, 0, high)
    leader = int(BOUND.world.skeleton.follow[2, 1])
    # of a follower with the ratio 0.4 and one with -0.4
    assert linkage.bounds[leader] == pytest.approx((-1.0, 2.0)) and np.isinf(linkage.bounds[followers]).all()


@pytest.mark.parametrize(("couplings", "thing"), [
    ((Coupling(2, 0, 3.0),), "limits of its leader"), ((Coupling(9, 0, 0.1),), "follower"),
    ((Coupling(2, 0, 0.4), Coupling(4, 2, 0.4)), "leader"), ((Coupling(2, 0, 0.4), Coupling(2, 1, 0.4)), "follower"),
])
def test_couplings_that_cannot_be_are_refused(couplings: tuple[Coupling, ...], thing: str) -> None:
    with pytest.raises(InvalidScene, match=thing):
        replace(sliding_avatar(), couplings=couplings)


def test_the_first_posture_keeps_couplings() -> None:
    avatar = COUPLED.avatars[0]
    angles = rest((avatar,)).angles
    assert angles == pytest.approx([0.0, 0.0, 0.1, 0.3, 0.0]) and avatar.with_followers(angles).tolist() == angles.tolist()


@pytest.mark.parametrize("number", [-1, 1.5, True])
def test_a_leader_is_a_number_before_its_followers(number: Any) -> None:
    with pytest.raises(InvalidScene):
        Coupling(1, number, 1.0)
    with pytest.raises(InvalidScene):
        Coupling(1, 0, 0.0)
