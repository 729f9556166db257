"""Rows, table and command of the map."""

import math
from pathlib import Path

import pytest

from runfiles.csv_rows import csv_text
from scenarios.job import Job
from scenarios.law_map import __main__ as command
from scenarios.law_map import worlds
from scenarios.law_map.rows import Row, summed_up, table
from scenarios.results.gate import STOPPED


def test_figures_are_summed_up_and_missing_ones_counted() -> None:
    assert summed_up([0.3, 0.1, 0.2]) == (0.2, 0.1, 0.3, "") and summed_up([0.1, 0.3])[0] == pytest.approx(0.2)
    middle, low, high, note = summed_up([math.nan, 0.5])
    assert (middle, low, high) == (0.5, 0.5, 0.5) and "1 of 2" in note and math.isnan(summed_up([math.nan])[0])


def test_the_worst_of_all_bodies_counts() -> None:
    row = Row("friction", "sphere", "a", "b", 60, 0.5, 0.5, 0.4, 0.55, "")
    assert row.worst == pytest.approx(0.1) and row.run == "a/b"
    lost = Row("friction", "sphere", "a", "b", 60, 0.8, math.nan, math.nan, math.nan, "died")
    assert math.isnan(lost.worst) and csv_text([lost], Row).splitlines()[1] == "friction,sphere,a,b,60,0.8,,,,died"
    text = table([row, lost])
    assert "1/60" in text and "0.500       -" in text and text.endswith("nan")


ASKED = ["--engine", "avatarsim", "mujoco", "--law", "friction", "--shape", "sphere", "--quick", "--jobs", "0"]


def test_a_second_run_asks_nothing_and_a_stopped_one_keeps_what_it_had(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def obtained(job: Job) -> list[Row]:
        if len(asked) == 2:
            raise KeyboardInterrupt
        asked.append(job.scenario + job.run)
        nan, asked_of = math.nan, worlds.ASKED["friction"]
        lost = [Row("friction", "sphere", job.engine, job.preset, 60, mu, nan, nan, nan, "lost") for mu in asked_of[:1]]
        return lost + [Row("friction", "sphere", job.engine, job.preset, 60, mu, mu, mu, mu, "") for mu in asked_of[1:]]

    monkeypatch.setattr(command, "obtained", obtained)
    words = ["--run", str(tmp_path / "latest"), *ASKED]
    assert command.main(words) == STOPPED and not (tmp_path / "latest" / "law_map.csv").exists()
    before, asked[:] = list(asked), []
    assert command.main(words) == STOPPED
    asked_again, asked[:] = list(asked), []
    assert command.main(words) == 0 and not set(before) & set(asked_again) and len(before + asked_again + asked) == 6
    asked[:] = []
    written = (tmp_path / "latest" / "law_map.csv").read_text()
    assert command.main(words) == 0 and asked == [] and (tmp_path / "latest" / "law_map.csv").read_text() == written
    # ours with one preset, two steps, seven coefficients
    assert len((tmp_path / "latest" / "law_map.csv").read_text().splitlines()) == 1 + 3 * 2 * 7


def test_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command.main(["--run", str(tmp_path), "--engine", "abacus"]) == 2 and "abacus" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        command.main(["--run", str(tmp_path), "--law", "gravity"])


def test_an_engine_that_dies_is_rows_without_figures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from avatarsim.running.processes import Died

    monkeypatch.setattr(command, "side_by_side", lambda function, todo, workers: [(job, Died("it fell over")) for job in todo])
    assert command.main(["--run", str(tmp_path / "latest"), *ASKED]) == 0
    assert "it fell over" in (tmp_path / "latest" / "law_map.csv").read_text()
