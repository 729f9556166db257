"""The gate: bounds, ceilings and exit codes; missing data is never a pass."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile, UnknownName
from runfiles.table import Row
from scenarios.job import Job, Outcome
from scenarios.measure.value import Missing, Value
from scenarios.run.gate import CEILINGS, bounds_of, ceilings, exit_code, judged, meaning, rows_of
from scenarios.scenario import Bound
from tests.scenarios.examples import drop, fist

NAN = float("nan")


@pytest.mark.parametrize(("value", "ceiling", "status"), [
    (0.0, None, "pass"), (1e-6, None, "pass"), (1.1e-6, None, "fail"), (NAN, None, "fail"), (float("inf"), None, "fail"),
    (1e-6, 1e-3, "pass"), (5e-4, 1e-3, "waived"), (1e-3, 1e-3, "waived"), (1.1e-3, 1e-3, "fail"), (NAN, 1e-3, "fail"),
    (Missing("no bounce", "engine"), None, "fail"), (Missing("too short", "scene"), None, "not-measured"),
    (Missing("no judge", "package"), 1e-3, "not-measured"), (None, None, "not-measured"),
])
def test_a_bounded_figure(value: Value | None, ceiling: float | None, status: str) -> None:
    assert judged(value, 1e-6, ceiling)[0] == status


def outcome(**values: Value) -> Outcome:
    return Outcome(Job("fist", "e", "default"), "measured", frames=30, values=values)


SOUND: dict[str, Value] = {
    "residual_overlap_max": 1e-7, "not_finite_frames": 0.0, "still_frames": 0.0, "tracker_offset_rms_free": 0.0,
    "wrong_side_frames": 0.0,
}


def statuses(rows: list[Row]) -> dict[str, str]:
    return {row.metric: row.status for row in rows}


def test_only_the_gated_engine_passes_or_fails() -> None:
    values = SOUND | {"residual_overlap_max": 0.1}
    gated, other = (rows_of(outcome(**values), fist(), {}, flag) for flag in (True, False))
    assert statuses(gated)["residual_overlap_max"] == "fail" and exit_code(gated) == 1
    assert set(statuses(other).values()) == {"info"} and exit_code(other) == 0
    assert {row.bound for row in other if row.metric == "residual_overlap_max"} == {1e-6}


def test_all_held() -> None:
    rows = rows_of(outcome(**SOUND), fist(), {}, True)
    assert exit_code(rows) == 0
    assert statuses(rows)["wrong_side_frames"] == "info", "measured, though this scene puts no bound on it"


def test_a_bound_that_nothing_measured_is_not_a_pass() -> None:
    values = {metric: value for metric, value in SOUND.items() if metric != "still_frames"}
    rows = rows_of(outcome(**values), fist(), {}, True)
    assert statuses(rows)["still_frames"] == "not-measured" and exit_code(rows) == 3


def test_a_bound_within_a_ceiling_is_waived_and_stays_visible() -> None:
    values = SOUND | {"residual_overlap_max": 4e-4}
    rows = rows_of(outcome(**values), fist(), {"residual_overlap_max": 1e-3}, True)
    (row,) = [row for row in rows if row.metric == "residual_overlap_max"]
    assert (row.status, row.bound, row.ceiling) == ("waived", 1e-6, 1e-3) and exit_code(rows) == 0
    assert "above the bound 1e-06" in row.note


@pytest.mark.parametrize(("still", "limits", "status", "numbers"), [
    (0.0, {}, "pass", [4, 4]), (50.5, {"still_frames": 51.0}, "waived", [3, 4, 1]),
    (52.0, {"still_frames": 51.0}, "fail", [3, 4, 1]), (50.5, {}, "fail", [3, 4, 1]),
])
def test_the_words_of_the_code_count_the_checks(
    still: float, limits: dict[str, float], status: str, numbers: list[int]
) -> None:
    rows = rows_of(outcome(**SOUND | {"still_frames": still}), fist(), limits, True)
    others = rows_of(Outcome(Job("fist", "o", "default"), "measured", values=SOUND), fist(), {}, False)
    said = meaning(exit_code(rows), [*rows, *others], frozenset({("e", "default")}))
    assert statuses(rows)["still_frames"] == status
    assert [int(word) for word in re.findall(r"\d+", said)] == numbers
    assert ("waived" in said) == (status == "waived") and ("failed" in said) == (status == "fail")


def test_overlap_and_numbers_are_bounded_in_every_scene() -> None:
    assert {"residual_overlap_max", "not_finite_frames"} <= set(bounds_of(replace(drop(), bounds=())))


def test_a_bound_on_a_metric_that_nobody_measures_is_refused() -> None:
    with pytest.raises(UnknownName, match="residual_overlapp"):
        bounds_of(replace(drop(), bounds=(Bound("residual_overlapp", 1.0, "a slip"),)))


@pytest.mark.parametrize(("state", "code"), [("crashed", 3), ("not-measured", 3), ("cannot-say", 0), ("refused", 0)])
def test_a_run_without_figures_is_one_row(state: str, code: int) -> None:
    rows = rows_of(Outcome(Job("fist", "e", "default"), state, "why"), fist(), {}, True)
    assert [(row.metric, row.status, row.note, row.value) for row in rows] == [("run", state, "why", None)]
    assert exit_code(rows) == code


def test_what_another_engine_failed_to_do_is_information_and_a_missing_package_is_not() -> None:
    never, absent = Missing("never bounced", "engine"), Missing("no judge", "package")
    rows = rows_of(outcome(restitution_error_max=never, not_finite_frames=0.0), drop(), {}, False)
    assert statuses(rows)["restitution_error_max"] == "info" and exit_code(rows) == 0
    assert exit_code(rows_of(outcome(residual_overlap_max=absent), drop(), {}, False)) == 3


def test_not_a_number_of_another_engine_says_so() -> None:
    (row,) = [r for r in rows_of(outcome(residual_overlap_max=NAN), fist(), {}, False) if r.metric == "residual_overlap_max"]
    assert (row.status, row.note) == ("info", "not a number")


def test_a_failed_bound_wins_over_a_crash() -> None:
    crashed = rows_of(Outcome(Job("fist", "x", "default"), "crashed"), fist(), {}, False)
    failed = rows_of(outcome(**SOUND | {"still_frames": 51.0}), fist(), {}, True)
    assert exit_code([*crashed, *failed]) == 1 and exit_code(crashed) == 3 and exit_code([]) == 0


def test_ceilings_are_read_and_checked(tmp_path: Path) -> None:
    path = tmp_path / "ceilings.toml"
    assert ceilings(path) == {}
    path.write_text("[fist]\nresidual_overlap_max = 1e-3\n")
    assert ceilings(path) == {"fist": {"residual_overlap_max": 1e-3}}
    for wrong in ("[fist]\nresidual_overlap_max = nan\n", "[fist]\nresidual_overlap_max = 'x'\n", "fist = 1\n", "[fist\n"):
        path.write_text(wrong)
        with pytest.raises(InvalidFile):
            ceilings(path)
    path.write_text("[fist]\nresidual_overlapp = 1e-3\n")
    with pytest.raises(UnknownName):
        ceilings(path)


def test_the_committed_ceilings_are_sound() -> None:
    from scenarios.catalog import scenarios

    assert set(ceilings(CEILINGS)) <= set(scenarios())
