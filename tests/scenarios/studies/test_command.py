"""The command `study`: finished runs are not repeated, invalid input is rejected at the start."""

import csv
from pathlib import Path

from scenarios.__main__ import main
from scenarios.cli import study as command
from scenarios.run.gate import STOPPED
from tests.scenarios.studies.settings.fakes import Fakes

ASKED = ["study", "settings", "--filter", "stop_distance", "--engine", "mujoco", "--jobs", "0", "--frames", "3"]


def rows(out: Path, folder: str = command.CHECKPOINTS) -> list[dict[str, str]]:
    with (out / folder / "settings.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_second_run_repeats_nothing_and_writes_the_same(tmp_path: Path, fakes: Fakes) -> None:
    words = [*ASKED, "--out", str(tmp_path)]
    assert main(words) == 0
    first, asked = rows(tmp_path), len(fakes.requested)
    assert asked == len(fakes.timed) >= 11 and {row["status"] for row in first} == {"info"}
    assert main(words) == 0
    assert len(fakes.requested) == asked == len(fakes.timed) and rows(tmp_path) == first


def test_a_new_setting_is_run_alone(tmp_path: Path, fakes: Fakes) -> None:
    main([*ASKED, "--out", str(tmp_path)])
    fakes.requested.clear()
    mine = tmp_path / "mine.toml"
    mine.write_text('[mujoco.mine]\npreset = "tuned"\nkappa = 0.1\n')
    assert main([*ASKED, "--out", str(tmp_path), "--settings", str(mine)]) == 0
    assert fakes.requested == ["stop_distance mine"] and "mine" in {row["change"] for row in rows(tmp_path)}


def test_a_run_that_is_stopped_goes_on_where_it_was(tmp_path: Path, fakes: Fakes) -> None:
    fakes.stop_after = 4
    assert main([*ASKED, "--out", str(tmp_path)]) == STOPPED and len(fakes.requested) == 4
    fakes.stop_after = 1000
    before = list(fakes.requested)
    assert main([*ASKED, "--out", str(tmp_path)]) == 0
    assert not set(fakes.requested[4:]) & set(before) and {row["status"] for row in rows(tmp_path)} == {"info"}


def test_rows_go_into_the_last_comparison(tmp_path: Path, fakes: Fakes) -> None:
    (tmp_path / "latest").mkdir()
    assert main([*ASKED, "--out", str(tmp_path)]) == 0 and rows(tmp_path, "latest")


def test_a_real_setting_from_end_to_end(tmp_path: Path) -> None:
    words = ["study", "settings", "--filter", "stop_distance", "--engine", "avatarsim", "--preset", "paper", "--jobs", "0"]
    assert main([*words, "--frames", "2", "--out", str(tmp_path)]) == 0
    found = {row["metric"]: float(row["value"]) for row in rows(tmp_path) if row["value"]}
    assert found["residual_overlap_max"] == 0.0 and found["frame_time_p50"] > 0.0
