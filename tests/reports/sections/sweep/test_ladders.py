"""Ladders of steps: which points are one, and in which an error grows with a finer step."""

from dataclasses import replace

from reports.sections.sweep.attempts import attempts
from reports.sections.sweep.ladders import falling, ladders, sentence, worse
from reports.sections.sweep.points import Point, Sweep
from tests.reports.sections.sweep.test_cheapest import point


def rung(rate: float, error: float, setting: str = "", scene: str = "wall", **more: str) -> Point:
    return replace(point(f"m/{setting or f'tuned dt=1/{rate:.0f}'}", error, 1e4 / rate, scene, **more), step=1.0 / rate)


FALLING = (rung(60, 1e-2), rung(240, 2e-3), rung(960, 1e-4, "tuned"))
GROWING = (rung(60, 7e-3, scene="table"), rung(240, 1.4e-2, scene="table"), rung(960, 1e-5, "tuned", "table"))


def test_a_ladder_differs_in_steps_alone() -> None:
    other = (rung(240, 1.0, "tuned iterations=10"), rung(480, 1.0, "default dt=1/480"), point("avatarsim/default", 0.0, 1.0))
    offset = rung(120, 1.0, metric="tracker_offset_rms_free")
    (ladder,) = ladders(Sweep((*other, offset, *FALLING)))
    assert [p.setting for p in ladder] == ["tuned dt=1/60", "tuned dt=1/240", "tuned"]


def test_growth_is_said_by_scene_preset_and_step() -> None:
    (grown,) = worse(ladders(Sweep((*FALLING, *GROWING))))
    assert grown.factor == 2.0
    said = sentence(Sweep((*FALLING, *GROWING)))
    assert "in 1 of 2 ladders" in said and "table m/tuned from 1/60 s to 1/240 s: 7.00 mm to 14.0 mm" in said


def test_what_falls_or_scatters_below_what_counts_as_none_is_not_growth() -> None:
    assert "In none of 1 ladder" in sentence(Sweep(FALLING)) and sentence(Sweep(())) == ""
    assert worse(ladders(Sweep((rung(60, 1e-9), rung(240, 9e-7), rung(960, 1e-12))))) == ()
    little, much = (worse(ladders(Sweep((rung(60, 1e-3), rung(240, error))))) for error in (1.4e-3, 1.6e-3))
    assert little == () and len(much) == 1


def test_errors_that_fall_to_the_finest_step_measured_are_named() -> None:
    halving = [rung(rate, 0.4 / rate, "tuned" if rate == 960 else "") for rate in (480, 960, 1920, 3840)]
    def ends(*points: Point) -> list[str]:
        return [attempt.any_point.setting for attempt in falling(attempts(points))]

    assert ends(*halving) == ["tuned dt=1/3840"] and ends(halving[0]) == []
    assert ends(*halving, rung(7680, 0.4 / 3840)) == [], "what stays as it was falls no longer"
    gone = replace(rung(7680, float("nan")), state="not-measured", p50=float("nan"), step=float("nan"))
    assert ends(*halving, gone) == ["tuned dt=1/3840"]
    offsets = [replace(p, metric="tracker_offset_rms_free", error=0.023) for p in halving]
    assert ends(*halving, *offsets) == [], "no step brings it nearer to its user"
