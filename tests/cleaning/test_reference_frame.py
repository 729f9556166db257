"""A T-pose in frame 0 is left out of cleaning, stays to the bit, and is reported."""

from dataclasses import replace

import numpy as np

from avatarsim.cleaning import Options, audit, clean
from avatarsim.scene.motion import Motion
from tests.cleaning.rooms import FLOOR, RATE, dipping, lowered, model, swinging

OPTIONS = Options(opinion=False)


def with_reference(motion: Motion, place: float) -> Motion:
    """Return the motion with a posture before it whose legs are spread, at a place [m] to the side."""
    first = lowered(swinging(1, 0.9, swing=0.0), np.zeros(1))
    first = replace(first, positions=first.positions + np.array([0.0, place, 0.0]), angles=first.angles + 1.0)
    parts = (np.concatenate([getattr(one, name) for one in (first, motion)]) for name in ("positions", "rotations", "angles"))
    return Motion(np.arange(len(motion) + 1) / RATE, *parts)


def test_a_reference_posture_changes_nothing_and_stays() -> None:
    plain, motion = clean(dipping(60, 20), model(), (FLOOR,), OPTIONS), with_reference(dipping(60, 20), 2.0)
    cleaned = clean(motion, model(), (FLOOR,), OPTIONS)
    assert len(cleaned.motion) == 61 and cleaned.after.is_clean and cleaned.before.notes
    for name in ("positions", "rotations", "angles"):
        assert np.array_equal(getattr(cleaned.motion, name)[0], getattr(motion, name)[0])
        assert np.allclose(getattr(cleaned.motion, name)[1:], getattr(plain.motion, name), rtol=0.0, atol=1e-9)
    assert np.array_equal(cleaned.changed[1:], plain.changed) and not cleaned.changed[0]
    assert [(run.first - 1, run.last - 1) for run in cleaned.flagged] == [(run.first, run.last) for run in plain.flagged]
    assert plain.before.deepest_frame is not None and cleaned.before.deepest_frame == plain.before.deepest_frame + 1
    assert len(cleaned.after.depths) == 61 and len(cleaned.after.proven) == 60


def test_fast_and_cut_clips_have_no_reference_posture() -> None:
    for motion in (swinging(60, 0.9, along=25.0), dipping(60, 20), swinging(2, 0.9)):
        assert not any("frame 0" in note for note in audit(motion, model(), (FLOOR,), OPTIONS).notes)
