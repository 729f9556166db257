"""Errors as lengths, settings that follow their user, and engines that miss an accuracy that avatarsim reaches."""

import math

import pytest

from runfiles.accuracy import FOLLOWS, Reached, counts, follows, largest, missing
from scenarios.studies.checkpoint import Entry

OVERLAP, OFFSET, STOP = "residual_overlap_max", "tracker_offset_rms_free", "stop_distance_error_max"


def entry(state: str = "measured", **values: float) -> Entry:
    return {"state": state, "values": values}


def test_what_is_a_length_counts_and_how_it_follows_does_not() -> None:
    assert counts(OVERLAP) and counts(STOP) and not counts(OFFSET) and not counts("spin_error_max")
    assert follows(math.nan) and follows(FOLLOWS) and not follows(1.001 * FOLLOWS)
    # the largest counts, and a percent of a way is ten millimetres
    assert largest(entry(residual_overlap_max=1e-3, stop_distance_error_max=1.0), (OVERLAP, STOP)) == pytest.approx(1e-2)
    assert largest(entry(residual_overlap_max=1e-3, stop_distance_error_max=1.0), (OVERLAP,)) == 1e-3


@pytest.mark.parametrize("spoilt", [
    entry("crashed"), entry(), entry(residual_overlap_max=math.nan),
    entry(residual_overlap_max=0.0, tracker_offset_rms_free=1.001 * FOLLOWS),
])
def test_unmeasured_or_not_following_is_infinitely_wrong(spoilt: Entry) -> None:
    assert largest(spoilt, (OVERLAP, OFFSET)) == math.inf


def test_engine_misses_what_ours_reaches_at_its_finest_step() -> None:
    found = [
        Reached("a", "avatarsim", 1e-5, math.nan), Reached("a", "m", 5e-3, 1 / 60), Reached("a", "m", 2e-3, 1 / 240),
        Reached("a", "p", 8e-5, 1 / 240), Reached("b", "m", 1.0, 1 / 60), Reached("c", "avatarsim", 1.0, math.nan),
        Reached("c", "m", 2.0, 1 / 60),
    ]
    # ours does not reach the micrometre, so that p misses nothing; in b ours was not measured, in c it reaches nothing
    assert missing(found) == {("a", "m"): 1 / 240}
