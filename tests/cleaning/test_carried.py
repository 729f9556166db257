"""Cleaning against bodies that are carried: their poses stay, limbs give way, and ways are proved with both in motion."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.cleaning import Carried, Options, audit, clean
from avatarsim.errors import InvalidInput
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import solid
from avatarsim.scene.carried import joined
from avatarsim.scene.motion import Motion
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.spatial import rotation
from benchmarks.cleaning import between, depths
from reference.judging.judge import Judge
from tests.cleaning.rooms import FLOOR, model, swinging, walker

OPTIONS = Options(opinion=False)
CUBE = (Piece(Box((0.3, 0.3, 0.3))),)


def carried(motion: Motion, x: np.ndarray | float, turn: np.ndarray | float = 0.0) -> Carried:
    """Return a cube next to the right leg of the walker, at x (F,) [m], turned about the vertical by (F,) [rad]."""
    frames = len(motion)
    positions = np.stack([np.broadcast_to(value, frames) for value in (x, -0.12, 0.3)], axis=1)[:, None]
    turns = rotation.from_axis_angle((0.0, 0.0, 1.0), np.broadcast_to(turn, frames).astype(np.float64))[:, None]
    return Carried(moving("cube", CUBE, "wood"), Motion(motion.times, positions, turns, np.zeros((frames, 0))))


@pytest.mark.parametrize(("x", "turn"), [
    (0.35, 0.0), (np.linspace(1.0, 0.2, 60), 0.0), (np.linspace(0.45, 0.3, 60), np.linspace(0.0, 1.5, 60)),
])
def test_limbs_give_way_to_a_box_that_comes(x: np.ndarray | float, turn: np.ndarray | float) -> None:
    motion = swinging(60, 0.5)
    box = carried(motion, x, turn)
    cleaned = clean(motion, model(), (FLOOR,), OPTIONS, carried=(box,))
    assert cleaned.before.overlapping > 2 and cleaned.after.is_clean
    assert cleaned.motion.positions.shape == motion.positions.shape
    # the judge shares no code with the proof; it knows the cube as another avatar
    judge = Judge(Scene("judged", (replace(FLOOR, material="wood"),), (walker(), replace(box.body, moves=False))))
    whole = joined(cleaned.motion, (box,))
    assert depths(judge, whole).max() <= 1e-6 and depths(judge, between(whole)).max() <= 1e-6


def test_a_box_far_away_changes_nothing() -> None:
    motion = swinging(40, 1.0)
    cleaned = clean(motion, model(), (FLOOR,), OPTIONS, carried=(carried(motion, 5.0),))
    assert not cleaned.changed.any() and np.array_equal(cleaned.motion.rotations, motion.rotations)


def test_a_box_that_sweeps_through_is_flagged() -> None:
    motion = swinging(30, 0.5)
    box = carried(motion, np.linspace(2.0, -2.0, 30), np.linspace(0.0, 9.0, 30))
    cleaned = clean(motion, model(), (), OPTIONS, carried=(box,))
    assert cleaned.after.overlapping == 0
    assert cleaned.after.unproven == 0 or any(one.why == "pushed" for one in cleaned.flagged)


def test_an_audit_tells_a_box_in_motion_from_one_that_stands() -> None:
    motion = swinging(30, 1.0)
    # next to the leg in all frames, through it between two
    jumps = np.where(np.arange(30) < 15, 0.8, -0.8)
    box = carried(motion, jumps)
    box = replace(box, motion=replace(box.motion, positions=box.motion.positions + np.array([0.0, 0.0, 0.5])))
    found = audit(motion, model(), (), OPTIONS, (box,))
    assert found.overlapping == 0 and found.unproven == 1 and not found.is_clean


def test_poses_at_other_times_and_other_bodies_are_refused() -> None:
    motion = swinging(10, 1.0)
    box = carried(motion, 1.0)
    with pytest.raises(InvalidInput, match="times of cube"):
        clean(motion, model(), carried=(carried(swinging(11, 1.0), 1.0),))
    with pytest.raises(InvalidInput, match="carried body"):
        Carried(rigid_avatar("hand", CUBE, solid(CUBE, 1.0)), box.motion)
    with pytest.raises(InvalidInput, match="shapes of the motion"):
        Carried(box.body, motion)
    with pytest.raises(InvalidInput, match="what is carried"):
        audit(motion, model(), (), OPTIONS, (box.body,))  # type: ignore[arg-type]
