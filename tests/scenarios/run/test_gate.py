"""The gate: bounds, waivers and exit codes; missing data is never a pass."""

from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile, UnknownName
from runfiles.table import Row
from scenarios.catalog import scenarios
from scenarios.job import Job, Outcome, State
from scenarios.measure.value import Missing, Value
from scenarios.run.gate import bounds_of, ceilings, exit_code, judged, rows_of
from scenarios.scenario import Bound
from tests.scenarios.examples import drop, fist

NAN, OVERLAP = float("nan"), "residual_overlap_max"
SOUND: dict[str, Value] = {
    OVERLAP: 1e-7, "not_finite_frames": 0.0, "still_frames": 0.0, "tracker_offset_rms_free": 0.0, "wrong_side_frames": 0.0,
}


def outcome(**values: Value) -> Outcome:
    return Outcome(Job("fist", "e", "default"), "measured", frames=30, values=values)


def by_metric(rows: list[Row]) -> dict[str, Row]:
    return {row.metric: row for row in rows}


@pytest.mark.parametrize(("value", "ceiling", "status"), [
    (0.0, None, "pass"), (1e-6, None, "pass"), (1.1e-6, None, "fail"), (NAN, None, "fail"), (float("inf"), None, "fail"),
    (1e-6, 1e-3, "pass"), (5e-4, 1e-3, "waived"), (1e-3, 1e-3, "waived"), (1.1e-3, 1e-3, "fail"), (NAN, 1e-3, "fail"),
    (Missing("no bounce", "engine"), None, "fail"), (Missing("too short", "scene"), None, "not-measured"),
    (Missing("no judge", "package"), 1e-3, "not-measured"), (None, None, "not-measured"),
])
def test_a_bounded_figure(value: Value | None, ceiling: float | None, status: str) -> None:
    assert judged(value, 1e-6, ceiling)[0] == status


def test_only_the_gated_engine_passes_or_fails() -> None:
    gated, other = (rows_of(outcome(**SOUND | {OVERLAP: 0.1}), fist(), {}, flag) for flag in (True, False))
    assert by_metric(gated)[OVERLAP].status == "fail" and exit_code(gated) == 1
    assert {row.status for row in other} == {"info"} and exit_code(other) == 0 and by_metric(other)[OVERLAP].bound == 1e-6
    passing = rows_of(outcome(**SOUND), fist(), {}, True)
    # measured, although this scene has no bound on it
    assert by_metric(passing)["wrong_side_frames"].status == "info" and exit_code(passing) == 0


def test_unmeasured_bound_is_no_pass_and_a_waiver_is_kept() -> None:
    rows = rows_of(outcome(**{metric: value for metric, value in SOUND.items() if metric != "still_frames"}), fist(), {}, True)
    assert by_metric(rows)["still_frames"].status == "not-measured" and exit_code(rows) == 3
    rows = rows_of(outcome(**SOUND | {OVERLAP: 4e-4}), fist(), {OVERLAP: 1e-3}, True)
    row = by_metric(rows)[OVERLAP]
    assert (row.status, row.bound, row.ceiling) == ("waived", 1e-6, 1e-3) and exit_code(rows) == 0


def test_overlap_and_finite_poses_are_always_bounded() -> None:
    assert {OVERLAP, "not_finite_frames"} <= set(bounds_of(replace(drop(), bounds=())))
    with pytest.raises(UnknownName, match="residual_overlapp"):
        bounds_of(replace(drop(), bounds=(Bound("residual_overlapp", 1.0, "a slip"),)))


@pytest.mark.parametrize(("state", "code"), [("crashed", 3), ("not-measured", 3), ("cannot-say", 0), ("refused", 0)])
def test_a_run_without_figures_is_one_row(state: State, code: int) -> None:
    rows = rows_of(Outcome(Job("fist", "e", "default"), state, "why"), fist(), {}, True)
    assert [(row.metric, row.status, row.note, row.value) for row in rows] == [("run", state, "why", None)]
    assert exit_code(rows) == code


def test_failure_of_another_engine_is_information() -> None:
    never, absent = Missing("never bounced", "engine"), Missing("no judge", "package")
    rows = rows_of(outcome(restitution_error_max=never, not_finite_frames=0.0), drop(), {}, False)
    assert by_metric(rows)["restitution_error_max"].status == "info" and exit_code(rows) == 0
    assert exit_code(rows_of(outcome(residual_overlap_max=absent), drop(), {}, False)) == 3
    assert by_metric(rows_of(outcome(residual_overlap_max=NAN), fist(), {}, False))[OVERLAP].status == "info"


def test_a_failed_bound_wins_over_a_crash() -> None:
    crashed = rows_of(Outcome(Job("fist", "x", "default"), "crashed"), fist(), {}, False)
    failed = rows_of(outcome(**SOUND | {"still_frames": 51.0}), fist(), {}, True)
    assert exit_code([*crashed, *failed]) == 1 and exit_code(crashed) == 3 and exit_code([]) == 0


def test_ceilings_are_read_and_checked(tmp_path: Path) -> None:
    path = tmp_path / "ceilings.toml"
    assert ceilings(path) == {} and set(ceilings()) <= set(scenarios())
    path.write_text("[fist]\nresidual_overlap_max = 1e-3\n")
    assert ceilings(path) == {"fist": {OVERLAP: 1e-3}}
    for wrong in ("[fist]\nresidual_overlap_max = nan\n", "[fist]\nresidual_overlap_max = 'x'\n", "fist = 1\n", "[fist\n"):
        path.write_text(wrong)
        with pytest.raises(InvalidFile):
            ceilings(path)
    path.write_text("[fist]\nresidual_overlapp = 1e-3\n")
    with pytest.raises(UnknownName):
        ceilings(path)
