"""The whole of it, quickly: files are whole, the table names what is lost first, a missing library is said and stops nothing."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from reference.narrow_phase import __main__ as program
from reference.narrow_phase.benchmark import ABOUT, QUICK, ROWS, VERDICTS, callers, measure, write
from reference.narrow_phase.cells import Cell
from reference.narrow_phase.clock import Clocked
from reference.narrow_phase.contender import Identity
from reference.narrow_phase.rows import Row, csv_text, row
from reference.narrow_phase.table import SCREEN, report
from reference.narrow_phase.verdict import judged


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ours and one library, and a room that does not exist."""
    monkeypatch.setattr(program, "ROOMS", ("in_ours", "in_mujoco", "in_nobody"))


@pytest.mark.usefixtures("few")
def test_files_and_last_words_of_a_quick_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = program.main(["--quick", "--cells", "sphere-box *", "--run", str(tmp_path / "run")])
    said = capsys.readouterr()
    assert code == program.MISSING and "nobody: not measured: ModuleNotFoundError" in said.out
    assert "narrow phase 3/3  sphere-box deep" in said.err
    rows = list(csv.DictReader((tmp_path / "run" / ROWS).read_text().splitlines()))
    assert len(rows) == 3 * 2 * 7 and {"us_p50", "max_error_m", "share_over_1e-06", "share_over_0.0001"} <= set(rows[0])
    assert all(float(each["us_p50"]) > 0.0 and each["note"] == "" for each in rows)
    assert all(float(each["max_error_m"]) <= 1e-9 for each in rows if each["library"] == "avatarsim")
    verdicts = list(csv.DictReader((tmp_path / "run" / VERDICTS).read_text().splitlines()))
    assert len(verdicts) == 6 and all(each["ours_right"] == "True" for each in verdicts)
    about = json.loads((tmp_path / "run" / ABOUT).read_text())
    assert [one["name"] for one in about["engines"]][:3] == ["ours", "ours+place", "ours/call"]
    assert about["absent"] and about["start_up"] is None and about["provenance"]["versions"]["numba"]
    assert not list((tmp_path / "run").glob(".*"))


def test_a_filter_that_matches_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert program.main(["--cells", "pyramid*", "--run", str(tmp_path)]) == program.NOTHING
    assert "no cell matches 'pyramid*'; there are: sphere-sphere apart" in capsys.readouterr().err


@pytest.mark.usefixtures("few")
def test_files_go_to_the_last_run_and_never_into_a_folder_in_its_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(program, "OUT", tmp_path)
    words = ["--quick", "--cells", "sphere-sphere apart"]
    program.main(words)
    assert (tmp_path / "narrow_phase" / ROWS).exists() and not (tmp_path / "latest").exists()
    (tmp_path / "run").mkdir()
    (tmp_path / "latest").symlink_to("run", target_is_directory=True)
    program.main(words)
    assert (tmp_path / "run" / ROWS).exists()


def test_only_those_called_per_query_have_the_cost_of_a_call() -> None:
    found = callers(QUICK, "cold", ("in_ours", "in_mujoco"))
    assert set(found) == {"ours/call", "mj geomDist default", "mj geomDist"}
    rows, identities, _ = measure(("in_ours",), [Cell("sphere", "sphere", "deep")], QUICK, lambda line: None)
    assert len(identities) == 3
    assert [each.engine for each in rows if each.call_us == each.call_us] == ["ours/call"] * 2


IDENTITY = Identity("lib", "lib", True, "asks")
CELL = Cell("box", "box", "deep")


def test_a_row_counts_what_is_over_and_what_is_missing() -> None:
    clocked = Clocked(np.full((3, 2), 2.5), np.array([[0.0, 1e-5], [1e-3, np.inf]]), np.full((3, 1), 0.5))
    made = row(CELL, "cold", IDENTITY, clocked, np.zeros((2, 2)))
    assert (made.us_p25, made.us_p50, made.us_p75, made.call_us) == (2.5, 2.5, 2.5, 0.5)
    assert (made.share_over_right, made.share_over_coarse, made.unanswered, made.judged, made.repeats) == (0.75, 0.5, 0.25, 4, 3)
    assert made.max_error_m == np.inf and not made.right


def test_a_row_of_who_failed_says_why_and_is_right_in_nothing() -> None:
    made = row(CELL, "cold", IDENTITY, Clocked(trouble="ValueError: no"), np.zeros((2, 2)))
    assert made.note == "not measured: ValueError: no" and made.us_p50 != made.us_p50 and not made.right
    assert csv_text([made]).splitlines()[1].endswith("nan,0,0,not measured: ValueError: no")


BASE = Row("box", "hull", "deep", "cold", "ours", "avatarsim", False, 2.0, 1.9, 2.1, np.nan, 1e-15, 0.0, 0.0, 0.0, 200, 9)


def made_up(theirs: float, error: float = 1e-9) -> list[Row]:
    other = replace(BASE, engine="lib fast", library="lib", per_call=True, us_p50=theirs, call_us=0.5, max_error_m=error)
    return [BASE, replace(BASE, engine="ours/call", per_call=True, us_p50=2.4, call_us=0.6), other]


def test_the_table_begins_with_what_is_lost() -> None:
    rows = made_up(1.5)
    text = report(rows, judged(rows), (0.01, 0.03))
    assert text.startswith("cold: 1 of 1 cells LOST, 0 hold.") and "\n  LOST box-hull deep 2.00 of lib fast\n" in text
    assert "*box-hull deep" in text and "lib fast 0.50" in text and "0.030 us" in text


def test_the_table_marks_who_is_not_right_and_fits_a_screen() -> None:
    rows = made_up(1.5, error=1e-3)
    rows += [replace(row, mode="coherent", regime="apart") for row in rows]
    text = report(rows, judged(rows), (0.01, 0.03))
    assert "  LOST " not in text and "1.50!" in text and "cold: 0 of 1 cells LOST, 1 hold." in text
    assert max(map(len, text.splitlines())) <= SCREEN


def test_defaults_stand_with_the_exactness_only() -> None:
    rows = made_up(1.5)
    rows.append(replace(rows[-1], engine="lib default", us_p50=7.0))
    text = report(rows, judged(rows), (0.01, 0.03))
    assert text.count("lib default") == 2 and "7.00       nan" in text


def test_files_are_replaced_whole(tmp_path: Path) -> None:
    write(tmp_path, made_up(3.0), {"half": float("nan")})
    write(tmp_path, made_up(3.0)[:2], {"whole": 1.0})
    assert len((tmp_path / ROWS).read_text().splitlines()) == 3
    assert json.loads((tmp_path / ABOUT).read_text()) == {"whole": 1.0}
