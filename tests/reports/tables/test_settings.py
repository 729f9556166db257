"""Settings of a sweep: the largest error of each, what it costs, and how to copy it."""

import math
import tomllib
from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from reports.tables.settings import settings
from runfiles.accuracy import counts, follows, largest
from runfiles.engines import about
from runfiles.metrics import unit
from tests.reports.small_runs import OVERLAP, write_settings

METRICS = (OVERLAP, "stop_distance_error_max", "spin_error_max", "tracker_offset_rms_free")
cell = st.dictionaries(st.sampled_from(METRICS), st.sampled_from([0.0, 1e-6, 0.02, 5.0]), min_size=1)


def read(folder: Path, *rows: Mapping[str, object]) -> pd.DataFrame:
    """Settings of a folder with these rows."""
    write_settings(folder, *rows)
    table = settings(folder)
    assert table is not None
    return table


@given(st.lists(cell, min_size=1, max_size=4))
@hypothesis_settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_the_error_is_the_largest_that_counts(tmp_path: Path, cells: list[dict[str, float]]) -> None:
    rows = [
        {"engine": "mujoco", "setting": f"s{k}", "metric": name, "unit": unit(name), "error": value}
        for k, values in enumerate(cells)
        for name, value in values.items()
    ]
    for row, values in zip(read(tmp_path, *rows).itertuples(), cells, strict=True):
        twin = largest({"state": "measured", "values": values}, tuple(values))
        if any(counts(name, unit(name)) for name in values) or not follows(values.get(METRICS[-1], math.nan)):
            assert row.error == pytest.approx(twin)


def test_times_presets_and_sleep_are_read(tmp_path: Path) -> None:
    table = read(
        tmp_path,
        {"engine": "avatarsim", "setting": "default", "base": "default", "p50": 5.0, "sleeps": 1, "rests": 0.9, "avatar": 1},
        {"engine": "avatarsim", "setting": "fine", "base": "default", "sleeps": 1, "rests": 0.9, "moving": 7.0},
        {"engine": "mujoco", "setting": "tuned", "step": 0.002, "rests": 0.9},
    )
    rows = {row.setting: row for row in table.itertuples()}
    assert [rows[name].preset for name in ("default", "fine", "tuned")] == [True, False, True]
    assert [rows[name].asleep for name in ("default", "fine", "tuned")] == [True, False, False]
    assert (rows["default"].median, rows["default"].avatar, rows["fine"].avatar) == (5.0, True, False)
    assert rows["tuned"].step == pytest.approx(500.0) and math.isnan(rows["default"].step)


@pytest.mark.parametrize(("error", "measured"), [(1e-3, True), ("", False)])
def test_what_was_not_run_is_not_measured(tmp_path: Path, error: object, measured: bool) -> None:
    state = {"state": "measured" if measured else "not-measured", "error": error, "p50": 3.0 if measured else ""}
    [row] = read(tmp_path, {"engine": "mujoco", "setting": "tuned", **state}).itertuples()
    assert row.measured == measured and math.isnan(row.error) != measured


def test_options_come_back_in_the_engines_own_words(tmp_path: Path) -> None:
    options = "[mujoco.some]\npreset = 'tuned'\ndt = 0.00125\niterations = 7\nmystery = 3\n"
    rows = read(tmp_path, {"engine": "mujoco", "setting": "some", "options": options}, {"engine": "mujoco", "setting": "tuned"})
    some, tuned = (row.native.splitlines() for row in rows.itertuples())
    assert len(some) == len(tomllib.loads(options)["mujoco"]["some"]) - 1 and tuned == []
    assert any("1/800" in line for line in some) and any("7" in line for line in some)
    assert [line for line in some if "mystery" in line] == [line for line in some if line.startswith("#")]


@given(st.integers(1, 20_000))
def test_a_step_is_written_as_the_fraction_that_it_is(rate: int) -> None:
    [line] = about("pybullet").in_own_words({"dt": 1.0 / rate})
    assert f"1/{rate}" in line if rate > 1 else line.rstrip(")").endswith("1")


@pytest.mark.parametrize(
    ("options", "steps"), [("dt = 0.001", 1000.0), ("dt = 0.001\nsleep = true", math.nan), ("sleep = true", math.nan)]
)
def test_a_setting_has_a_step_where_it_changes_nothing_else(tmp_path: Path, options: str, steps: float) -> None:
    row = {"engine": "mujoco", "setting": "tuned x", "step": 0.002, "options": f"[mujoco.x]\npreset = 'tuned'\n{options}\n"}
    (found,) = read(tmp_path, row).itertuples()
    assert found.step == pytest.approx(steps, nan_ok=True)
