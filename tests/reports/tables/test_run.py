"""A run as a table: the engine with the checks, the engines compared with it, and the figures that are numbers."""

import math

from reports.reading.load import EngineNote
from reports.tables.run import Run
from runfiles.comparable import AVATAR_METRIC
from tests.reports.small_runs import BULLET, MUJOCO, OURS, OVERLAP, RAW, figure, run_of


def some(gated: str = OURS) -> Run:
    """Return a run of five engines with checks of one."""
    runs = (RAW, BULLET, "newcomer/fast", MUJOCO, "avatarsim/paper", OURS)
    rows = [figure("a", run, OVERLAP, 0.0, "pass" if run == gated else "info", 1.0 if run == gated else None) for run in runs]
    return run_of([*rows, figure("b", MUJOCO, AVATAR_METRIC, 0.0)])


def test_gated_engine_has_checks_and_is_first_in_tables() -> None:
    """The baseline is last, and rivals are the engines between."""
    assert some().gated == OURS and some(MUJOCO).gated == MUJOCO
    assert run_of([figure("a", MUJOCO, OVERLAP, 0.0)]).gated == OURS and some().avatars == {"b"}
    runs = some(MUJOCO).runs
    assert runs[0] == MUJOCO and runs[-1] == RAW and len(set(runs)) == len(runs)
    assert {OURS, MUJOCO, BULLET, "newcomer/fast", RAW} <= set(runs)
    assert set(some().rivals) == {MUJOCO, BULLET, "newcomer/fast"}
    assert set(some(MUJOCO).rivals) == {OURS, "avatarsim/paper", BULLET, "newcomer/fast"}


def test_no_number_is_measured_and_nothing_is_not() -> None:
    values = [0.0, math.nan, math.inf, None]
    rows = run_of([figure("a", OURS, OVERLAP, value, seed=k) for k, value in enumerate(values)]).rows
    assert rows.measured.tolist() == [True, True, True, False]
    assert rows.value.isna().tolist() == [False, True, False, True]
    assert not run_of([figure("a", OURS, "run", None, "crashed")]).rows.measured.any()


def test_variant_stands_in_for_a_preset_that_cannot_compare() -> None:
    """MuJoCo's tuned ball joints have no twist limit; its preset hinges limits other angles, so neither is compared."""
    metric, hinges = "joint_limit_excess_max", "mujoco/hinges"
    lacking = {MUJOCO: {"twist limits": "none"}, hinges: {"swing and twist limits": "of Cardan angles"}}
    figures = [("a", MUJOCO, 90.0), ("a", hinges, 1.0), ("b", MUJOCO, 2.0), ("b", hinges, 3.0), ("a", OURS, 0.0)]
    notes = [EngineNote(one, "a", "1", features, {}) for one, features in lacking.items()]
    rows = run_of([figure(scene, one, metric, value) for scene, one, value in figures], notes=notes).main_rows(metric)
    found = {(row.scenario, row.run): (row.value, row.by, row.even) for row in rows.itertuples()}
    assert found == {("a", MUJOCO): (1.0, "hinges", False), ("b", MUJOCO): (2.0, "", True), ("a", OURS): (0.0, "", True)}


def test_a_run_without_rows_has_its_columns() -> None:
    assert run_of([]).rows.empty and run_of([]).runs == () and run_of([]).avatars == frozenset()
