"""Weights of degrees: means of what vertices move by, by finite differences of the forward kinematics."""

import numpy as np

from avatarsim.coupling.reaction import LEAST, ROOT, joint_weights
from avatarsim.model.skeleton import FREE, forward
from avatarsim.scene.scene import Scene
from tests.worlds.little_worlds import little, mixed_avatar


def test_weights_are_mean_squared_motions_of_vertices_with_a_floor_and_a_factor_for_roots() -> None:
    found = little(Scene("s", (), (mixed_avatar(),)))
    geo, skel, posture, poses = found.parts
    weights = joint_weights(geo, skel, poses, found.axes)
    slow, before, small = np.zeros(len(weights)), poses.vertices.copy(), 1e-7
    for j in range(len(weights)):
        forward(geo, skel, posture, small * np.eye(len(weights))[j], poses, found.axes)
        moved = ((poses.vertices - before) / small) ** 2
        for link in range(len(skel.kind)):
            low, high = (geo.shapes.start[geo.first_shape[skel.first + link + k]] for k in range(2))
            if high > low and skel.related[link, np.searchsorted(skel.first_dof, j, "right") - 1]:
                turns = not (skel.kind[0] == FREE and j < 3)
                slow[j] += moved[low:high].sum(axis=1).mean() + (1e-4 if turns else 0.0)
    root = np.arange(len(weights)) < skel.first_dof[1]
    slow = np.maximum(slow / np.median(slow[~root]), LEAST) * np.where(root, ROOT, 1.0)
    np.testing.assert_allclose(weights, slow, rtol=1e-5)
