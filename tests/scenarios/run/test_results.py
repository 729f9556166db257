"""Files of a run: columns, strict JSON, folders, and the check once a run has ended."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from runfiles.files import last_comparison, latest, plain, point_latest, run_folder, write_json
from runfiles.table import RESULTS, Row, csv_text
from scenarios.job import Job, Outcome
from scenarios.run.results import MORE, Results, write

ROWS = [
    Row("drop", "e", "default", 0, 90, "residual_overlap_max", 1.5e-7, "m", 1e-6, 1e-3, "pass"),
    Row("drop", "e", "default", 0, 90, "not_finite_frames", float("nan"), "frames", 0.0, None, "fail", "not a number"),
    Row("drop", "f", "default", 0, 0, "run", None, "", None, None, "crashed", "killed, by \"signal\" 9"),
]


def results(rows: list[Row], code: int | None = 1) -> Results:
    outcome = Outcome(Job("drop", "e", "default"), "measured", about={"version": "1", "settings": {"dt": (0.1, "a reason")}})
    series = {"drop": {"e/default": {"overlap_m": (0.0, float("inf")), "frame_time_us": []}}}
    return Results(rows, [outcome], series, {"drop": {"title": "A drop."}}, {"seconds": 1.0}, code)


def test_csv_has_the_promised_columns_and_an_empty_field_for_nothing(tmp_path: Path) -> None:
    found = list(csv.DictReader(csv_text(ROWS, RESULTS).splitlines()))
    assert tuple(found[0]) == RESULTS
    assert [row["value"] for row in found] == ["1.5e-07", "nan", ""]
    assert [row["bound"] for row in found] == ["1e-06", "0.0", ""]
    assert [row["status"] for row in found] == ["pass", "fail", "crashed"]


def test_the_file_says_which_figures_compare_engines_and_why_not(tmp_path: Path) -> None:
    rows = [replace(ROWS[0], engine="mujoco"), replace(ROWS[0], engine="mujoco", metric="restitution_error_max", ceiling=None)]
    bounces = Outcome(Job("drop", "mujoco", "default"), "measured", about={"cannot_say": {"restitution": "no coefficient"}})
    write(replace(results(rows), outcomes=[bounces]), tmp_path)
    found = list(csv.DictReader((tmp_path / "results.csv").read_text().splitlines()))
    assert tuple(found[0]) == (*RESULTS, *MORE)
    assert [row["comparable"] for row in found] == ["yes", "no"] and [row["waiver"] for row in found] == ["0.001", ""]
    assert found[0]["why"] == "" and "restitution" in found[1]["why"]


def test_json_is_strict_and_complete(tmp_path: Path) -> None:
    write(results(ROWS), tmp_path)

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    found = json.loads((tmp_path / "results.json").read_text(), parse_constant=refuse)
    assert found["schema_version"] == 1 and found["exit_code"] == 1
    assert [row["value"] for row in found["rows"]] == [1.5e-7, "NaN", None]
    assert found["rows"][0]["ceiling"] == 1e-3 and found["rows"][2]["note"].startswith("killed")
    assert found["series"]["drop"]["e/default"]["overlap_m"] == [0.0, "Infinity"]
    assert found["engines"][0]["settings"] == {"dt": [0.1, "a reason"]}
    assert found["scenes"]["drop"]["title"] == "A drop."


def test_reports_can_read_it(tmp_path: Path) -> None:
    from reports.reading.load import load

    write(results(ROWS), tmp_path)
    found = load(tmp_path)
    assert [row.status for row in found.rows] == ["pass", "fail", "crashed"]
    assert found.exit_code == 1 and found.titles == {"drop": "A drop."}


def test_a_waived_check_has_its_status_in_both_files_and_in_the_published_layout(tmp_path: Path) -> None:
    waived = Row("drop", "e", "default", 0, 90, "still_frames", 2.0, "%", 1.0, 3.0, "waived", "above the bound 1")
    write(results([*ROWS, waived]), tmp_path)
    assert list(csv.DictReader((tmp_path / "results.csv").read_text().splitlines()))[-1]["status"] == "waived"
    from reports.reading.load import load

    assert load(tmp_path).rows[-1].status == "waived"


def test_bench_appears_with_the_first_time(tmp_path: Path) -> None:
    write(results(ROWS), tmp_path)
    assert not (tmp_path / "bench.csv").exists()
    timed = Row("drop", "e", "default", 0, 90, "frame_time_p50", 12.0, "us", None, None, "info")
    write(results([*ROWS, timed]), tmp_path)
    assert [row["metric"] for row in csv.DictReader((tmp_path / "bench.csv").read_text().splitlines())] == ["frame_time_p50"]


def test_numbers_without_a_word_in_json_become_texts(tmp_path: Path) -> None:
    import numpy as np

    assert plain({"a": np.float64("nan"), 1: (np.int64(3), -np.inf), "b": np.array([True, False])}) == {
        "a": "NaN", "1": [3, "-Infinity"], "b": [True, False],
    }
    write_json(tmp_path / "x.json", {"a": float("inf")})
    assert json.loads((tmp_path / "x.json").read_text()) == {"a": "Infinity"}


def test_every_run_has_its_folder_and_latest_leads_to_the_last(tmp_path: Path) -> None:
    one, two = run_folder(tmp_path, "check"), run_folder(tmp_path, "check")
    assert one != two and one.is_dir() and two.is_dir()
    point_latest(one)
    point_latest(two)
    assert (tmp_path / "latest").resolve() == two.resolve()
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([one.name, two.name, "latest"])


def test_studies_go_to_the_last_comparison_and_never_into_another_run(tmp_path: Path) -> None:
    point_latest(run_folder(tmp_path, "check"), "check")
    assert last_comparison(tmp_path, "growth") == tmp_path / "growth" and not latest(tmp_path).exists()
    compared = run_folder(tmp_path, "compare")
    point_latest(compared)
    assert last_comparison(tmp_path, "growth").resolve() == compared.resolve() != latest(tmp_path, "check").resolve()


def test_a_folder_called_latest_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "latest").mkdir()
    (tmp_path / "latest" / "mine.txt").write_text("mine")
    point_latest(run_folder(tmp_path, "run"))
    assert (tmp_path / "latest" / "mine.txt").read_text() == "mine"


def test_a_run_that_has_ended_is_checked_once_its_figures_are_safe(tmp_path: Path) -> None:
    broken = [replace(ROWS[0], scenario=None)]  # type: ignore[arg-type]
    write(results(broken, None), tmp_path)
    with pytest.raises(InvalidFile, match=r"^rows\[0\]\.scenario"):
        write(results(broken), tmp_path)
    assert json.loads((tmp_path / "results.json").read_text())["exit_code"] == 1
