"""Frames in which contact begins are found by the raw tracker, and counted apart."""

import numpy as np

from reports.reading.load import Results, Series
from reports.sections.first_contact import onsets, sentence, splits

OVERLAP = np.array([0.0] * 6 + [0.01] * 6 + [0.0] * 3 + [0.01] * 3 + [0.0] * 6 + [0.02] * 2)


def made(ours: float, theirs: float) -> Results:
    times = np.full(25, 10.0)
    # states 6 and 24: frames 5, 6, 7 and 23, 24 lead to them and to the two after
    times[[5, 6, 7, 23, 24]] = ours
    other = np.full(25, 40.0)
    other[6] = theirs
    series = {"wall": {"a/default": Series(OVERLAP * 0.0, times), "b/default": Series(OVERLAP * 0.0, other),
                       "tracker/default": Series(OVERLAP, np.zeros(0))}}
    return Results((), series, (), {}, 0, {}, ())


def test_contact_begins_after_calm_only() -> None:
    assert onsets(OVERLAP).tolist() == [6, 24]
    assert onsets(np.full(20, np.nan)).size == 0 and onsets(np.zeros(0)).size == 0


def test_just_begun_frames_stand_apart() -> None:
    ours, theirs = splits(made(30.0, 50.0))
    assert (ours.begun, ours.slowest, ours.others, ours.onsets, ours.factor) == (30.0, 30.0, 10.0, 2, 3.0)
    assert (theirs.begun, theirs.slowest, theirs.others) == (40.0, 50.0, 40.0)


def test_who_is_faster_there_is_named() -> None:
    assert "No other engine's slowest such frame is faster" in sentence(splits(made(30.0, 50.0)), "a/default")
    assert "Faster in their slowest such frame: b/default in wall." in sentence(splits(made(60.0, 50.0)), "a/default")
    assert sentence((), "a/default").startswith("No contact of the raw tracker begins")
