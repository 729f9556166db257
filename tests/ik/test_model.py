"""Kinematics and objective of a posture: poses, steps, gradient and metric against plain twins and finite differences."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.ik.kinematics import parts_of, tangent_error, try_step
from avatarsim.ik.objective import LOSS_RADIUS, model, value_of
from avatarsim.model.skeleton import BALL, FREE, SLIDE, Posture
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from tests.ik.solvers import TREES, Solver, apart, copied, metric_of, point_rates, random_posture, solver_of
from tests.worlds.little_worlds import random_sample, sliding_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
FOUND = solver_of(TREES)


def at_random(seed: int) -> Solver:
    """Return the trees at a random posture."""
    FOUND.take(random_posture(FOUND, seed))
    return FOUND


def tried(found: Solver, step: np.ndarray) -> np.ndarray:
    """Return vertices at the trial of a step of all avatars."""
    found.working.step[:] = step
    for avatar in range(found.count):
        try_step(found.rig, avatar, found.world.posture, found.working)
    return found.working.trial.vertices.copy()


def differences(found: Solver, start: Posture, end: Posture) -> np.ndarray:
    """Return the tangent error of all avatars."""
    error = np.full(len(found.avatars.joint_of), np.nan)
    for avatar in range(found.count):
        tangent_error(found.rig, avatar, start, end, error)
    return error


@pytest.mark.parametrize("seed", range(4))
def test_poses_agree_with_the_plain_twin(seed: int) -> None:
    found, sample = solver_of(TREES), random_sample(TREES.avatars, seed)
    sample.angles[:] = 0.3 * np.tanh(sample.angles)
    hinges = found.world.posture.angle
    hinges[found.world.hinges] = sample.angles
    balls = random_posture(found, seed)
    found.take(type(balls)(balls.root, balls.turn, hinges.copy()))
    positions, orientations = link_poses(TREES.avatars, sample)
    first = found.world.skeleton.first
    assert found.world.poses.position[first:] == pytest.approx(positions, abs=1e-13)
    assert found.world.poses.rotation[first:] == pytest.approx(rotation.to_matrix(orientations), abs=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_axes_are_how_points_move(seed: int) -> None:
    found, h = at_random(seed), 1e-6
    geo, skel, poses = found.world.geometry, found.world.skeleton, found.world.poses
    rows = [geo.shapes.start[geo.first_shape[skel.first + link]] for link in range(len(skel.kind))]
    arms = [poses.vertices[r] - poses.position[skel.first + link] for link, r in enumerate(rows)]
    for j in range(len(found.avatars.joint_of)):
        step = np.zeros(len(found.avatars.joint_of))
        step[j] = h
        rate = (tried(found, step)[rows] - tried(found, -step)[rows]) / (2.0 * h)
        for link, arm in enumerate(arms):
            assert rate[link] == pytest.approx(point_rates(found, link, arm)[:, j], abs=1e-7)


@given(st.integers(0, 10**6), st.floats(0.01, 1.0))
def test_a_step_leads_to_its_trial_and_its_error_is_the_step(seed: int, by: float) -> None:
    found = at_random(seed)
    limits, posture = found.world.skeleton.limits, copied(found.world.posture)
    step = np.random.default_rng(seed).normal(0.0, by, len(found.avatars.joint_of))
    step = np.clip(posture.angle + step, *limits.T) - posture.angle
    vertices, end = tried(found, step), found.after(step)
    error = differences(found, posture, end)
    turned = Rotation.from_rotvec
    for link, kind in enumerate(found.world.skeleton.kind):
        d = int(found.world.skeleton.first_dof[link])
        if kind == BALL:
            # a turn beyond half a turn comes back the other way round
            assert turned(error[d : d + 3]).as_matrix() == pytest.approx(turned(step[d : d + 3]).as_matrix(), abs=1e-12)
    if by < 0.5:
        assert error == pytest.approx(step, abs=1e-12)
    found.take(end)
    assert found.world.poses.vertices == pytest.approx(vertices, abs=1e-12)


def test_many_steps_keep_rotations_and_hinge_limits() -> None:
    found, rng = at_random(1), np.random.default_rng(0)
    limits = found.world.skeleton.limits
    for _ in range(300):
        found.take(found.after(rng.normal(size=len(found.avatars.joint_of))))
        assert (found.world.posture.angle >= limits[:, 0]).all() and (found.world.posture.angle <= limits[:, 1]).all()
    for turn in found.world.posture.turn:
        assert turn.T @ turn == pytest.approx(np.eye(3), abs=2e-15)


NEAR, FAR = 0.02, 0.5
"""Spreads of a target: one within the loss radius, and one whose origins and root are beyond it."""


def modelled(seed: int, by: float) -> Solver:
    """Return the trees apart from their target, with the model of each."""
    found = apart(seed, by)
    for avatar in range(found.count):
        model(found.rig, avatar, found.state, found.world.poses, found.working.objective)
    return found


def radius(found: Solver) -> np.ndarray:
    """Return the loss radius (nl) [m]."""
    return LOSS_RADIUS * np.asarray(found.state.tracking.reach)[found.avatars.avatar]


def distances(found: Solver, origins: np.ndarray) -> np.ndarray:
    """Return the distance (nl) [m] of link origins from those."""
    return np.asarray(np.linalg.norm(origins - found.world.poses.position[found.world.skeleton.first :], axis=1))


def written_out(found: Solver, origins: np.ndarray) -> float:
    """Return the objective of all avatars as docs/posture.md has it, towards those link origins."""
    r, d = distances(found, origins), radius(found)
    huber = np.where(r <= d, 0.5 * r * r, d * (r - 0.5 * d))
    return float(found.avatars.link_weight @ huber + 0.5 * (found.avatars.turn_weight * found.working.objective.error**2).sum())


def value_after(found: Solver, step: np.ndarray, forces: np.ndarray, arms: np.ndarray) -> float:
    """Return the objective less the work of `forces` on points of links, after a step."""
    kept, target = copied(found.world.posture), copied(found.state.tracker_before)
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
    """Return the gradient that the model's Newton step implies."""
    return -metric_of(found) @ found.working.objective.newton


