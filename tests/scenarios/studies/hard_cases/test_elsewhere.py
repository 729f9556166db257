"""A transformed world is equivalent: the inverse transform restores it, and every verdict on it is equal."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import InvalidScene
from avatarsim.scene.joint import Rigid
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from scenarios import catalog
from scenarios.studies.hard_cases.elsewhere import Elsewhere
from tests.scenarios.examples import arm_scene, recorded
from tests.scenarios.scene_rules import first_poses

TURN = tuple(rotation.from_axis_angle((0.6, 0.0, 0.8), 1.1).tolist())
PLACES = [Elsewhere(1e3), Elsewhere(1e-3), Elsewhere(1.0, TURN), Elsewhere(2.0, TURN, (10.0, -20.0, 5.0))]
NAMES = ["stack_ten", "hand_in_bowl", "arms_through_chest", "non_convex", "coincident_centres"]


@pytest.mark.parametrize("there", PLACES)
@pytest.mark.parametrize("name", NAMES)
def test_first_poses_are_those_of_here_sent_there(name: str, there: Elsewhere) -> None:
    scene = catalog.get(name).build()
    (here, turns), (places, orientations) = first_poses(scene), first_poses(there.scene(scene))
    assert np.allclose(places, there.place(here), atol=1e-12 * there.scale + 1e-14 * np.abs(places).max())
    assert np.allclose(np.abs(np.sum(orientations * there.turned(turns), axis=-1)), 1.0, atol=1e-12)


@pytest.mark.parametrize("there", PLACES)
def test_depths_grow_with_the_world_and_with_nothing_else(there: Elsewhere) -> None:
    """Two coincident boxes, balls, hulls, ellipsoids, capsules: the depth is equal, times the scale."""
    scene = catalog.get("coincident_start").build()
    here = {pair[:2]: pair[2] for pair in Judge(scene).overlaps(*first_poses(scene)).pairs}
    moved = there.scene(scene)
    for a, b, depth in Judge(moved).overlaps(*first_poses(moved)).pairs:
        assert depth == pytest.approx(there.scale * here[a, b], rel=1e-6)
    assert len(here) == 5


@pytest.mark.parametrize("there", PLACES)
def test_a_recording_comes_back_as_it_was(there: Elsewhere) -> None:
    scene = arm_scene()
    sample = scene.first_sample
    plain = recorded(scene, [sample, replace(sample, positions=sample.positions + 0.1)])
    away = recorded(there.scene(scene), [there.sample(sample, scene.avatars)] * 2)
    away = replace(
        away, positions=there.place(plain.positions), orientations=there.turned(plain.orientations),
        velocities=there.along(plain.positions), angular_velocities=there.along(plain.positions) / there.scale,
    )
    back = there.back(away)
    assert np.allclose(back.positions, plain.positions, atol=1e-9)
    assert np.allclose(back.velocities, plain.positions, atol=1e-9)
    assert np.allclose(back.angular_velocities, plain.positions, atol=1e-9)
    assert np.allclose(np.abs(np.sum(back.orientations * plain.orientations, axis=-1)), 1.0, atol=1e-12)
    assert np.allclose(back.raw_positions[0], plain.raw_positions[0], atol=1e-9)


def test_here_not_one_bit_changes() -> None:
    scene = arm_scene()
    plain = recorded(scene, [scene.first_sample])
    assert Elsewhere().scene(scene) is scene and Elsewhere().back(plain) is plain


def test_a_root_that_is_not_free_stays() -> None:
    scene = arm_scene()
    links = (replace(scene.avatars[0].links[0], joint=Rigid()), *scene.avatars[0].links[1:])
    with pytest.raises(InvalidScene, match="root"):
        Elsewhere(2.0).avatar(replace(scene.avatars[0], links=links))
