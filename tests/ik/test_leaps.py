"""Teleports: a target that jumps and spins is followed through nothing, though the frame's budget would reach it."""

from itertools import islice

import pytest

from tests.stability.hostile import TRIALS, one_return, outside_room
from tests.worlds.ride import ride


@pytest.mark.parametrize(("seed", "frames"), [(85, 13), (35, 13), (55, 37)])
def test_a_palm_whose_target_leaps_out_of_the_room_stays_inside(seed: int, frames: int) -> None:
    trial = TRIALS["two"]()
    go = ride(trial.scene, seed)
    for _, sample in islice(one_return(trial, seed, 60, 0), frames):
        assert outside_room(trial.scene, go.frame(sample)) <= 0.0


@pytest.mark.parametrize("begins", ["loaded", "restored"])
def test_an_avatar_does_not_leap_into_one_whose_island_is_solved_for_later(begins: str) -> None:
    """Seed 264: in the very first frame the arm of one jumps to where the other, which touches nothing, still is."""
    trial = TRIALS["two"]()
    go = ride(trial.scene, 264)
    samples = [sample for _, sample in islice(one_return(trial, 264, 60, 0), 12)]
    for sample in samples if begins == "loaded" else ():
        go.frame(sample)
    for k, sample in enumerate(samples if begins == "restored" else ()):
        other = ride(trial.scene, 264)
        other.engine.restore(go.engine.snapshot())
        shown = go.frame(sample), other.frame(sample)
        assert shown[0].state_hash() == shown[1].state_hash(), k