def nothing(found: Solver) -> np.ndarray:
    """Return no forces, or arms of no length."""
    return np.zeros((len(found.world.skeleton.kind), 3))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("by", [NEAR, FAR])
def test_the_value_is_the_sum_that_the_page_states(seed: int, by: float) -> None:
    found = modelled(seed, by)
    told = [
        value_of(found.rig, avatar, found.state, found.world.poses, found.working.objective)
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
def test_the_metric_exceeds_gauss_newtons_only_where_links_turn(seed: int, by: float) -> None:
    """The excess over Gauss and Newton's matrix, dense, comes from bending: nothing of translations, and nothing negative."""
    found = modelled(seed, by)
    r = distances(found, found.working.objective.aim)
    dense, none = np.diag(found.avatars.turn_weight), np.zeros(3)
    for link, weight in enumerate(found.avatars.link_weight * np.minimum(1.0, radius(found) / r)):
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
    found.state.force[:], found.state.curvature[:] = forces, np.linalg.norm(forces, axis=1) * np.linalg.norm(arms, axis=1)
    for avatar in range(found.count):
        model(found.rig, avatar, found.state, found.world.poses, found.working.objective)
    metric, h, none = metric_of(found), 1e-4, np.zeros(len(found.avatars.joint_of))
    at = value_after(found, none, forces, arms)
    for _ in range(20):
        x = rng.normal(size=len(none))
        x /= np.linalg.norm(x)
        bent = (value_after(found, h * x, forces, arms) + value_after(found, -h * x, forces, arms) - 2.0 * at) / h**2
        assert bent <= x @ metric @ x + 1e-6


@pytest.mark.parametrize("by", [0.0, 0.3])
def test_a_far_target_pulls_as_one_at_the_loss_radius(by: float) -> None:
    """A root that is 3 m off is drawn near, with all its origins, so that its posture is followed as if it were near."""
    pulls, turns = [], np.random.default_rng(2).normal(0.0, by, len(FOUND.avatars.joint_of))
    for far in (0.2, 3.0, 300.0):
        found = apart(1, 0.0)
        target = found.after(np.where(found.avatars.turn_weight > 0.0, turns, 0.0))
        target.root[0, 0] += far
        found.follow(target)
        model(found.rig, 0, found.state, found.world.poses, found.working.objective)
        pulls.append(gradient(found)[: found.avatars.first_dof[1]])
    d = radius(found)[0]
    assert pulls[1] == pytest.approx(pulls[0], abs=1e-9) and pulls[2] == pytest.approx(pulls[0], abs=1e-9)
    if by == 0.0:
        assert -pulls[0][0] == pytest.approx(len(sliding_avatar().links) * d, rel=1e-9)


@pytest.mark.parametrize("seed", range(2))
def test_parts_of_a_step_are_norms_of_its_ways_and_joints(seed: int) -> None:
    found = at_random(seed)
    skel, step = found.world.skeleton, np.random.default_rng(seed).normal(size=len(found.avatars.joint_of))
    for link in range(len(skel.kind)):
        mine = step[skel.first_dof[link] : skel.first_dof[link + 1]]
        way = {FREE: 3, SLIDE: 1}.get(int(skel.kind[link]), 0)
        root, joint = mine[:way], mine[way:]
        assert parts_of(skel, link, step) == pytest.approx((np.linalg.norm(root), np.linalg.norm(joint)), abs=1e-14)
