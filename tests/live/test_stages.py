"""Built-in stages: free, loadable, and with handles on the links to drag."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import UnknownName
from avatarsim.live.drive.driver import Driver
from avatarsim.live.stages import HAND_MASS, NAMES, STATURE, Stage, hand, stage
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Role, fixed, solid
from avatarsim.scene.joint import Ball, Free, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, ConvexHull, Piece, Sphere
from avatarsim.scene.tracker import link_poses
from avatarsim.simulator import AvatarsimEngine

BALL = (Piece(Sphere(0.1)),)


@pytest.mark.parametrize("name", NAMES)
def test_a_stage_loads_free_of_overlap_and_rests(name: str) -> None:
    scene, engine = stage(name).scene, AvatarsimEngine()
    first = engine.load(scene, Settings(), 1.0 / 60.0).shown.positions
    for _ in range(120):
        record = engine.advance(scene.first_sample, 1.0 / 60.0)
    assert np.abs(record.shown.positions - first).max() < 2e-3
    assert not record.statuses


@pytest.mark.parametrize("name", NAMES)
def test_a_stage_is_of_primitives_and_loose_bodies(name: str) -> None:
    one = stage(name)
    pieces = [piece for body in one.scene.bodies for piece in body.pieces] + [p for link in one.scene.links for p in link.pieces]
    assert not any(isinstance(piece.shape, ConvexHull) for piece in pieces)
    assert sum(body.role is Role.SIMULATED for body in one.scene.bodies) >= 3
    assert set(one.handles) <= set(one.scene.names)
    assert stage(name) is one


def test_the_hand_is_an_adults() -> None:
    avatar = hand()
    assert 15 <= len(avatar.links) <= 20
    assert isinstance(avatar.links[0].joint, Free)
    assert all(isinstance(link.joint, Hinges) for link in avatar.links[1:])
    assert sum(link.mass.mass for link in avatar.links) == pytest.approx(HAND_MASS)
    scene = stage("hand").scene
    places, _ = link_poses(scene.avatars, scene.first_sample)
    palm = 0.5 * 0.094
    # wrist to the tip of the middle finger
    assert 0.17 < places[:, 0].max() - places[0, 0] + 0.018 + palm < 0.21


def test_the_human_stands_on_the_floor_with_its_arms_down() -> None:
    scene = stage("gallery").scene
    names = [link.name for link in scene.links]
    places, _ = link_poses(scene.avatars, scene.first_sample)
    assert places[names.index("head"), 2] == pytest.approx(0.9 * STATURE, abs=0.12)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        hand_at, shoulder = places[names.index(f"{side}_hand")], places[names.index(f"{side}_shoulder")]
        assert hand_at[2] < shoulder[2] - 0.4
        assert sign * hand_at[1] > sign * shoulder[1] > 0.0
    assert all(isinstance(link.joint, Ball) and link.joint.limits for link in scene.links[1:] if "collar" not in link.name)


def test_an_avatar_of_ones_own_can_be_driven() -> None:
    stick = rigid_avatar("stick", BALL, solid(BALL, 1.0))
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "wood", (0.0, 0.0, -0.3))
    own = Stage(Scene("own", (floor,), (stick,)))
    assert own.handles == ("stick",)
    one = Driver(own.scene)
    one.drag("stick", (0.0, 0.0, 0.2))
    for _ in range(30):
        sample = one.tick(1.0 / 60.0)
    assert sample.positions[0] == pytest.approx((0.0, 0.0, 0.2))


def test_an_unknown_stage_is_named_with_those_that_are() -> None:
    with pytest.raises(UnknownName, match="gallery, hand"):
        stage("opera")
