"""Forward kinematics of one avatar at a time against its plain twin; steps and tangent errors against each other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.ik.kinematics import tangent_error, try_step
from avatarsim.model.skeleton import BALL
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from tests.ik.solvers import TREES, Solver, copied, point_rates, random_posture, solver_of
from tests.worlds.little_worlds import random_sample

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
FOUND = solver_of(TREES)


def at_random(seed: int) -> Solver:
    """The trees at a random posture."""
    FOUND.take(random_posture(FOUND, seed))
    return FOUND


def tried(found: Solver, step: np.ndarray) -> np.ndarray:
    """Vertices at the trial of a step of all avatars."""
    found.working.step[:] = step
    for avatar in range(found.count):
        try_step(found.world.geometry, found.world.skeleton, found.avatars, avatar, found.world.posture, found.working)
    return found.working.trial.vertices.copy()


def differences(found: Solver, start: object, end: object) -> np.ndarray:
    """The tangent error of all avatars."""
    error = np.full(len(found.avatars.joint_of), np.nan)
    for avatar in range(found.count):
        tangent_error(found.world.skeleton, found.avatars, avatar, start, end, error)
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
def test_a_step_leads_where_its_trial_was_and_its_tangent_error_is_the_step(seed: int, by: float) -> None:
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


def test_rotations_stay_rotations_and_hinges_within_limits_over_many_steps() -> None:
    found, rng = at_random(1), np.random.default_rng(0)
    limits = found.world.skeleton.limits
    for _ in range(300):
        found.take(found.after(rng.normal(size=len(found.avatars.joint_of))))
        assert (found.world.posture.angle >= limits[:, 0]).all() and (found.world.posture.angle <= limits[:, 1]).all()
    for turn in found.world.posture.turn:
        assert turn.T @ turn == pytest.approx(np.eye(3), abs=1e-15)
