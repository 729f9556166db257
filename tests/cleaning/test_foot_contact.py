"""Feet that are planted, and how far they slide."""

import numpy as np
import pytest

from avatarsim.cleaning import Options, audit
from avatarsim.cleaning.foot_contact import planted_feet, slip_speeds
from avatarsim.cleaning.whole_clip import chords_of
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation
from tests.cleaning.rooms import FLOOR, RATE, lowered, model, part, swinging

OPTIONS = Options(opinion=False)
SOLE = 0.38
"""Height [m] of the walker's trunk at which its legs, hanging down, touch the floor."""


def standing(frames: int = 30, slide: float = 0.0, height: float = 0.0) -> Motion:
    """Return the walker with its legs down, its soles at a height [m] above the floor, sliding at a speed [m/s]."""
    return swinging(frames, SOLE + height, slide * (frames - 1) / RATE, swing=0.0)


@pytest.mark.parametrize("speed", [0.0, 0.1, 0.2])
def test_the_speed_of_feet_that_slide_is_measured(speed: float) -> None:
    assert audit(standing(slide=speed), model(), (FLOOR,), OPTIONS).foot_slide == pytest.approx(speed, abs=1e-9)


def test_high_or_fast_feet_are_not_planted() -> None:
    """Without a room there are none."""
    for motion in (standing(height=0.1), standing(slide=1.0)):
        assert np.isnan(audit(motion, model(), (FLOOR,), OPTIONS).foot_slide)
    assert np.isnan(audit(standing(), model(), (), OPTIONS).foot_slide)


def test_a_foot_that_rolls_over_its_round_end_does_not_slip() -> None:
    frames, radius = 31, 0.03
    motion = standing(frames)
    turned = np.linspace(-0.3, 0.3, frames)
    positions, rotations = motion.positions.copy(), motion.rotations.copy()
    # the centre of the round end goes along by radius times the angle, and the hip above it
    positions[:, 0, 0], positions[:, 0, 2] = radius * turned + 0.35 * np.sin(turned), radius + 0.35 * np.cos(turned)
    rotations[:, 1] = rotation.from_axis_angle((0.0, 1.0, 0.0), turned)
    rolling = Motion(motion.times, positions, rotations, turned[:, None])
    chords, motion = chords_of(rolling, model(), (FLOOR,), OPTIONS, ())
    assert planted_feet(chords, motion).all() and slip_speeds(chords, motion).max() < 1e-3


def test_where_a_clip_is_cut_changes_no_answer() -> None:
    motion = lowered(swinging(60, 0.41, 0.5, 0.1), 0.03 * np.sin(np.arange(60) / 3.0))
    chords, _ = chords_of(motion, model(), (FLOOR,), OPTIONS, ())
    whole = planted_feet(chords, motion)
    assert whole.any() and not whole.all()
    for first, end in ((0, 20), (7, 31), (30, 60)):
        assert np.array_equal(planted_feet(chords, part(motion, first, end)), whole[first : end - 1])
