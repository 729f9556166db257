"""Clips that are in the room in every frame: reported, and moved no farther than a constant lift that frees them."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.assets.models.load import load_avatar
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.load import load_motion
from avatarsim.cleaning import Options, audit, clean
from avatarsim.cleaning.ground import ground_of, raised
from avatarsim.cleaning.whole_clip import chords_of
from avatarsim.scene.motion import Motion
from scenarios.data_folder import data_file
from tests.cleaning.rooms import FLOOR, lowered, model, part, swinging

OPTIONS = Options(opinion=False)


def walk(height: float) -> tuple[Model, Motion]:
    human = load_avatar(data_file("humanoid/humanoid.urdf"), scale=0.25)
    motion = load_motion(data_file("data/motions/humanoid3d_walk.txt")).motion(human)
    return human, lowered(motion, np.full(len(motion), height))


@pytest.mark.parametrize("depth", [0.02, 0.25])
def test_no_link_of_a_sunken_walk_moves_farther_than_its_lift(depth: float) -> None:
    human, motion = walk(-depth)
    cleaned = clean(motion, human, (FLOOR,), OPTIONS)
    chords, whole = chords_of(motion, human, (FLOOR,), OPTIONS, ())
    lift = ground_of(chords, whole, OPTIONS.margin).free
    assert cleaned.after.is_clean and cleaned.moved.link_most.max() <= lift * (1.0 + 1e-9)
    assert cleaned.before.overlapping == len(motion) and cleaned.before.notes
    assert cleaned.after.foot_slide <= cleaned.before.foot_slide + 0.01


def test_the_lifts_take_each_frame_out_and_no_higher() -> None:
    motion = lowered(swinging(30, 0.5), -np.linspace(0.0, 0.3, 30))
    chords, motion = chords_of(motion, model(), (FLOOR,), OPTIONS, ())
    ground = ground_of(chords, motion, 1e-3)
    assert not ground.is_off and ground.lifts[0] == 0.0
    for share, is_free in ((1.0, True), (0.98, False)):
        gaps = [chords.nearest(raised(motion, chords, share * ground.lifts).sample(k), 1e-3)[0] for k in range(20, 30)]
        assert all((gap >= 1e-3 - 1e-6) == is_free for gap in gaps)
    off = ground_of(chords, lowered(motion, np.full(30, -0.3)), 1e-3)
    assert off.is_off and off.free == pytest.approx(ground.free + 0.3) and off.lifts.min() <= off.usual <= off.free


def test_one_free_frame_and_no_room_are_no_ground_that_is_off() -> None:
    motion = swinging(30, 0.2)
    assert audit(motion, model(), (FLOOR,), OPTIONS).notes and not audit(motion, model(), (), OPTIONS).notes
    heights = np.zeros(30)
    heights[7] = 1.0
    assert not audit(lowered(motion, heights), model(), (FLOOR,), OPTIONS).notes


def test_the_user_may_keep_a_clip_where_it_is() -> None:
    human, motion = walk(-0.02)
    higher, as_it_is = (clean(motion, human, (FLOOR,), replace(OPTIONS, ground=ground)) for ground in (True, False))
    rises = [np.median((one.motion.positions - motion.positions)[:, 0, 2]) for one in (higher, as_it_is)]
    assert as_it_is.after.is_clean and rises[0] > 0.01 and as_it_is.before.notes


def test_the_verdict_on_a_frame_is_the_same_in_each_cut() -> None:
    human, motion = walk(-0.004)
    whole = clean(motion, human, (FLOOR,), OPTIONS)
    for first, end in ((0, 12), (9, 30), (25, 39)):
        some = slice(first, end)
        cut = clean(part(motion, first, end), human, (FLOOR,), OPTIONS)
        assert np.array_equal(cut.held, whole.held[some]) and np.array_equal(cut.before.depths, whole.before.depths[some])
        assert np.array_equal(cut.before.proven, whole.before.proven[first : end - 1])
