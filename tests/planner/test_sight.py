"""Sight: the straight motion between two postures is certified, or is not, and what moves meanwhile is not misled by the look."""

import pytest

from avatarsim.ik.make import make_solver
from avatarsim.ik.solve import activate
from avatarsim.model.world import build
from avatarsim.planner.follow_path import is_in_sight
from avatarsim.scene.avatar import Avatar
from avatarsim.settings import PostureSettings
from tests.planner.scenes import behind_the_wall, palm, walker

pytestmark = pytest.mark.nojit


@pytest.mark.parametrize("avatar", [walker(), palm()])
@pytest.mark.parametrize(("way", "sees"), [((0.2, 0.0, 0.0), True), ((1.4, 0.0, 0.0), False), ((0.0, 1.5, 0.0), True)])
def test_a_posture_behind_a_wall_is_out_of_sight(avatar: Avatar, way: tuple[float, float, float], sees: bool) -> None:
    scene, _ = behind_the_wall(avatar)
    world = build(scene)
    avatars, state, scratch = make_solver(world.geometry, world.skeleton, world.posture, world.poses)
    scratch.target.root[:], scratch.target.turn[:], scratch.target.angle[:] = world.posture
    scratch.target.root[0] += way
    activate(0, 1, scratch)
    for work, expected in ((1200, sees), (0, False)):
        settings = PostureSettings(work=work)
        found = is_in_sight(
            world.geometry, world.skeleton, avatars, settings, 0, world.posture, world.poses, state, scratch
        )
        assert found == expected
