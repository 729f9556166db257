"""One link after the other gives what the kinematics of the whole avatar gives."""

import numpy as np

from avatarsim.model.geometry import Poses
from avatarsim.model.skeleton import forward
from avatarsim.paper.ccd_ik import pose_link
from avatarsim.spatial import rotation
from tests.worlds.arms import arm, ball_hand, limited_ball, planar, three_axes, world_of


def test_it_agrees_with_the_kinematics_for_every_kind_of_joint():
    lengths = (0.4, 0.3, 0.2)
    avatars = (ball_hand(0.1), arm(lengths, [limited_ball(), three_axes(2.0), planar((-1.0, 2.0))[0]], at=(2.0, 1.0, 0.5)))
    world = world_of(avatars)
    skel, rng = world.skeleton, np.random.default_rng(2)
    nd = int(skel.first_dof[-1])
    whole, single = np.zeros((nd, 3)), np.zeros((nd, 3))
    other = Poses(*(array.copy() for array in world.poses))
    for _ in range(20):
        world.posture.root[0] = rng.normal(size=3)
        world.posture.angle[:] = rng.uniform(-1.0, 1.0, nd)
        world.posture.turn[:] = rotation.to_matrix(rotation.normalised(rng.normal(size=(len(skel.kind), 4))))
        forward(world.geometry, skel, world.posture, np.zeros(nd), world.poses, whole)
        for link in range(len(skel.kind)):
            pose_link(skel, world.posture, link, other, single)
        np.testing.assert_allclose(other.position, world.poses.position, atol=1e-14)
        np.testing.assert_allclose(other.rotation, world.poses.rotation, atol=1e-14)
        # a free root's own degrees of freedom are no joints
        np.testing.assert_allclose(single[6:], whole[6:], atol=1e-14)
