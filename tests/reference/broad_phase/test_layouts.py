"""The layouts are what they say: as many near pairs at any size, as dense, and moving as slowly."""

import numpy as np
import pytest

from avatarsim.collision.broad_phase import all_pairs
from reference.broad_phase.layouts import HUGE, LAYOUTS, MOTIONS, NEAR, SWING, field


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("count", [20, 200, 601])
def test_five_pairs_are_near_wherever_the_boxes_swing(layout: str, count: int) -> None:
    here = field(layout, "all slow", count)
    assert len(here.boxes) == count and (here.boxes[:, :3] < here.boxes[:, 3:]).all()
    pairs = np.zeros((99, 2), np.int64)
    assert all_pairs(here.boxes, here.wanted, pairs)[1] == NEAR
    # partners move alike, so grown by the swing on all sides the rest must be apart still
    grown = here.boxes + SWING * np.array([-1, -1, -1, 1, 1, 1])
    assert all_pairs(grown, here.wanted, pairs)[1] == NEAR
    speed = np.zeros((count, 3))
    speed[here.moving] = here.speed
    for a, b in pairs[:NEAR]:
        assert (speed[a] == speed[b]).all()


@pytest.mark.parametrize(("motion", "share", "most"), [("all slow", 1.0, 0.03), ("all fast", 1.0, 1.05), ("none", 0.0, 0.0)])
def test_motions_are_as_fast_as_they_say(motion: str, share: float, most: float) -> None:
    here = field("plane", motion, 300)
    assert len(here.moving) == share * 300
    assert np.allclose(np.linalg.norm(here.speed, axis=1) * 60.0, most, rtol=0.05)


def test_one_in_a_hundred_moves_and_the_floor_never_does() -> None:
    assert 5 < len(field("cube", "1 % slow", 2000).moving) < 40
    here = field("mixed", "all slow", 100)
    assert len(here.moving) == 98 and HUGE == 5
    assert (np.sort(np.ptp(here.boxes.reshape(-1, 2, 3), axis=1).max(axis=1))[-HUGE:] > 4.0).all()


@pytest.mark.parametrize("motion", MOTIONS)
def test_the_same_seed_is_the_same_field(motion: str) -> None:
    one, other = field("mixed", motion, 50), field("mixed", motion, 50)
    assert (one.boxes == other.boxes).all() and (one.speed == other.speed).all() and (one.moving == other.moving).all()
