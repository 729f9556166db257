"""The command line: exit codes, the last line, what stands on the screen and what in the files."""

import csv
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from runfiles.timing_protocol import REPEATS, WARM_FRAMES
from scenarios import catalog
from scenarios.__main__ import main
from scenarios.measure.timing import TAIL
from tests.scenarios.command_line import called, last, last_run, latest

ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.usefixtures("easy")
def test_0_when_every_check_passes(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(tmp_path, "check", "--engine", "tunnels") == 0
    line, _ = last(capsys)
    assert line.startswith("avatarsim: exit code 0 (2 of 2 checks pass), report: ") and str(tmp_path) in line
    assert latest(tmp_path)["exit_code"] == 0


def test_1_when_a_gated_bound_failed(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(tmp_path, "check", "--engine", "frozen", "--filter", "ball_drop", frames=40) == 1
    out = capsys.readouterr().out
    assert out.strip().splitlines()[-1].startswith("avatarsim: exit code 1 (")
    assert "2 fail" in out and "ball_drop" in out.partition("failed\n")[2]


def test_1_wins_over_3(site: Path, tmp_path: Path) -> None:
    assert called(tmp_path, "check", "--engine", "frozen", "absent", "--filter", "ball_drop", frames=40) == 1


@pytest.mark.parametrize("words", [
    ["check", "--engine", "nobody"], ["run", "no_such_scene"], ["check", "--engine", "frozen", "--preset", "fastest"],
    ["check", "--settings", "no_such_file.toml"], ["check", "--jobs", "-1"], ["check", "--jobs", "many"], ["dance"], [],
])
def test_2_for_wrong_usage(site: Path, tmp_path: Path, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*words, "--out", str(tmp_path / "out")] if words else []) == 2
    assert not (tmp_path / "out").exists(), "nothing is begun"
    assert capsys.readouterr().err


def test_2_names_the_thing_and_what_there_is(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(tmp_path, "compare", "--engine", "nobody") == 2
    line, err = last(capsys)
    assert "engine is 'nobody'" in err and "mujoco" in err and "frozen" in err
    assert line == "avatarsim: exit code 2 (wrong usage), report: none"
    assert called(tmp_path, "run", "ball_dorp") == 2
    assert "'ball_dorp'" in (err := capsys.readouterr().err) and "ball_drop" in err


@pytest.mark.parametrize(("engine", "status"), [("absent", "not-measured"), ("raises", "crashed"), ("no_engine", "not-measured")])
def test_3_when_an_engine_is_missing_or_crashed(site: Path, tmp_path: Path, engine: str, status: str) -> None:
    assert called(tmp_path, "check", "--engine", engine, "--filter", "ball_drop") == 3
    assert [row["status"] for row in latest(tmp_path)["rows"]] == [status]


def test_3_when_a_bound_was_not_measured(site: Path, tmp_path: Path) -> None:
    # the ball has not come down after six frames: no engine's fault, and no pass
    assert called(tmp_path, "check", "--engine", "tunnels", "--filter", "ball_drop") == 3


def test_5_when_one_of_several_patterns_matches_nothing(
    site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A list with a misspelt name must not be answered with "all held"."""
    assert called(tmp_path, "check", "--filter", "ball_drop, nosuch,none_*") == 5
    err = last(capsys)[1]
    assert "no scene matches 'nosuch'; there are " in err and "no scene matches 'none_*'; there are " in err


def test_5_when_the_filter_matches_nothing(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(tmp_path, "check", "--filter", "no_such_*") == 5
    line, err = last(capsys)
    assert line == "avatarsim: exit code 5 (a name or pattern of the filter matched no scene), report: none"
    assert "ball_drop" in err


@pytest.mark.usefixtures("easy")
def test_a_report_that_fails_costs_nothing_but_itself(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("a chart without a scale")

    monkeypatch.setattr("reports.write_report", broken)
    assert called(tmp_path, "check", "--engine", "tunnels") == 3
    found = latest(tmp_path)
    assert found["exit_code"] == 3 and "a chart without a scale" in found["notes"][0]
    assert {row["status"] for row in found["rows"]} == {"pass", "info"}


def test_the_report_is_written_before_the_code_is_returned(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []

    def read(run_dir: Path, *_: object) -> None:
        seen.append(json.loads((run_dir / "results.json").read_text())["exit_code"])

    monkeypatch.setattr("reports.write_report", read)
    assert called(tmp_path, "check", "--engine", "frozen", "--filter", "ball_drop", frames=40) == 1
    assert seen == [1]


def test_settings_of_a_strangers_own_appear_as_a_row(site: Path, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('[tunnels.brisk]\npreset = "other"\ngain = 2.5\n')
    called(tmp_path, "check", "--engine", "tunnels", "--filter", "ball_drop", "--settings", str(path))
    engines = latest(tmp_path)["engines"]
    assert [entry["preset"] for entry in engines] == ["default", "brisk"] and engines[1]["settings"]["gain"] == 2.5


WRONG = ("[nobody.x]\n", "[tunnels]\ngain = 1\n", "[tunnels.default]\n", "[tunnels.'a/b']\n", "= 3", "", "[tunnels]")


@pytest.mark.parametrize("text", WRONG)
def test_wrong_settings_are_refused_before_anything_runs(site: Path, tmp_path: Path, text: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    assert called(tmp_path, "check", "--engine", "tunnels", "--filter", "ball_drop", "--settings", str(path)) == 2
    assert not (tmp_path / "out").exists()


def test_json_stands_alone(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    called(tmp_path, "check", "--engine", "frozen", "--filter", "ball_drop", "--json", frames=40)
    said = capsys.readouterr()
    assert {row["metric"] for row in json.loads(said.out)} >= {"residual_overlap_max", "restitution_error_max"}
    assert said.err.strip().splitlines()[-1].startswith("avatarsim: exit code 1")


def test_list_and_metrics(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--effects", "--filter", "ball_drop"]) == 0
    out = capsys.readouterr().out
    assert "ball_drop" in out and "restitution      " in out and "left out" not in out.split("ball_drop")[1]
    assert main(["metrics"]) == 0
    assert "residual_overlap_max" in capsys.readouterr().out
    assert main(["list", "--filter", "nothing"]) == 5


def test_list_and_metrics_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--json", "--effects", "--filter", "ball_drop"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)
    assert entry["name"] == "ball_drop" and "restitution" in entry["effects"] and entry["switched_off"] == []
    assert main(["metrics", "--json"]) == 0
    assert {"residual_overlap_max": "m"}.items() <= {
        row["metric"]: row["unit"] for row in json.loads(capsys.readouterr().out)
    }.items()


def test_without_a_filter_times_are_those_of_everyday_scenes_and_a_comparison_takes_all(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    drop = catalog.get("ball_drop")
    both = {"ball_drop": drop, "rare": replace(drop, name="rare", everyday=False)}
    monkeypatch.setattr(catalog, "scenarios", lambda: both)
    monkeypatch.setattr(catalog, "get", both.__getitem__)
    for beside in ("unseen", "drawn_crowds"):
        monkeypatch.setattr(f"scenarios.{beside}.scenarios", lambda: {})

    def taken(*words: str) -> set[str]:
        called(tmp_path, *words, "--engine", "tunnels", "--preset", "default", frames=2)
        return {row["scenario"] for row in latest(tmp_path)["rows"]}

    assert taken("bench") == {"ball_drop"}
    both["two_arms"] = replace(drop, name="two_arms", everyday=False)
    assert taken("bench") == {"ball_drop", "two_arms"}
    assert taken("compare", "--filter", "rar*,two_*") == {"rare", "two_arms"}
    del both["two_arms"]
    everything = {"ball_drop", "rare"}
    assert taken("compare") == taken("bench", "--filter", "*") == taken("compare", "--full") == taken("check") == everything


def test_many_scenes_get_a_glance_in_a_comparison_and_all_their_frames_in_a_bench(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scenarios.run.harness.QUICK_FROM", 1)
    drop = replace(catalog.get("ball_drop"), everyday=False)
    monkeypatch.setattr(catalog, "scenarios", lambda: {"ball_drop": drop})
    monkeypatch.setattr(catalog, "get", lambda name: drop)
    monkeypatch.setattr("scenarios.run.timing.CHEAP_TIME", 0.0)
    monkeypatch.setattr("scenarios.run.timing.LEAST_FRAMES", 25)
    monkeypatch.setattr("scenarios.run.timing.ROUND_TIME", 0.0)
    for command, rounds in (("bench", f"{REPEATS} x 40"), ("compare", "1 x 25")):
        called(tmp_path, command, "--engine", "tunnels", "--preset", "default", "--filter", "ball_drop", frames=40)
        found = latest(tmp_path)
        times = [row for row in found["rows"] if row["metric"].startswith("frame_time")]
        assert all(row["note"].startswith(f"{rounds} frames, {WARM_FRAMES} warm-up frames") for row in times) and len(times) > 4
        # neither is enough for a tail, which its row says instead
        assert {row["metric"] for row in times if row["value"] is None} == set(TAIL)
        assert found["provenance"]["timing"]["repeats"] == REPEATS
        kept = list(csv.DictReader((last_run(tmp_path) / "bench.csv").read_text().splitlines()))
        [said] = [row["note"] for row in kept if row["metric"] == "frame_time_p50"]
        assert said == f"{rounds} frames, {WARM_FRAMES} warm-up frames"


def test_a_scene_that_every_engine_refuses_has_no_times_and_ends_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scenarios.run.harness.QUICK_FROM", 1)
    words = ["compare", "--engine", "avatarsim", "--preset", "default", "--filter", "coincident_start,ball_drop"]
    called(tmp_path, *words, frames=2)
    found = latest(tmp_path)
    timed = {row["scenario"] for row in found["rows"] if row["metric"] == "frame_time_p50" and row["value"] is not None}
    assert timed == {"ball_drop"} and found["exit_code"] is not None


def test_every_preset_and_seed_is_a_run_of_its_own(site: Path, tmp_path: Path) -> None:
    words = ["check", "--engine", "tunnels", "--filter", "ball_drop", "--preset", "default", "other", "--seed", "1", "2"]
    called(tmp_path, *words)
    found = {(entry["preset"], entry["seed"]) for entry in latest(tmp_path)["engines"]}
    assert found == {("default", 1), ("default", 2), ("other", 1), ("other", 2)}
    names = sorted(path.name for path in (last_run(tmp_path) / "recordings").iterdir())
    assert names == sorted(f"ball_drop.tunnels.{preset}.{seed}.npz" for preset, seed in found)


def test_a_whole_comparison_in_processes_of_their_own(site: Path, tmp_path: Path) -> None:
    """Both passes through the real command: an engine that dies, one that is missing, one that talks, one that works."""
    command = [sys.executable, "-m", "scenarios", "compare", "--engine", "talks", "dies", "absent", "--filter", "ball_drop"]
    command += ["--preset", "default", "--frames", "12", "--jobs", "2", "--out", str(tmp_path / "out")]
    ran = subprocess.run(
        command, cwd=ROOT, env={**os.environ, "PYTHONPATH": str(site)}, capture_output=True, text=True, timeout=120, check=False,
    )
    assert ran.returncode == 3, ran.stderr
    assert "WELCOME" not in ran.stdout
    assert ran.stdout.strip().splitlines()[-1].startswith("avatarsim: exit code 3")
    passes = {line.split()[0]: line.split()[1] for line in ran.stderr.splitlines() if "/" in line}
    assert passes["accuracy"] == "2/2" and passes["timing"] == "1/1"
    found = latest(tmp_path)
    runs = {row["engine"]: (row["status"], row["note"]) for row in found["rows"] if row["metric"] == "run"}
    assert runs["dies"][0] == "crashed" and "killed by signal 9" in runs["dies"][1]
    assert runs["absent"][0] == "not-measured" and "a_package_that_nobody_has" in runs["absent"][1]
    times = {row["metric"]: row["value"] for row in found["rows"] if row["engine"] == "talks"}
    # twelve frames have no 99th percentile that would say anything, but a slowest one: the scene is timed whole
    assert 0.0 < times["frame_time_p50"] <= times["frame_time_p95"] <= times["frame_time_max"]
    assert times["frame_time_p99"] is None
    assert len(found["series"]["ball_drop"]["talks/default"]["frame_time_us"]) == 12
    assert [row["value"] for row in found["rows"] if row["metric"] == "deterministic"] == [1.0]
    assert [path.name for path in (last_run(tmp_path) / "recordings").iterdir()] == ["ball_drop.talks.default.0.npz"]
