"""Forward kinematics against its plain twin, world axes against finite differences."""

from typing import TypeVar

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.model.geometry import Poses
from avatarsim.model.skeleton import FREE, SLIDE, Posture, displace, forward
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from tests.stability.hostile import hinged_avatar, walls
from tests.worlds.little_worlds import Little, hand, little, random_sample, sliding_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
AVATARS = (sliding_avatar(), hand(), hinged_avatar())


def random_world(seed: int) -> Little:
    """Return three avatars behind six bodies in a random posture."""
    return little(Scene("s", walls(), AVATARS, start=random_sample(AVATARS, seed)))


Arrays = TypeVar("Arrays", Posture, Poses)


def copied(arrays: Arrays) -> Arrays:
    """Return arrays of their own."""
    return type(arrays)(*(array.copy() for array in arrays))


@pytest.mark.parametrize("seed", range(4))
def test_poses_agree_with_the_plain_twin(seed: int) -> None:
    found = random_world(seed)
    positions, orientations = link_poses(AVATARS, random_sample(AVATARS, seed))
    poses, first = found.world.poses, found.world.skeleton.first
    assert poses.position[first:] == pytest.approx(positions, abs=1e-13)
    assert poses.rotation[first:] == pytest.approx(rotation.to_matrix(orientations), abs=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_axes_are_how_points_move(seed: int) -> None:
    """Every degree of freedom in turn: a point of every link moves by axis x arm, or along the axis of a root."""
    found = random_world(seed)
    geo, skel, posture, poses = found.parts
    trial, axes, step = copied(poses), found.axes.copy(), np.zeros(skel.first_dof[-1])
    h, first, nl = 1e-6, skel.first, len(skel.kind)
    owner = np.repeat(np.arange(nl), np.diff(skel.first_dof))
    rows = [geo.shapes.start[geo.first_shape[first + link]] for link in range(nl)]
    for j in range(len(step)):
        moved = []
        for sign in (1.0, -1.0):
            step[:] = 0.0
            step[j] = sign * h
            forward(geo, skel, posture, step, trial, axes)
            moved.append(trial.vertices[rows].copy())
        rate = (moved[0] - moved[1]) / (2.0 * h)
        m = owner[j]
        for link in range(nl):
            if not skel.related[link, m]:
                wanted = np.zeros(3)
            elif skel.kind[m] == FREE and j < skel.first_dof[m] + 3:
                wanted = np.eye(3)[j - skel.first_dof[m]]
            elif skel.kind[m] == SLIDE:
                wanted = found.axes[j]
            else:
                wanted = np.cross(found.axes[j], poses.vertices[rows[link]] - poses.position[first + m])
            assert rate[link] == pytest.approx(wanted, abs=1e-7)


@pytest.mark.parametrize("seed", range(3))
def test_taking_a_step_leads_where_the_trial_was(seed: int) -> None:
    found = random_world(seed)
    geo, skel, posture, poses = found.parts
    trial, axes = copied(poses), found.axes.copy()
    step = np.random.default_rng(seed).normal(size=skel.first_dof[-1])
    forward(geo, skel, posture, step, trial, axes)
    tried, tried_axes = trial.vertices.copy(), axes.copy()
    taken = copied(posture)
    displace(skel, taken, step)
    step[:] = 0.0
    forward(geo, skel, taken, step, trial, axes)
    assert trial.vertices == pytest.approx(tried, abs=1e-13)
    assert axes == pytest.approx(tried_axes, abs=1e-13)


def test_rotations_stay_rotations_over_many_steps() -> None:
    found = random_world(1)
    skel, posture = found.world.skeleton, copied(found.world.posture)
    rng = np.random.default_rng(0)
    for _ in range(500):
        displace(skel, posture, rng.normal(size=skel.first_dof[-1]))
    for turn in posture.turn[[0, 1, 5, 6]]:
        assert turn.T @ turn == pytest.approx(np.eye(3), abs=1e-15)


def test_a_step_of_a_ball_is_in_the_links_own_axes() -> None:
    found = random_world(2)
    geo, skel, posture, poses = found.parts
    step = np.zeros(skel.first_dof[-1])
    step[6:9] = (0.3, -0.2, 0.5)
    trial = copied(poses)
    forward(geo, skel, posture, step, trial, found.axes)
    wanted = poses.rotation[skel.first + 1] @ Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
    assert trial.rotation[skel.first + 1] == pytest.approx(wanted, abs=1e-14)
