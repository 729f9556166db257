"""How a run of the command line ends when something is wrong, and how the next one goes on from there."""

import json
import os
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from scenarios import catalog
from scenarios.__main__ import main
from scenarios.job import Job, Outcome
from tests.scenarios.command_line import called, last, last_run, latest


def test_a_truncated_clip_ends_its_own_scene_and_no_other(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def cut() -> object:
        raise InvalidFile("humanoid3d_walk.txt", "ends within a frame", "whole frames of 44 numbers")

    good = catalog.get("ball_drop")
    both = {"ball_drop": good, "cut_short": replace(good, name="cut_short", build=cut)}
    monkeypatch.setattr(catalog, "scenarios", lambda: both)
    monkeypatch.setattr(catalog, "get", both.__getitem__)
    assert called(tmp_path, "check", "--engine", "tunnels") == 3
    notes = {row["scenario"]: row["note"] for row in latest(tmp_path)["rows"] if row["metric"] == "run"}
    assert list(notes) == ["cut_short"] and "humanoid3d_walk.txt" in notes["cut_short"] and "whole frames" in notes["cut_short"]
    assert (last_run(tmp_path) / "recordings" / "ball_drop.tunnels.default.0.npz").exists()


def test_a_run_goes_on_where_an_earlier_one_ended(site: Path, tmp_path: Path) -> None:
    called(tmp_path, "check", "--engine", "frozen", "--filter", "ball_drop", frames=40)
    folder = last_run(tmp_path)
    kept = folder / "recordings" / "ball_drop.frozen.default.0.npz"
    before = kept.stat().st_mtime_ns
    words = ["check", "--engine", "frozen", "tunnels", "--filter", "ball_drop", "--resume", str(folder)]
    assert called(tmp_path, *words, frames=40) == 1
    assert kept.stat().st_mtime_ns == before and len(list(kept.parent.iterdir())) == 2
    assert {row["engine"] for row in latest(tmp_path)["rows"]} == {"frozen", "tunnels"}
    assert called(tmp_path, *words[:-1], str(tmp_path / "nowhere")) == 2


def test_a_command_that_asks_for_less_than_the_run_it_resumes_is_refused(
    site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str],
) -> None:
    """With the rows of what it does not ask for, their timings would be gone."""
    both = ["run", "--engine", "frozen", "tunnels", "--filter", "ball_drop"]
    called(tmp_path, *both, "--seed", "0", "1")
    folder = last_run(tmp_path)
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    for words in (
        ["run", "--engine", "frozen", "--filter", "ball_drop", "--seed", "0", "1"], both, [*both, "--seed", "1", "2"],
        ["run", "--engine", "frozen", "tunnels", "--filter", "bounce_ladder", "--seed", "0", "1"],
        [*both, "--seed", "0", "1", "--full"], [*both, "--seed", "0", "1", "--preset", "other"],
    ):
        assert called(tmp_path, *words, "--resume", str(folder)) == 2, words
        assert f"python -m scenarios {' '.join(both)} --seed 0 1" in capsys.readouterr().err
    assert called(tmp_path, *both, "--seed", "0", "1", "--resume", str(folder), frames=5) == 2
    assert "frames 6" in capsys.readouterr().err
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    assert called(tmp_path, *both, "--seed", "0", "1", "2", "--resume", str(folder)) == 0
    assert {row["seed"] for row in latest(tmp_path)["rows"]} == {0, 1, 2}


