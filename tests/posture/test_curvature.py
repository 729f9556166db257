"""The bound of the Lagrangian's curvature beside second differences of the forces' potential."""

import numpy as np
import pytest

from avatarsim.posture.closeness import gather, note_motions
from avatarsim.posture.curvature import bound_curvature, note_forces
from avatarsim.posture.kinematics import forward
from avatarsim.posture.workspace import COUNT, COUPLED
from tests.posture.test_closeness import Little, stand, towards

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
H = 1e-4


def potential(found: Little, step: np.ndarray, points: np.ndarray, forces: np.ndarray) -> float:
    """- sum F . p after a step, of forces (nl, 3) that stay as they are at points (nl, 3) fixed in the links."""
    geo, skel, posture, poses = found.parts
    trial = found.memory.trial
    forward(geo, skel, posture, step, trial, found.memory.trial_axes)
    places, turns = trial.position[skel.first :], trial.rotation[skel.first :]
    return -float((forces * (places + np.einsum("lij,lj->li", turns, points))).sum())


def second_differences(found: Little, points: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """The Hessian of `potential` at the present posture."""
    nd = len(found.memory.rows.x)
    e = H * np.eye(nd)

    def at(step: np.ndarray) -> float:
        return potential(found, step, points, forces)

    return np.array([
        [(at(e[i] + e[j]) - at(e[i] - e[j]) - at(e[j] - e[i]) + at(-e[i] - e[j])) / (4.0 * H * H) for j in range(nd)]
        for i in range(nd)
    ])


def press(found: Little, link: int, normal: np.ndarray, arm: np.ndarray, push: float) -> None:
    """One pressing row between the first piece of a link and something that is no link."""
    skel, geo, rows = found.world.skeleton, found.world.geometry, found.memory.rows
    k = rows.size[COUNT]
    rows.pair[k] = geo.first_shape[skel.first + link], geo.first_shape[skel.first + link]
    rows.normal[k], rows.arms[k, :3], rows.arms[k, 3:] = normal, arm, 0.0
    rows.multiplier[k], rows.size[COUNT] = push, k + 1


@pytest.mark.parametrize("seed", range(3))
def test_the_bound_is_the_row_sum_of_what_pulls_and_contacts_add_to_the_curvature(seed: int) -> None:
    """A contact whose other side weighs nothing: its arm is zero and its link the same, so that only the first counts."""
    found, rng = towards(seed), np.random.default_rng(seed)
    skel, c = found.world.skeleton, found.memory.goal.closeness
    nl = len(skel.kind)
    turns = found.world.poses.rotation[skel.first :]
    arm, push = rng.normal(0.0, 0.2, 3), rng.normal(0.0, 1.0, 3)
    link = nl - 2
    c.mode[COUPLED] = 1.0
    note_forces(found.world.geometry, skel, found.memory.rows, c)
    assert not c.press.any() and not c.leverage.any()
    press(found, link, push / np.linalg.norm(push), arm, float(np.linalg.norm(push)))
    note_forces(found.world.geometry, skel, found.memory.rows, c)
    # both sides are the same link here: what is left is the couple of the two arms
    assert c.press[link] == pytest.approx(0.0, abs=1e-12) and c.leverage[link] == pytest.approx(np.outer(arm, push))
    c.press[link] += push
    gather(skel, c)
    note_motions(skel, found.memory.axes, c)
    bound_curvature(skel, found.memory.axes, c)
    stand(found)
    pulls = c.there - c.here
    whole = second_differences(found, np.zeros((nl, 3)), pulls)
    point = np.zeros((nl, 3))
    point[link] = turns[link].T @ arm
    forces = np.zeros((nl, 3))
    forces[link] = push
    whole += second_differences(found, point, forces)
    assert c.curvature == pytest.approx(np.abs(whole).sum(axis=1), abs=1e-4)
