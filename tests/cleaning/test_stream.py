"""The shield: coordinates in the file's order in, certified ones out."""

import numpy as np
import pytest

from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Options, Shield
from avatarsim.cleaning.chords import Chords, certified, scene_of
from avatarsim.errors import InvalidInput
from avatarsim.spatial import rotation
from tests.assets.motions.robots import driven
from tests.cleaning.rooms import FLOOR, RATE, lowered, model, swinging, walker


def rows(heights: np.ndarray) -> np.ndarray:
    """Return coordinates (F, 12) of the swinging walker at these heights."""
    return driven(model()).coordinates.rows(lowered(swinging(len(heights), 0.0), heights))


def test_what_comes_out_is_free_and_free_input_stays() -> None:
    given = rows(0.5 - 0.25 * np.exp(-(((np.arange(90) - 45) / 8.0) ** 2)))
    shield = Shield(model(), (FLOOR,), RATE)
    out, free = [], []
    for q in given:
        out.append(shield(q))
        free.append(shield.is_free)
    shown, was_free = np.array(out), np.array(free)
    assert was_free[:30].all() and not was_free[42:48].any() and was_free[-20:].all()
    assert np.array_equal(shown[was_free], given[was_free])
    chords = Chords(scene_of(model(), (FLOOR,), Options()))
    motion = shield.coordinates.motion(shown, np.arange(len(shown)) / RATE)
    assert (certified(chords, motion).until == 1.0).all()
    assert (shown[:, 2] > 0.3).all()


def test_a_stream_that_begins_in_the_floor_is_lifted_out() -> None:
    shield = Shield(model(), (FLOOR,), RATE)
    first = shield(rows(np.full(1, 0.1))[0])
    assert 0.3 < first[2] < 0.6 and not shield.is_free


def test_limits_hold() -> None:
    shield = Shield(model(), (), RATE)
    q = rows(np.full(1, 1.0))[0]
    q[7] = 2.0
    assert shield(q)[7] == pytest.approx(1.2) and not shield.is_free


def test_what_is_no_posture_is_refused_and_the_stream_goes_on() -> None:
    shield, q = Shield(model(), (FLOOR,), RATE), rows(np.full(1, 1.0))[0]
    assert np.array_equal(shield(q), q)
    bad = q.copy()
    bad[2] = np.nan
    far = q.copy()
    far[2] = 1e16
    for wrong in (q[:-1], np.stack([q, q]), bad, far, np.zeros_like(q)):
        with pytest.raises(InvalidInput):
            shield(wrong)
    assert np.array_equal(shield(q), q)


def test_a_model_without_coordinates_and_other_rates_are_refused() -> None:
    with pytest.raises(InvalidInput, match="coordinates of the model"):
        Shield(Model(walker(), None, (), ()))
    for rate in (0.0, float("nan"), 1e4):
        with pytest.raises(InvalidInput, match="rate of a shield"):
            Shield(model(), (), rate)


@pytest.mark.parametrize("flips", [False, True])
def test_quaternions_of_a_turning_root_keep_their_side(flips: bool) -> None:
    count = 120
    given = rows(0.5 - 0.25 * np.exp(-(((np.arange(count) - 60) / 20.0) ** 2)))
    # two whole turns, so that the scalar part changes its sign twice, most of them in the floor
    given[:, 3:7] = rotation.from_axis_angle((0.0, 0.0, 1.0), np.linspace(0.0, 4.0 * np.pi, count))
    if flips:
        given[:, 3:7] *= np.where(given[:, 3:4] < 0.0, -1.0, 1.0)
    shield = Shield(model(), (FLOOR,), RATE)
    shown = np.array([shield(q) for q in given])
    for first in (3, 8):
        quaternions = shown[:, first : first + 4]
        assert ((quaternions[1:] * quaternions[:-1]).sum(axis=1) > 0.0).all()
    assert shown[0, 3:7] == pytest.approx(given[0, 3:7])
