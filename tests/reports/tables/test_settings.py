"""Settings of a sweep: the largest error of each, its cost, and its options to copy."""

import math
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from reports.reading.load import EngineNote
from reports.tables.settings import options_of, preset_options, settings
from runfiles.accuracy import counts, follows, largest
from runfiles.engines import about
from runfiles.table import STUDIED, csv_text
from tests.reports.small_runs import BULLET, MUJOCO, OURS, OVERLAP, SETTING, Part, figure, run_of, write_study

METRICS = (OVERLAP, "stop_distance_error_max", "spin_error_max", "tracker_offset_rms_free")
cell = st.dictionaries(st.sampled_from(METRICS), st.sampled_from([0.0, 1e-6, 0.02, 5.0]), min_size=1)


def read(folder: Path, *parts: Part) -> pd.DataFrame:
    """Return the settings of a folder with these runs."""
    write_study(folder, "settings", *parts)
    table = settings(folder)
    assert table is not None
    return table


@given(st.lists(cell, min_size=1, max_size=4))
@hypothesis_settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_the_error_is_the_largest_that_counts(tmp_path: Path, cells: list[dict[str, float]]) -> None:
    parts = [Part("arm_wall", MUJOCO, f"s{k}", {**values, "frame_time_max": 9.0}) for k, values in enumerate(cells)]
    for row, values in zip(read(tmp_path, *parts).itertuples(), cells, strict=True):
        twin = largest({"state": "measured", "values": values}, tuple(values))
        if any(counts(name) for name in values) or not follows(values.get(METRICS[-1], math.nan)):
            assert row.error == pytest.approx(twin)


def test_times_presets_and_sleep_are_read(tmp_path: Path) -> None:
    rests = {**SETTING, "resting_frames": 90.0}
    table = read(
        tmp_path, Part("a", OURS, "", rests), Part("a", OURS, "fine", {**rests, "frame_time_moving_p50": 7.0}),
        Part("a", MUJOCO, "", {**rests, "time_step": 0.002}),
    )
    ours, fine, tuned = table.itertuples()
    assert [row.preset for row in (ours, fine, tuned)] == [True, False, True]
    assert [row.asleep for row in (ours, fine, tuned)] == [True, False, False]
    assert (ours.median, ours.p95) == (20.0, 30.0)
    assert tuned.step == pytest.approx(500.0) and math.isnan(ours.step)


def test_setting_without_or_with_spoilt_figures_is_unmeasured(tmp_path: Path) -> None:
    through = Part("a", MUJOCO, "x", {**SETTING, "wrong_side_frames": 2.0})
    whole, crashed = Part("a", MUJOCO, "", SETTING), Part("a", BULLET, status="crashed")
    whole, spoilt, none = read(tmp_path, whole, through, crashed).itertuples()
    assert whole.measured and not spoilt.measured and not none.measured
    assert whole.error == 1e-4 and math.isnan(spoilt.error) and math.isnan(none.error)


def test_options_come_back() -> None:
    line = 'mujoco."some" = {preset = "tuned", dt = 0.00125, iterations = 7}; replace(scene, narrow=1)'
    assert options_of("mujoco", line) == {"dt": 0.00125, "iterations": 7}
    assert options_of("mujoco", "--engine mujoco --preset tuned") == options_of("pybullet", line) == {}


@given(st.integers(1, 20_000))
def test_a_step_is_written_as_the_fraction_that_it_is(rate: int) -> None:
    [line] = about("pybullet").in_own_words({"dt": 1.0 / rate})
    assert f"1/{rate}" in line if rate > 1 else line.rstrip(")").endswith("1")


@pytest.mark.parametrize("step", [math.nan, math.inf, -math.inf])
def test_a_step_that_is_no_number_is_written_as_it_is(step: float) -> None:
    [line] = about("pybullet").in_own_words({"dt": step})
    assert str(step) in line


@pytest.mark.parametrize(
    ("options", "steps"), [("dt = 0.001", 1000.0), ("dt = 0.001\nsleep = true", math.nan), ("sleep = true", math.nan)]
)
def test_a_setting_has_a_step_where_it_changes_nothing_else(tmp_path: Path, options: str, steps: float) -> None:
    row = Part("a", MUJOCO, "x", {**SETTING, "time_step": 0.002}, f"[mujoco.x]\npreset = 'tuned'\n{options}\n")
    (found,) = read(tmp_path, row).itertuples()
    assert found.step == pytest.approx(steps, nan_ok=True)


def test_tails_of_few_frames_are_marked(tmp_path: Path) -> None:
    rows = [row for one in ("", "fine") for row in Part("a", MUJOCO, one, SETTING).rows("settings")]
    noted = [replace(row, note=f"{1 if row.change else 2} x 300 frames, 30 warm-up frames") for row in rows]
    (tmp_path / "settings.csv").write_text(csv_text(noted, STUDIED))
    table = settings(tmp_path)
    assert table is not None and dict(zip(table.preset, table.few, strict=True)) == {True: False, False: True}


def test_options_of_a_preset_are_those_that_the_default_has_otherwise(tmp_path: Path) -> None:
    chosen = {"dt": ("0.00125", ""), "sleep": ("true", ""), "iterations": ("100", ""), "optimises": ("all", ""), "own": ("1", "")}
    plain = {"dt": ("0.002", ""), "sleep": ("false", ""), "iterations": ("100", ""), "optimises": ("nothing", "")}
    notes = [EngineNote(f"mujoco/{name}", "a", "1", {}, said) for name, said in (("default", plain), ("tuned", chosen))]
    run = run_of([figure("a", MUJOCO, OVERLAP, 0.0)], notes=notes, name=str(tmp_path))
    assert preset_options(run, "a", "mujoco", "tuned") == {"dt": 0.00125, "sleep": True}
