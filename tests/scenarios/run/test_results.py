"""Files of a run: columns, strict JSON, folders, and the check once a run has ended."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import InvalidFile
from reports.reading.load import load
from runfiles.files import plain, point_latest, run_folder, write_json
from runfiles.table import RESULTS, Row
from scenarios.job import Job, Outcome
from scenarios.run.results import MORE, Results, write

ROWS = [
    Row("drop", "e", "default", 0, 90, "residual_overlap_max", 1.5e-7, "m", 1e-6, 1e-3, "pass"),
    Row("drop", "e", "default", 0, 90, "not_finite_frames", float("nan"), "frames", 0.0, None, "fail", "not a number"),
    Row("drop", "f", "default", 0, 0, "run", None, "", None, None, "crashed", "killed, by \"signal\" 9"),
    Row("drop", "e", "default", 0, 90, "still_frames", 2.0, "%", 1.0, 3.0, "waived", "above the bound 1"),
]


def results(rows: list[Row], code: int | None = 1) -> Results:
    outcome = Outcome(Job("drop", "e", "default"), "measured", about={"version": "1", "settings": {"dt": (0.1, "a reason")}})
    series = {"drop": {"e/default": {"overlap_m": (0.0, float("inf")), "frame_time_us": []}}}
    return Results(rows, [outcome], series, {"drop": {"title": "A drop."}}, {"seconds": 1.0}, code)


def lines(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text().splitlines()))


def test_csv_has_its_columns_and_empty_fields(tmp_path: Path) -> None:
    write(results(ROWS), tmp_path)
    found = lines(tmp_path / "results.csv")
    assert tuple(found[0]) == (*RESULTS, *MORE) and not (tmp_path / "bench.csv").exists()
    assert [row["value"] for row in found] == ["1.5e-07", "nan", "", "2.0"]
    assert [row["bound"] for row in found] == ["1e-06", "0.0", "", "1.0"]
    assert [row["waiver"] for row in found] == ["0.001", "", "", "3.0"]
    assert [row["status"] for row in found] == ["pass", "fail", "crashed", "waived"]
    timed = Row("drop", "e", "default", 0, 90, "frame_time_p50", 12.0, "us", None, None, "info")
    write(results([*ROWS, timed]), tmp_path)
    assert [row["metric"] for row in lines(tmp_path / "bench.csv")] == ["frame_time_p50"]


def test_csv_says_why_figures_do_not_compare(tmp_path: Path) -> None:
    rows = [replace(ROWS[0], engine="mujoco"), replace(ROWS[0], engine="mujoco", metric="restitution_error_max")]
    bounces = Outcome(Job("drop", "mujoco", "default"), "measured", about={"unsupported": {"restitution": "no coefficient"}})
    write(replace(results(rows), outcomes=[bounces]), tmp_path)
    found = lines(tmp_path / "results.csv")
    assert [row["comparable"] for row in found] == ["yes", "no"] and [bool(row["why"]) for row in found] == [False, True]


def test_json_is_strict_and_complete_and_reports_can_read_it(tmp_path: Path) -> None:
    write(results(ROWS), tmp_path)

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    found = json.loads((tmp_path / "results.json").read_text(), parse_constant=refuse)
    assert found["schema_version"] == 1 and found["exit_code"] == 1
    assert [row["value"] for row in found["rows"]] == [1.5e-7, "NaN", None, 2.0]
    assert found["rows"][0]["ceiling"] == 1e-3 and found["rows"][2]["note"] == ROWS[2].note
    assert found["series"]["drop"]["e/default"]["overlap_m"] == [0.0, "Infinity"]
    assert found["engines"][0]["settings"] == {"dt": [0.1, "a reason"]}
    run = load(tmp_path)
    assert [row.status for row in run.rows] == ["pass", "fail", "crashed", "waived"]
    assert run.exit_code == 1 and run.titles == {"drop": "A drop."}


def test_numbers_without_a_word_in_json_become_texts(tmp_path: Path) -> None:
    assert plain({"a": np.float64("nan"), 1: (np.int64(3), -np.inf), "b": np.array([True, False])}) == {
        "a": "NaN", "1": [3, "-Infinity"], "b": [True, False],
    }
    write_json(tmp_path / "x.json", {"a": float("inf")})
    assert json.loads((tmp_path / "x.json").read_text()) == {"a": "Infinity"}


def test_a_folder_called_latest_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "latest").mkdir()
    (tmp_path / "latest" / "mine.txt").write_text("mine")
    point_latest(run_folder(tmp_path, "run"))
    assert (tmp_path / "latest" / "mine.txt").read_text() == "mine"


def test_ended_run_is_checked_once_its_figures_are_safe(tmp_path: Path) -> None:
    broken = [replace(ROWS[0], scenario=None)]  # type: ignore[arg-type]
    write(results(broken, None), tmp_path)
    with pytest.raises(InvalidFile, match=r"^rows\[0\]\.scenario"):
        write(results(broken), tmp_path)
    assert json.loads((tmp_path / "results.json").read_text())["exit_code"] == 1
