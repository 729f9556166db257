"""The command: only what is not known is asked, whatever stopped the run before, and bad input is said in one line."""

import csv
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from scenarios.__main__ import main
from scenarios.cli import sweep as command
from scenarios.job import Job
from scenarios.results.gate import INCOMPLETE, NOTHING, STOPPED, USAGE
from scenarios.results.store import Entry
from scenarios.studies.sweep import clock, measure
from scenarios.studies.sweep.cell import Cell
from tests.scenarios.studies.sweep.grids import GRIDS

ASKED = ["sweep", "--filter", "stop_distance", "--engine", "mujoco", "--jobs", "0", "--frames", "3"]


class Counted:
    """Stands in for both passes, counts what it is asked, and stops where it is told to."""

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

    def clock(self, jobs: list[Job], full: bool, frames: list[int], seats: list[object], repeats: int) -> list[object]:
        import numpy as np

        from scenarios.measure.timing import Timed
        from scenarios.running.timing import Clocked

        self.timed += [job.preset for job in jobs]
        timed = [Timed(np.full((repeats, count), 5000, dtype=np.int64)) for count in frames]
        return [Clocked(job, found, f"{repeats} repeats") for job, found in zip(jobs, timed, strict=True)]


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Iterator[Counted]:
    yield Counted(monkeypatch)


def rows(out: Path) -> list[dict[str, str]]:
    with (out / "sweep" / "sweep.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_second_run_asks_nothing_and_says_the_same(tmp_path: Path, counted: Counted) -> None:
    assert main([*ASKED, "--out", str(tmp_path)]) == 0
    first, asked = rows(tmp_path), len(counted.asked)
    assert asked == len(counted.timed) >= 11 and {row["state"] for row in first} == {"measured"}
    about = tmp_path / "sweep" / "sweep.json"
    assert json.loads(about.read_text()) == {"form": "long", "settings": asked, "kept": 0}
    assert main([*ASKED, "--out", str(tmp_path)]) == 0
    assert len(counted.asked) == asked == len(counted.timed) and rows(tmp_path) == first
    assert json.loads(about.read_text())["kept"] == asked


def test_what_changed_is_asked_alone(tmp_path: Path, counted: Counted, monkeypatch: pytest.MonkeyPatch) -> None:
    main([*ASKED, "--out", str(tmp_path)])
    counted.asked.clear()
    mine = tmp_path / "mine.toml"
    mine.write_text('[mujoco.mine]\npreset = "tuned"\nkappa = 0.1\n')
    assert main([*ASKED, "--out", str(tmp_path), "--settings", str(mine)]) == 0
    assert counted.asked == ["mine"] and rows(tmp_path)[-1]["setting"] == "mine"


def test_a_run_that_is_stopped_goes_on_where_it_was(tmp_path: Path, counted: Counted) -> None:
    counted.stop_after = 4
    assert main([*ASKED, "--out", str(tmp_path)]) == STOPPED
    assert len(counted.asked) == 4 and {row["state"] for row in rows(tmp_path)} == {"measured", "not-measured"}
    counted.stop_after = 1000
    before = list(counted.asked)
    assert main([*ASKED, "--out", str(tmp_path)]) == 0
    assert not set(counted.asked[4:]) & set(before) and {row["state"] for row in rows(tmp_path)} == {"measured"}


def test_a_run_that_is_killed_loses_nothing_it_had_finished(tmp_path: Path, counted: Counted) -> None:
    script = (
        "import os, signal, sys\nfrom scenarios.__main__ import main\nfrom scenarios.studies.sweep import measure\n"
        "real, asked = measure.errors, []\n"
        "def errors(job):\n    asked.append(job)\n    if len(asked) == 4:\n        os.kill(os.getpid(), signal.SIGKILL)\n"
        "    return {'run': job.run, 'scenario': job.scenario, 'state': 'measured', 'note': '', 'frames': 3, 'missing': {},\n"
        "            'values': {'residual_overlap_max': 0.5}}\n"
        "measure.errors = errors\nmain(sys.argv[1:])\n"
    )
    words = [sys.executable, "-c", script, *ASKED, "--out", str(tmp_path)]
    ended = subprocess.run(words, capture_output=True, env=os.environ.copy())
    assert ended.returncode == -9
    assert main([*ASKED, "--out", str(tmp_path)]) == 0
    kept = [row for row in rows(tmp_path) if row["metric"] == "residual_overlap_max" and row["error"] == "0.5"]
    assert len(kept) == 3 and len(counted.asked) == len({row["setting"] for row in rows(tmp_path)}) - 3


@pytest.mark.parametrize(("words", "code"), [
    (["--engine", "abacus"], USAGE), (["--filter", "nowhere"], NOTHING), (["--jobs", "-1"], USAGE), (["--frames", "0"], USAGE),
    (["--settings", "nowhere.toml"], USAGE),
])
def test_bad_input_is_refused_at_the_door(
    tmp_path: Path, words: list[str], code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", "--filter", "stop_distance", "--engine", "mujoco", *words, "--out", str(tmp_path)]) == code
    assert not (tmp_path / "sweep").exists() and capsys.readouterr().err


def test_a_file_where_the_folder_should_be(tmp_path: Path) -> None:
    (tmp_path / "sweep").write_text("")
    assert main([*ASKED, "--out", str(tmp_path)]) == USAGE


def test_rows_go_beside_the_last_run_too_and_an_absent_engine_is_said(
    tmp_path: Path, counted: Counted, monkeypatch: pytest.MonkeyPatch
) -> None:
    from scenarios.running.harness import Offer

    (tmp_path / "latest").mkdir()
    monkeypatch.setattr(command, "offers", lambda names, workers: {n: Offer(("default", "tuned")) for n in names} | {
        "pybullet": Offer(trouble="pybullet is not installed")})
    assert main([*ASKED, "--engine", "pybullet", "--out", str(tmp_path)]) == INCOMPLETE
    assert (tmp_path / "latest" / "sweep.csv").read_text() == (tmp_path / "sweep" / "sweep.csv").read_text()


def test_a_real_cell_from_end_to_end(tmp_path: Path) -> None:
    words = ["sweep", "--filter", "stop_distance", "--engine", "avatarsim", "--preset", "paper", "--jobs", "2", "--frames", "2"]
    ran = main([*words, "--out", str(tmp_path)])
    found = rows(tmp_path)
    assert ran == 0 and {row["setting"] for row in found} == {"paper"} and all(float(row["p50"]) > 0.0 for row in found)
    assert {row["metric"]: float(row["error"]) for row in found}["residual_overlap_max"] == 0.0


def test_cells_are_named_apart() -> None:
    cells = [Cell("stop_distance", setting) for settings in GRIDS.values() for setting in settings]
    assert len({cell.job.stem for cell in cells}) == len(cells) == len({cell.key for cell in cells})
