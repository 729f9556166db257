"""How a scene may begin: nothing overlaps and nothing is beyond its limits, or the door says what."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import InvalidScene, StartOverlaps
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import rest
from avatarsim.simulator import AvatarsimEngine
from tests.stability.hostile import DT
from tests.worlds.little_worlds import hand
from tests.worlds.loaded import loaded

BALL = (Piece(Sphere(0.1)),)


def test_an_overlapping_start_names_its_pairs_deepest_first() -> None:
    box = fixed("box", (Piece(Box((0.2, 0.2, 0.2))),), "wood", (0.12, 0.0, 0.0))
    near = fixed("near", (Piece(Sphere(0.1)),), "wood", (0.0, 0.16, 0.0))
    far = fixed("far", (Piece(Sphere(0.1)),), "wood", (0.0, 0.0, 5.0))
    scene = Scene("s", (far, box, near), (hand((Piece(Sphere(0.08)),)),))
    with pytest.raises(StartOverlaps) as error:
        AvatarsimEngine().load(scene, Settings(), DT)
    assert [pair[:2] for pair in error.value.pairs] == [("box", "hand"), ("near", "hand")]
    assert [pair[2] for pair in error.value.pairs] == pytest.approx([0.06, 0.02])
    assert "box in hand by 60 mm" in str(error.value) and "far" not in str(error.value)


def test_many_overlaps_are_counted_not_listed() -> None:
    crowd = tuple(fixed(f"f{k}", BALL, "wood", (0.01 * k, 0.0, 0.0)) for k in range(12))
    with pytest.raises(StartOverlaps, match="and 4 more"):
        AvatarsimEngine().load(Scene("s", crowd, (hand(),)), Settings(), DT)


def test_pairs_that_are_left_out_may_overlap_at_the_start() -> None:
    inside = fixed("box", (Piece(Box((0.2, 0.2, 0.2))),), "wood")
    engine = loaded(Scene("s", (inside,), (hand(),), exclude=(("box", "hand"),)))
    assert engine.advance(rest((hand(),)), DT).shown.positions.shape == (2, 3)


def test_a_start_beyond_a_hinge_limit_is_refused_by_name() -> None:
    limb = Link("limb", "root", Hinges((Hinge((1.0, 0.0, 0.0), 0.2, 1.0),)), BALL, solid(BALL, 1.0), anchor=(0.0, 0.0, 0.5))
    avatar = Avatar("a", (Link("root", None, Free(), BALL, solid(BALL, 1.0)), limb))
    start = replace(rest((avatar,)), angles=np.array([1.5]))
    with pytest.raises(InvalidScene, match=r"start angle of a hinge of limb \[rad\] is 1.5; valid: 0.2 to 1"):
        AvatarsimEngine().load(Scene("s", avatars=(avatar,), start=start), Settings(), DT)


def test_a_start_beyond_a_swing_limit_is_refused_by_name() -> None:
    limits = SwingTwist((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), 0.5, (-0.5, 0.5))
    limb = Link("limb", "root", Ball(limits), BALL, solid(BALL, 1.0), anchor=(0.0, 0.0, 0.5))
    avatar = Avatar("a", (Link("root", None, Free(), BALL, solid(BALL, 1.0)), limb))
    turned = np.array([[1.0, 0.0, 0.0, 0.0], [np.cos(0.4), np.sin(0.4), 0.0, 0.0]])
    with pytest.raises(InvalidScene, match="start rotation of limb beyond its swing and twist limits .* is 0.3"):
        AvatarsimEngine().load(Scene("s", avatars=(avatar,), start=replace(rest((avatar,)), rotations=turned)), Settings(), DT)
