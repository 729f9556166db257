"""The command `study`: finished runs are not repeated, bad input is refused at the door."""

import csv
from pathlib import Path

import numpy as np
import pytest

from scenarios.__main__ import main
from scenarios.cli import study as command
from scenarios.job import Job
from scenarios.measure.timing import Round, Timed
from scenarios.run.gate import NOTHING, STOPPED, USAGE
from scenarios.run.timing import Clocked
from scenarios.studies.checkpoint import Entry
from scenarios.studies.settings import clock, measure

ASKED = ["study", "settings", "--filter", "stop_distance", "--engine", "mujoco", "--jobs", "0", "--frames", "3"]


class Counted:
    """Stands in for both passes, counts the jobs, and stops after some of them."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.asked: list[str] = []
        self.timed: list[str] = []
        self.stop_after = 1000
        patch.setattr(measure, "errors", self.errors)
        patch.setattr(clock, "timed_pass", self.clock)

    def errors(self, job: Job) -> Entry:
        if len(self.asked) == self.stop_after:
            raise KeyboardInterrupt
        self.asked.append(job.preset)
        values = {"stop_distance_error_max": 1.0, "residual_overlap_max": 0.0}
        return {"run": job.run, "state": "measured", "note": "", "frames": 3, "values": values, "missing": {}}

    def clock(self, jobs: list[Job], full: bool, plan: list[Round], workers: list[object]) -> list[Clocked]:
        self.timed += [job.preset for job in jobs]
        shapes = [(each.repeats, each.frames) for each in plan]
        return [Clocked(job, Timed(np.full(shape, 5000, dtype=np.int64))) for job, shape in zip(jobs, shapes, strict=True)]


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Counted:
    return Counted(monkeypatch)


def rows(out: Path, folder: str = command.CHECKPOINTS) -> list[dict[str, str]]:
    with (out / folder / "settings.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_second_run_repeats_nothing_and_writes_the_same(tmp_path: Path, counted: Counted) -> None:
    words = [*ASKED, "--out", str(tmp_path)]
    assert main(words) == 0
    first, asked = rows(tmp_path), len(counted.asked)
    assert asked == len(counted.timed) >= 11 and {row["status"] for row in first} == {"info"}
    assert main(words) == 0
    assert len(counted.asked) == asked == len(counted.timed) and rows(tmp_path) == first


def test_a_new_setting_is_run_alone(tmp_path: Path, counted: Counted) -> None:
    main([*ASKED, "--out", str(tmp_path)])
    counted.asked.clear()
    mine = tmp_path / "mine.toml"
    mine.write_text('[mujoco.mine]\npreset = "tuned"\nkappa = 0.1\n')
    assert main([*ASKED, "--out", str(tmp_path), "--settings", str(mine)]) == 0
    assert counted.asked == ["mine"] and "mine" in {row["change"] for row in rows(tmp_path)}


def test_a_run_that_is_stopped_goes_on_where_it_was(tmp_path: Path, counted: Counted) -> None:
    counted.stop_after = 4
    assert main([*ASKED, "--out", str(tmp_path)]) == STOPPED and len(counted.asked) == 4
    counted.stop_after = 1000
    before = list(counted.asked)
    assert main([*ASKED, "--out", str(tmp_path)]) == 0
    assert not set(counted.asked[4:]) & set(before) and {row["status"] for row in rows(tmp_path)} == {"info"}


@pytest.mark.parametrize(("words", "code"), [
    (["--engine", "abacus"], USAGE), (["--filter", "nowhere"], NOTHING), (["--jobs", "-1"], USAGE), (["--frames", "0"], USAGE),
    (["--settings", "nowhere.toml"], USAGE), (["--resume", "run"], USAGE),
])
def test_bad_input_is_refused_at_the_door(tmp_path: Path, words: list[str], code: int) -> None:
    assert main(["study", "settings", "--filter", "stop_distance", "--engine", "mujoco", *words, "--out", str(tmp_path)]) == code
    assert not list(tmp_path.rglob("*.csv"))


def test_an_unknown_study_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "weather", "--out", str(tmp_path)]) == USAGE
    said = capsys.readouterr().err
    assert "weather" in said and "hard_cases" in said


def test_rows_go_into_the_last_comparison(tmp_path: Path, counted: Counted) -> None:
    (tmp_path / "latest").mkdir()
    assert main([*ASKED, "--out", str(tmp_path)]) == 0 and rows(tmp_path, "latest")


def test_a_real_setting_from_end_to_end(tmp_path: Path) -> None:
    words = ["study", "settings", "--filter", "stop_distance", "--engine", "avatarsim", "--preset", "paper", "--jobs", "2"]
    assert main([*words, "--frames", "2", "--out", str(tmp_path)]) == 0
    found = {row["metric"]: float(row["value"]) for row in rows(tmp_path) if row["value"]}
    assert found["residual_overlap_max"] == 0.0 and found["frame_time_p50"] > 0.0
