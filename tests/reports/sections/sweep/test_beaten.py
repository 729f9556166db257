"""Presets that a setting of their own sweep beats: in time and all errors at once, or not at all."""

from reports.sections.sweep.beaten import beaten, sentence
from reports.sections.sweep.points import Point, Sweep
from tests.reports.sections.sweep.test_cheapest import point

PRESET = (point("m/tuned", 1e-3, 100.0), point("m/tuned", 2e-3, 100.0, metric="tracker_offset_rms_free"))


def other(error: float, p50: float, offset: float, run: str = "m/tuned dt=1/60") -> tuple[Point, ...]:
    return (point(run, error, p50), point(run, offset, p50, metric="tracker_offset_rms_free"))


def found(*more: Point) -> list[tuple[str, bool]]:
    return [(one.by.any_point.setting, one.closer) for one in beaten(Sweep((*PRESET, *more)))]


def test_faster_and_no_less_accurate() -> None:
    assert found(*other(1e-3, 50.0, 2e-3)) == [("tuned dt=1/60", True)]
    assert found(*other(1e-3, 50.0, 4e-3)) == [("tuned dt=1/60", False)]


def test_what_is_slower_or_worse_or_does_not_follow_beats_nothing() -> None:
    assert found(*other(1e-3, 99.0, 2e-3)) == found(*other(1.1e-3, 50.0, 2e-3)) == found(*other(0.0, 50.0, 0.02)) == []
    assert found(*other(0.0, 50.0, 0.0, "n/tuned")) == [] and found(*other(0.0, 50.0, 0.0)) != []


def test_one_of_two_errors_that_is_worse_is_enough() -> None:
    first, second = (point(run, error, time, metric="apex_error_max")
                     for run, error, time in (("m/tuned", 1e-3, 100.0), ("m/tuned dt=1/60", 2e-3, 50.0)))
    assert found(*other(0.0, 50.0, 0.0), first, second) == []


def test_errors_below_what_counts_as_none_are_not_told_apart() -> None:
    none = (point("m/tuned", 0.0, 100.0, "drop"), point("m/tuned a=1", 9e-7, 50.0, "drop"))
    assert [one.by.any_point.setting for one in beaten(Sweep(none))] == ["tuned a=1"]


def test_ours_is_asked_too_and_it_is_said_how_often() -> None:
    ours = (point("avatarsim/default", 0.0, 10.0), point("avatarsim/default steps=1", 0.0, 5.0))
    assert "avatarsim/default in 1 scene; 1 of 1 by one" in sentence(beaten(Sweep(ours)))
    paper = beaten(Sweep((ours[0], point("avatarsim/paper", 0.0, 5.0))))
    assert [one.by.any_point.run for one in paper] == ["avatarsim/paper"], "what stands aside is named where it is better"
    assert sentence(()).startswith("No tuned preset is beaten")
