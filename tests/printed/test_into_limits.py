"""Postures made by interpolation come back inside their limits, and those inside stay as they are."""

import numpy as np

from avatarsim.model.joint_limits import cone_excess
from avatarsim.paper.walk_back import into_limits
from avatarsim.spatial import rotation
from avatarsim.spatial.tangent import columns
from tests.worlds.arms import arm, limited_ball, planar, world_of


def test_everything_ends_inside_and_what_was_inside_is_not_touched():
    world = world_of((arm((0.4, 0.3), [limited_ball(), planar((-0.5, 2.0))[0]]),))
    rng, kept = np.random.default_rng(3), 0
    for _ in range(500):
        world.posture.turn[0] = rotation.to_matrix(rotation.from_rotation_vector(rng.normal(size=3)))
        world.posture.angle[:] = rng.normal(size=4)
        before = [world.posture.turn[0].copy(), world.posture.angle.copy()]
        was_inside = cone_excess(world.skeleton, 0, columns(world.posture.turn, 0)) < -1e-6
        into_limits(world.skeleton, world.posture)
        assert cone_excess(world.skeleton, 0, columns(world.posture.turn, 0)) <= 0.0
        assert -0.5 <= world.posture.angle[3] <= 2.0
        if was_inside:
            kept += 1
            assert (world.posture.turn[0] == before[0]).all()
        if -0.5 <= before[1][3] <= 2.0:
            assert world.posture.angle[3] == before[1][3]
    assert 50 < kept < 450
