"""A scene as a world and back: the first shown state is the scene's own."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import AvatarsimError
from avatarsim.model.world import build, posture_of, sample_arrays, shown_poses
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from tests.stability.hostile import hinged_avatar, walls
from tests.worlds.little_worlds import random_sample

AVATAR = hinged_avatar()
OFF_CENTRE = (Piece(Box((0.1, 0.2, 0.3)), (0.4, -0.3, 0.2)),)
CRATE = simulated("crate", OFF_CENTRE, "wood", solid(OFF_CENTRE, 1.0), (1.0, 0.5, 2.0), (0.5, 0.5, -0.5, 0.5))


@pytest.mark.parametrize("seed", range(5))
def test_the_first_poses_shown_are_the_scenes_own(seed: int) -> None:
    sample = random_sample((AVATAR,), seed)
    scene = Scene("s", (*walls(), CRATE), (AVATAR,), start=sample)
    positions, orientations = shown_poses(build(scene))
    links, turned = link_poses(scene.avatars, sample)
    assert positions == pytest.approx(np.vstack([[body.position for body in scene.bodies], links]), abs=1e-14)
    wanted = np.vstack([[body.orientation for body in scene.bodies], turned])
    assert np.abs((orientations * wanted).sum(axis=1)) == pytest.approx(np.ones(len(wanted)), abs=1e-14)


def test_simulated_bodies_are_kept_at_their_centre_of_mass() -> None:
    world = build(Scene("s", (CRATE,)))
    centre = np.array(CRATE.position) + rotation.rotate(CRATE.orientation, solid(OFF_CENTRE, 1.0).centre)
    assert world.poses.position[0] == pytest.approx(centre)
    assert world.poses.vertices.mean(axis=0) == pytest.approx(centre)


def test_a_posture_holds_the_samples_numbers() -> None:
    sample = random_sample((AVATAR,), 7)
    world = build(Scene("s", walls(), (AVATAR,)))
    posture = posture_of(world.skeleton, world.hinges, sample)
    assert (posture.angle[world.hinges] == sample.angles).all() and (posture.root == sample.positions).all()
    assert posture.turn == pytest.approx(rotation.to_matrix(sample.rotations), abs=1e-14)


def test_samples_of_any_layout_are_made_fit_for_the_kernels() -> None:
    sample = random_sample((AVATAR,), 1)
    frozen = sample.positions.copy()
    frozen.flags.writeable = False
    odd = replace(
        sample, positions=frozen, rotations=np.asfortranarray(sample.rotations), angles=sample.angles.astype(np.float32)
    )
    for array in sample_arrays(odd):
        assert array.dtype == np.float64 and array.flags.c_contiguous and array.flags.writeable
    assert sample_arrays(sample)[0] is sample.positions


def test_a_pose_that_is_not_finite_is_never_shown() -> None:
    world = build(Scene("s", (CRATE,)))
    world.poses.position[0, 0] = np.nan
    with pytest.raises(AvatarsimError, match="not finite"):
        shown_poses(world)


def test_worlds_of_one_scene_share_nothing_that_is_written() -> None:
    scene = Scene("s", (*walls(), CRATE), (AVATAR,))
    first, second = build(scene), build(scene)
    first.poses.position[:] = 9.0
    first.posture.angle[:] = 9.0
    first.velocities.linear[:] = 9.0
    assert not (second.poses.position == 9.0).all() and not second.posture.angle.any() and not second.velocities.linear.any()
    assert first.velocities.linear.flags.writeable and first.geometry.wanted.family.flags.writeable
