"""Objective of a posture: gradient and metric against finite differences and dense matrices."""

import numpy as np
import pytest

from avatarsim.ik.objective import LOSS_RADIUS, model, value_of
from tests.ik.solvers import Solver, apart, copied, metric_of, point_rates
from tests.worlds.little_worlds import mixed_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
NEAR, FAR = 0.02, 0.5
"""Spreads of a target: one within the loss radius, and one whose origins and root are beyond it."""


def modelled(seed: int, by: float) -> Solver:
    """The trees apart from their target, with the model of each."""
    found = apart(seed, by)
    for avatar in range(found.count):
        model(found.world.skeleton, found.avatars, avatar, found.state, found.world.poses, found.working.objective)
    return found


def radius(found: Solver) -> np.ndarray:
    """The loss radius (nl) [m]."""
    return LOSS_RADIUS * np.asarray(found.state.tracking.reach)[found.avatars.avatar]


def distances(found: Solver, origins: np.ndarray) -> np.ndarray:
    """Distance (nl) [m] of link origins from those."""
    return np.asarray(np.linalg.norm(origins - found.world.poses.position[found.world.skeleton.first :], axis=1))


def written_out(found: Solver, origins: np.ndarray) -> float:
    """The objective of all avatars as docs/posture.md has it, towards those link origins."""
    r, d = distances(found, origins), radius(found)
    huber = np.where(r <= d, 0.5 * r * r, d * (r - 0.5 * d))
    return float(huber.sum() + 0.5 * (found.avatars.turn_weight * found.working.objective.error**2).sum())


def value_after(found: Solver, step: np.ndarray, forces: np.ndarray, arms: np.ndarray) -> float:
    """The objective less the work of `forces` on points of links, after a step."""
    kept, target = copied(found.world.posture), copied(found.state.own)
    found.take(found.after(step))
    found.follow(target)
    skel = found.world.skeleton
    value = written_out(found, found.working.objective.aim)
    for link, (force, arm) in enumerate(zip(forces, arms, strict=True)):
        body = skel.first + link
        value -= float(force @ (found.world.poses.position[body] + found.world.poses.rotation[body] @ arm))
    found.take(kept)
    found.follow(target)
    return value


def gradient(found: Solver) -> np.ndarray:
    """What the model's Newton step says that the gradient is."""
    return -metric_of(found) @ found.working.objective.newton


def nothing(found: Solver) -> np.ndarray:
    """No forces, or arms of no length."""
    return np.zeros((len(found.world.skeleton.kind), 3))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("by", [NEAR, FAR])
def test_the_value_is_the_sum_that_the_page_states(seed: int, by: float) -> None:
    found = modelled(seed, by)
    told = [
        value_of(found.world.skeleton, found.avatars, avatar, found.state, found.world.poses, found.working.objective)
        for avatar in range(found.count)
    ]
    origins = found.working.objective.origin
    assert sum(value for value, _ in told) == pytest.approx(written_out(found, origins), rel=1e-12)
    assert max(far for _, far in told) == pytest.approx(distances(found, origins).max(), rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("by", [NEAR, FAR])
def test_the_gradient_is_that_of_the_value(seed: int, by: float) -> None:
    found, h = modelled(seed, by), 1e-6
    wanted, none = np.zeros(len(found.avatars.joint_of)), nothing(found)
    for j in range(len(wanted)):
        step = np.zeros(len(wanted))
        step[j] = h
        wanted[j] = (value_after(found, step, none, none) - value_after(found, -step, none, none)) / (2.0 * h)
    assert np.abs(wanted).max() > 0.01
    assert gradient(found) == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("by", [NEAR, FAR])
def test_the_metric_is_gauss_newtons_and_more_only_where_links_turn(seed: int, by: float) -> None:
    """What is more than Gauss and Newton's matrix, dense, is what bends: nothing of translations, and nothing negative."""
    found = modelled(seed, by)
    r = distances(found, found.working.objective.aim)
    dense, none = np.diag(found.avatars.turn_weight), np.zeros(3)
    for link, weight in enumerate(np.minimum(1.0, radius(found) / r)):
        rates = point_rates(found, link, none)
        dense += weight * rates.T @ rates
    more = metric_of(found) - dense
    shifts = [j for a in range(found.count) for j in range(found.avatars.first_dof[a], found.avatars.first_dof[a] + 3)]
    assert more[shifts] == pytest.approx(0.0, abs=1e-12) and more == pytest.approx(more.T, abs=1e-12)
    assert np.linalg.eigvalsh(more).min() > -1e-12 and more.max() > 1e-4


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("by", [NEAR, FAR])
def test_the_model_lies_above_the_lagrangian_to_second_order(seed: int, by: float) -> None:
    """With contact forces on links the metric bounds the curvature of f minus their work from above, in random directions."""
    found, rng = apart(seed, by), np.random.default_rng(seed)
    forces, arms = 5.0 * rng.normal(size=nothing(found).shape), 0.2 * rng.normal(size=nothing(found).shape)
    found.state.force[:], found.state.bend[:] = forces, np.linalg.norm(forces, axis=1) * np.linalg.norm(arms, axis=1)
    for avatar in range(found.count):
        model(found.world.skeleton, found.avatars, avatar, found.state, found.world.poses, found.working.objective)
    metric, h, none = metric_of(found), 1e-4, np.zeros(len(found.avatars.joint_of))
    at = value_after(found, none, forces, arms)
    for _ in range(20):
        x = rng.normal(size=len(none))
        x /= np.linalg.norm(x)
        bent = (value_after(found, h * x, forces, arms) + value_after(found, -h * x, forces, arms) - 2.0 * at) / h**2
        assert bent <= x @ metric @ x + 1e-6


@pytest.mark.parametrize("by", [0.0, 0.3])
def test_a_target_far_beyond_pulls_no_harder_than_one_at_the_loss_radius(by: float) -> None:
    """A root that is 3 m off is drawn near, with all its origins, so that its posture is followed as if it were near."""
    pulls, turns = [], np.random.default_rng(2).normal(0.0, by, 30)
    for far in (0.2, 3.0, 300.0):
        found = apart(1, 0.0)
        target = found.after(np.where(found.avatars.turn_weight > 0.0, turns, 0.0))
        target.root[0, 0] += far
        found.follow(target)
        model(found.world.skeleton, found.avatars, 0, found.state, found.world.poses, found.working.objective)
        pulls.append(gradient(found)[: found.avatars.first_dof[1]])
    d = radius(found)[0]
    assert pulls[1] == pytest.approx(pulls[0], abs=1e-9) and pulls[2] == pytest.approx(pulls[0], abs=1e-9)
    if by == 0.0:
        assert -pulls[0][0] == pytest.approx(len(mixed_avatar().links) * d, rel=1e-9)
