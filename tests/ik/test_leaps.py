"""A target that leaps and spins is followed through nothing, though the frame's budget would reach it."""

from itertools import islice

import pytest

from tests.posture.ride import ride
from tests.stability.hostile import TRIALS, one_return, outside_room


@pytest.mark.parametrize(("seed", "frames"), [(85, 13), (35, 13), (55, 37)])
def test_a_palm_whose_target_leaps_out_of_the_room_stays_inside(seed: int, frames: int) -> None:
    trial = TRIALS["two"]()
    go = ride(trial.scene, seed, "ik")
    for _, sample in islice(one_return(trial, seed, 60, 0), frames):
        assert outside_room(trial.scene, go.frame(sample)) <= 0.0
