"""The command: a table on the screen and in files, other engines run once, and a sentence for every wrong name."""

from pathlib import Path

import pytest

from scenarios.posture_table import __main__ as command
from scenarios.posture_table.__main__ import main
from scenarios.posture_table.plan import drawn_seed

SMALL = ["--scenes", "teleport,unseen_floor", "--rooms", "floor", "--seeds", "1", "--seed", "5", "--frames", "6"]


def test_presets_and_another_engine_in_one_table_and_the_other_is_run_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(command, "FOLDER", tmp_path / "kept")
    asked = [*SMALL, "--presets", "default", "paper", "--rivals", "tracker/default", "--beside", "default", "--worst", "1"]
    assert main([*asked, "--repeats", "1", "-o", str(tmp_path / "table.md")]) == 0
    first = capsys.readouterr()
    assert ["postures", "6/6"] in [line.split()[:2] for line in first.err.splitlines()] and "seed 5" in first.out
    rows = [line for line in first.out.splitlines() if line.startswith(("| avatarsim", "| tracker")) and " frame " in line]
    assert [line.split("|")[1].strip() for line in rows] == ["avatarsim/default", "avatarsim/paper", "tracker/default"] * 2
    assert first.out.count("| avatarsim/paper") == 4 and "Worst moments of paper:" in first.out
    assert (tmp_path / "table.md").read_text() == first.out
    assert main([*asked, "-o", str(tmp_path / "table.csv")]) == 0
    again = capsys.readouterr()
    assert ["postures", "4/4"] in [line.split()[:2] for line in again.err.splitlines()]
    head, *lines = (tmp_path / "table.csv").read_text().splitlines()
    assert head.startswith("engine,group,runs,frames,overlap,") and len(lines) == 6
    # its times are those of the first run, which no second run would give again
    same = [[line.split() for line in said.splitlines() if line.startswith("| tracker") and " frame " in line]
            for said in (first.out, again.out)]
    assert same[0] == same[1] and len(same[0]) == 2


def test_a_run_that_crashes_is_named_and_the_others_stand(
    site: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(command, "FOLDER", tmp_path / "kept")
    assert main([*SMALL, "--groups", "catalogue", "--scenes", "teleport", "--rivals", "raises/default"]) == 3
    said = capsys.readouterr().out
    assert "teleport, raises/default: crashed:" in said and "| avatarsim/default" in said


@pytest.mark.parametrize(("asked", "named"), [
    (["--presets", "no"], "paper"), (["--rivals", "tracker/no"], "default"), (["--rivals", "nobody/default"], "nobody"),
    (["--rooms", "cellar"], "corridor"), (["--scenes", "telport"], "telport"), (["--seeds", "0"], "1 at least"),
    (["--seed", "-1"], "0 at least"), (["-o", "table.txt"], ".csv"), (["--beside", "paper"], "default"),
    (["--groups", "probes"], "--clips"), (["--clips", "/nowhere"], "--clips"), (["--frames", "0"], "1 at least"),
])
def test_what_cannot_be_asked_is_named_with_what_can(asked: list[str], named: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(asked) == 2
    assert named in capsys.readouterr().err


def test_seeds_are_drawn_afresh() -> None:
    assert len({drawn_seed() for _ in range(8)}) > 1


def test_quick_is_a_third_of_motions_and_frames(capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["--groups", "rooms", "--rooms", "floor", "--seeds", "3", "--seed", "5", "--quick", "--repeats", "0"]
    assert main(asked) == 0
    (row,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("| avatarsim")]
    assert [cell.strip() for cell in row.split("|")[2:5]] == ["unseen_floor", "1", "200"]