def test_own_settings_of_another_content_are_another_run(
    site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "mine.toml"
    words = ["run", "--engine", "frozen", "--filter", "ball_drop", "--settings", str(path)]
    path.write_text("[frozen.mine]\ngain = 1.0\n")
    called(tmp_path, *words)
    folder = last_run(tmp_path)
    path.write_text("[frozen.mine]\ngain = 2.0\n")
    assert called(tmp_path, *words, "--resume", str(folder)) == 2
    assert "gain" in capsys.readouterr().err


def test_results_of_a_whole_run_stay_until_what_resumes_it_has_ended(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    from scenarios.run import harness

    called(tmp_path, "run", "--engine", "frozen", "--filter", "ball_drop")
    folder = last_run(tmp_path)
    before = (folder / "results.json").read_bytes()

    def stopped(job: Job, folder: Path) -> Outcome:
        raise KeyboardInterrupt

    monkeypatch.setattr(harness, "accuracy", stopped)
    assert called(tmp_path, "run", "--engine", "frozen", "tunnels", "--filter", "ball_drop", "--resume", str(folder)) == 130
    assert (folder / "results.json").read_bytes() == before


def test_halves_of_a_killed_run_are_removed_when_it_is_resumed(site: Path, tmp_path: Path) -> None:
    called(tmp_path, "check", "--engine", "frozen", "--filter", "ball_drop")
    folder = last_run(tmp_path)
    # no process has so large a number
    dead, mine = (folder / "recordings" / f".half.npz.{number}" for number in (2**30, os.getpid()))
    dead.write_bytes(b"PK")
    mine.write_bytes(b"PK")
    called(tmp_path, "check", "--engine", "frozen", "--filter", "ball_drop", "--resume", str(folder))
    assert not dead.exists() and mine.exists()


@pytest.mark.parametrize("option", ["--out", "--resume", "--settings"])
def test_an_empty_path_is_wrong_usage(site: Path, tmp_path: Path, option: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    assert main(["check", "--engine", "tunnels", "--filter", "ball_drop", "--frames", "3", "--jobs", "0", option, ""]) == 2
    assert sorted(tmp_path.rglob("*")) == before


def test_a_run_that_is_stopped_keeps_what_was_finished(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:
    from scenarios.run import harness

    real = harness.accuracy

    def stopped(job: Job, folder: Path) -> Outcome:
        if job.engine == "tunnels":
            raise KeyboardInterrupt
        return real(job, folder)

    monkeypatch.setattr(harness, "accuracy", stopped)
    assert called(tmp_path, "check", "--engine", "frozen", "tunnels", "--filter", "ball_drop", frames=40) == 130
    line, err = last(capsys)
    assert not list((tmp_path / "out").glob("latest*")), "they lead to runs that have ended"
    (folder,) = (tmp_path / "out").iterdir()
    assert line.startswith("avatarsim: exit code 130 (stopped before the end)") and f"--resume {folder}" in err
    found = json.loads((folder / "results.json").read_text())
    assert found["exit_code"] is None and {row["engine"] for row in found["rows"]} == {"frozen"}
    assert [path.name for path in (folder / "recordings").iterdir()] == ["ball_drop.frozen.default.0.npz"]


@pytest.mark.parametrize("out", ["/proc/foo", "/dev/null/x", "a_file"])
def test_a_folder_that_cannot_be_made_is_wrong_usage(
    site: Path, tmp_path: Path, out: str, capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "a_file").write_text("mine")
    words = ["check", "--engine", "tunnels", "--filter", "ball_drop", "--frames", "3", "--jobs", "0", "--out"]
    assert main([*words, str(tmp_path / out)]) == 2
    line, err = last(capsys)
    assert err.strip().startswith("InvalidInput: --out is ") and "\n" not in err.strip() and "exit code 2" in line


def test_a_full_disk_is_one_sentence_and_3(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:
    def full(known: object, folder: Path) -> None:
        raise OSError(28, "No space left on device", str(folder / "results.json"))

    monkeypatch.setattr("scenarios.run.results.write", full)
    assert called(tmp_path, "check", "--engine", "tunnels", "--filter", "ball_drop") == 3
    line, err = last(capsys)
    assert "results.json: No space left on device" in err and "\n" not in err.strip() and "exit code 3" in line


def test_where_nothing_was_gated_nothing_has_held(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(tmp_path, "compare", "--engine", "tunnels", "--preset", "other", "--filter", "ball_drop", jobs=1) == 0
    line, _ = last(capsys)
    assert line.startswith("avatarsim: exit code 0 (nothing was gated), report: ")


def test_the_same_seed_or_engine_twice_is_one_run(site: Path, tmp_path: Path) -> None:
    called(tmp_path, "check", "--engine", "frozen", "frozen", "--filter", "ball_drop", "--seed", "0", "0")
    assert len(latest(tmp_path)["engines"]) == 1


def test_an_error_names_the_wrong_option_only(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(tmp_path, "check", frames=0) == 2
    assert "--jobs" not in (err := capsys.readouterr().err) and "--frames is 0" in err


def test_list_names_the_scenes_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--filter", "zzz"]) == 5
    assert "ball_drop" in capsys.readouterr().err


def test_settings_on_a_preset_that_the_engine_has_not_got(site: Path, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    for text in ('[tunnels.mine]\npreset = "nowhere"\n', '[tunnels."a b"]\n', '[tunnels."\u00e9"]\n', '[tunnels.""]\n'):
        path.write_text(text, encoding="utf-8")
        assert called(tmp_path, "check", "--engine", "tunnels", "--filter", "ball_drop", "--settings", str(path)) == 2
    path.write_text('[tunnels."gain=2.5"]\n')
    assert called(tmp_path, "check", "--engine", "tunnels", "--filter", "ball_drop", "--settings", str(path)) == 3
    assert [entry["preset"] for entry in latest(tmp_path)["engines"]] == ["default", "gain=2.5"]


def test_a_missing_engine_names_every_row_that_is_missing(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # what python does for a package that is not there
    monkeypatch.setitem(sys.modules, "pybullet", None)
    for name in [name for name in sys.modules if name.startswith("reference.in_pybullet")]:
        monkeypatch.delitem(sys.modules, name)
    assert called(tmp_path, "compare", "--engine", "pybullet", "--filter", "ball_drop") == 3
    rows = latest(tmp_path)["rows"]
    said = "pybullet is not installed: `make setup` says why"
    found = [(row["preset"], row["status"], row["note"]) for row in rows]
    assert found == [(preset, "not-measured", said) for preset in ("default", "tuned")]
