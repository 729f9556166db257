"""Planted feet stay where the recording has them, also where the floor pushes them up."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.assets.models.load import load_avatar
from avatarsim.assets.motions.load import load_motion
from avatarsim.cleaning import Options, clean
from avatarsim.cleaning.foot_contact import planted_feet
from avatarsim.cleaning.measures import high, jerk
from avatarsim.cleaning.planting import Planting, smooth_lift
from avatarsim.cleaning.whole_clip import chords_of
from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput
from avatarsim.simulator import AvatarsimEngine
from scenarios.data_folder import data_file
from tests.cleaning.rooms import FLOOR, lowered, model, swinging

OPTIONS = Options(opinion=False)


@pytest.mark.parametrize("name", ["cartwheel", "dance_a", "spinkick", "roll", "walk"])
def test_planted_feet_slide_no_more_than_in_the_recording(name: str) -> None:
    human = load_avatar(data_file("humanoid/humanoid.urdf"), scale=0.25)
    motion = load_motion(data_file(f"data/motions/humanoid3d_{name}.txt")).motion(human)
    cleaned = clean(motion, human, (FLOOR,), OPTIONS)
    before, after = cleaned.before.foot_slide, cleaned.after.foot_slide
    assert cleaned.after.is_clean and after <= max(1.1 * before, before + 0.01)
    chords, motion = chords_of(motion, human, (FLOOR,), OPTIONS, ())
    assert high(jerk(chords, cleaned.motion)) <= 1.1 * high(jerk(chords, motion))
    kept = ~cleaned.changed
    assert kept.any() or cleaned.held.all()
    for name in ("positions", "rotations", "angles"):
        assert np.array_equal(getattr(motion, name)[kept], getattr(cleaned.motion, name)[kept])


def test_the_lift_is_smooth_and_near_what_is_needed() -> None:
    needed, known, is_free = np.full(60, 0.02), np.ones(60, dtype=bool), np.zeros(60, dtype=bool)
    assert smooth_lift(needed, known, is_free, 1.5) == pytest.approx(needed, abs=1e-12)
    is_free[:10], known[30:40] = True, False
    lift = smooth_lift(needed, known, is_free, 1.5)
    assert np.all(lift[:10] == 0.0) and lift[20:28] == pytest.approx(0.02, abs=1e-3) and lift.max() < 0.025
    step = np.where(is_free, 0.0, needed)
    assert np.abs(np.diff(lift, 3)).max() < np.abs(np.diff(step, 3)).max()
    for frames in (1, 2, 3, 4):
        every, none = np.ones(frames, dtype=bool), np.zeros(frames, dtype=bool)
        assert smooth_lift(np.full(frames, 0.01), every, none, 1.2) == pytest.approx(0.01)


def test_planted_links_weigh_more_and_feet_in_the_air_do_not() -> None:
    def planting(height: float) -> Planting:
        chords, motion = chords_of(lowered(swinging(40, 0.37, swing=0.0), np.full(40, height)), model(), (FLOOR,), OPTIONS, ())
        return Planting(chords, motion, np.zeros(40, dtype=bool), OPTIONS, planted_feet(chords, motion))

    weights = planting(0.0).weights()
    assert weights is not None and weights.at(0.0).tolist() == [1.0, 10.0, 10.0]
    assert planting(0.5).weights() is None and len(list(planting(0.5).aims())) == 1


def test_a_link_that_weighs_more_stays_nearer_to_its_target() -> None:
    chords, _ = chords_of(swinging(2, 0.6), model(), (FLOOR,), OPTIONS, ())
    start, target = (swinging(2, height, swing=0.1).sample(1) for height in (0.6, 0.3))
    offs = []
    for weight in (1.0, 30.0):
        with AvatarsimEngine() as engine:
            engine.load(replace(chords.scene, start=start), Settings(), 1.0 / 60.0)
            engine.weigh_links(np.array([weight, 1.0, 1.0]))
            for _ in range(120):
                engine.advance(target, 1.0 / 60.0)
            offs.append(abs(float(engine.posture().positions[0, 2]) - 0.3))
            for wrong in (np.ones(2), np.array([1.0, 0.0, 1.0]), np.full(3, np.nan)):
                with pytest.raises(InvalidInput):
                    engine.weigh_links(wrong)
    assert offs[1] < 0.7 * offs[0]
