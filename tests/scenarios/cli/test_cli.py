"""The command line: exit codes, and the files of a run."""

import csv
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.engine import Engine, FrameRecord, Settings
from avatarsim.errors import InvalidFile, StartOverlaps
from avatarsim.scene.scene import Scene
from runfiles.timing_protocol import REPEATS, WARM_FRAMES
from scenarios import catalog
from scenarios.__main__ import main
from scenarios.engines import opened
from scenarios.measure.timing import TAIL
from tests.scenarios.command_line import called, last, last_run, latest

ROOT = Path(__file__).resolve().parents[3]
BALL = "--filter", "ball_drop"


@pytest.mark.usefixtures("easy")
def test_0_when_every_check_passes(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(tmp_path, "check", "--engine", "tunnels") == 0
    line, _ = last(capsys)
    assert "exit code 0" in line and str(last_run(tmp_path)) in line and latest(tmp_path)["exit_code"] == 0


def test_1_when_a_gated_bound_failed(
    site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The report is written once the code is known, and before it is returned."""
    seen: list[int] = []
    monkeypatch.setattr(
        "reports.write_report", lambda folder, *_: seen.append(json.loads((folder / "results.json").read_text())["exit_code"])
    )
    assert called(tmp_path, "check", "--engine", "frozen", "absent", *BALL, frames=40) == 1 and seen == [1]
    assert "exit code 1" in capsys.readouterr().out.strip().splitlines()[-1]
    assert {row["status"] for row in latest(tmp_path)["rows"] if row["engine"] == "frozen"} >= {"fail"}


@pytest.mark.parametrize(("words", "named"), [
    (["check", "--engine", "nobody"], ["nobody", "mujoco", "frozen"]), (["run", "ball_dorp"], ["ball_dorp", "ball_drop"]),
    (["check", "--engine", "frozen", "--preset", "fastest"], ["fastest", "other"]), (["dance"], ["dance"]), ([], []),
    (["check", "--settings", "no_such_file.toml"], ["no_such_file.toml"]), (["check", "--jobs", "-1"], ["--jobs"]),
    (["check", "--jobs", "many"], ["--jobs"]), (["check", "--frames", "0"], ["--frames"]),
    (["check", "--seed", "-1"], ["--seed"]), (["check", "--seed", "4294967296"], ["--seed"]),
    (["study", "settings", "--resume", "x"], ["--resume"]), (["study", "dreams"], ["dreams", "settings"]),
])
def test_2_for_wrong_usage(
    site: Path, tmp_path: Path, words: list[str], named: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*words, "--out", str(tmp_path / "out")] if words else []) == 2
    assert not (tmp_path / "out").exists(), "nothing is begun"
    err = capsys.readouterr().err
    assert err and all(name in err for name in named)


@pytest.mark.parametrize(("option", "value"), [
    ("--out", ""), ("--resume", ""), ("--settings", ""), ("--out", "/proc/foo"), ("--out", "/dev/null/x"), ("--out", "a_file"),
])
def test_2_for_an_empty_path_or_a_folder_that_cannot_be_made(
    site: Path, tmp_path: Path, option: str, value: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a_file").write_text("mine")
    before = sorted(tmp_path.rglob("*"))
    assert main(["check", "--engine", "tunnels", *BALL, "--frames", "3", "--jobs", "0", option, value]) == 2
    assert option in capsys.readouterr().err and sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(("engine", "status"), [
    ("absent", "not-measured"), ("raises", "crashed"), ("no_engine", "not-measured"), ("unrecorded", "crashed"),
])
def test_3_when_an_engine_is_missing_or_crashed(site: Path, tmp_path: Path, engine: str, status: str) -> None:
    assert called(tmp_path, "check", "--engine", engine, *BALL) == 3
    assert [row["status"] for row in latest(tmp_path)["rows"]] == [status]


def test_reason_of_an_engine_that_cannot_run_a_scene_is_printed_and_in_the_table(
    site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(tmp_path, "run", "--engine", "speechless", *BALL) == 0
    why = latest(tmp_path)["rows"][0]["note"]
    assert why and why in capsys.readouterr().out and why in (last_run(tmp_path) / "results.csv").read_text()


def test_facts_of_engines_are_not_read_before_a_command_can_answer_for_them() -> None:
    code = "import scenarios.__main__, reports.__main__, runfiles.engines as e; assert e.engines.cache_info().currsize == 0"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_3_for_a_full_disk(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(known: object, folder: Path) -> None:
        raise OSError(28, "No space left on device", str(folder / "results.json"))

    monkeypatch.setattr("scenarios.run.results.write", full)
    assert called(tmp_path, "check", "--engine", "tunnels", *BALL) == 3
    assert "results.json" in capsys.readouterr().err


@pytest.mark.usefixtures("easy")
def test_3_for_a_report_that_fails_which_costs_no_figure(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("a chart without a scale")

    monkeypatch.setattr("reports.write_report", broken)
    assert called(tmp_path, "check", "--engine", "tunnels") == 3
    found = latest(tmp_path)
    assert found["exit_code"] == 3 and "a chart without a scale" in found["notes"][0]
    assert {row["status"] for row in found["rows"]} == {"pass", "info"}


def test_3_for_a_scene_that_cannot_be_made_beside_others(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def cut() -> Scene:
        raise InvalidFile("humanoid3d_walk.txt", "ends within a frame", "whole frames of 44 numbers")

    good = catalog.get("ball_drop")
    both = {"ball_drop": good, "cut_short": replace(good, name="cut_short", build=cut)}
    monkeypatch.setattr(catalog, "scenarios", lambda: both)
    monkeypatch.setattr(catalog, "get", both.__getitem__)
    assert called(tmp_path, "check", "--engine", "tunnels") == 3
    notes = {row["scenario"]: row["note"] for row in latest(tmp_path)["rows"] if row["metric"] == "run"}
    assert list(notes) == ["cut_short"] and "humanoid3d_walk.txt" in notes["cut_short"]
    assert (last_run(tmp_path) / "recordings" / "ball_drop.tunnels.default.0.npz").exists()


@pytest.mark.parametrize(("words", "named"), [
    (["check", "--filter", "ball_drop, nosuch,none_*"], ["nosuch", "none_*"]),
    (["check", "--filter", "no_such_*"], ["no_such_*"]),
    (["list", "--filter", "zzz"], ["zzz", "ball_drop"]),
])
def test_5_when_a_pattern_matches_nothing(
    site: Path, tmp_path: Path, words: list[str], named: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """A list with a misspelt name must not give "all pass"."""
    assert called(tmp_path, *words) == 5
    err = capsys.readouterr().err
    assert all(name in err for name in named)


def test_json_is_the_only_output(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    called(tmp_path, "check", "--engine", "frozen", *BALL, "--json", frames=40)
    said = capsys.readouterr()
    assert {row["metric"] for row in json.loads(said.out)} >= {"residual_overlap_max", "restitution_error_max"}
    assert main(["list", "--json", "--effects", *BALL]) == 0
    (entry,) = json.loads(capsys.readouterr().out)
    assert entry["name"] == "ball_drop" and "restitution" in entry["effects"] and entry["switched_off"] == []
    assert main(["metrics", "--json"]) == 0
    assert ("residual_overlap_max", "m") in [(row["metric"], row["unit"]) for row in json.loads(capsys.readouterr().out)]


def test_bench_takes_everyday_scenes_and_compare_takes_all(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drop = catalog.get("ball_drop")
    both = {"ball_drop": drop, "rare": replace(drop, name="rare", everyday=False)}
    monkeypatch.setattr(catalog, "scenarios", lambda: both)
    monkeypatch.setattr(catalog, "get", both.__getitem__)
    for room in ("unseen", "drawn_crowds"):
        monkeypatch.setattr(f"scenarios.{room}.scenarios", lambda: {})

    def taken(*words: str) -> set[str]:
        called(tmp_path, *words, "--engine", "tunnels", "--preset", "default", frames=2)
        return {row["scenario"] for row in latest(tmp_path)["rows"]}

    assert taken("bench") == {"ball_drop"}
    both["two_arms"] = replace(drop, name="two_arms", everyday=False)
    assert taken("bench") == {"ball_drop", "two_arms"}
    assert taken("compare", "--filter", "rar*,two_*") == {"rare", "two_arms"}
    del both["two_arms"]
    assert taken("compare") == taken("bench", "--filter", "*") == taken("compare", "--full") == taken("check") == set(both)


def test_compare_times_many_scenes_quickly_and_bench_whole(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.run.harness.QUICK_FROM", 1)
    drop = replace(catalog.get("ball_drop"), everyday=False)
    monkeypatch.setattr(catalog, "scenarios", lambda: {"ball_drop": drop})
    monkeypatch.setattr(catalog, "get", lambda name: drop)
    for name, value in (("CHEAP_TIME", 0.0), ("LEAST_FRAMES", 25), ("ROUND_TIME", 0.0)):
        monkeypatch.setattr(f"scenarios.run.timing.{name}", value)
    for command, rounds in (("bench", f"{REPEATS} x 40"), ("compare", "1 x 25")):
        called(tmp_path, command, "--engine", "tunnels", "--preset", "default", *BALL, frames=40)
        found = latest(tmp_path)
        times = [row for row in found["rows"] if row["metric"].startswith("frame_time")]
        assert all(row["note"].startswith(f"{rounds} frames") for row in times) and len(times) > 4
        assert all(f", {WARM_FRAMES} " in row["note"] for row in times)
        # neither is enough for a tail; the row says so instead
        assert {row["metric"] for row in times if row["value"] is None} == set(TAIL)
        assert found["provenance"]["timing"]["repeats"] == REPEATS
        stored = list(csv.DictReader((last_run(tmp_path) / "bench.csv").read_text().splitlines()))
        assert [row["note"].startswith(rounds) for row in stored if row["metric"] == "frame_time_p50"] == [True]


def test_scene_that_every_engine_refuses_has_no_times(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.run.harness.QUICK_FROM", 1)
    engine = type(opened("tunnels"))
    load = engine.load

    def refusing(self: Engine, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        if scene.name == "coincident_start":
            raise StartOverlaps([("a", "b", 0.1)])
        return load(self, scene, settings, dt)

    monkeypatch.setattr(engine, "load", refusing)
    called(tmp_path, "compare", "--engine", "tunnels", "--preset", "default", "--filter", "coincident_start,ball_drop", frames=2)
    found = latest(tmp_path)
    timed = {row["scenario"] for row in found["rows"] if row["metric"] == "frame_time_p50" and row["value"] is not None}
    assert timed == {"ball_drop"} and found["exit_code"] is not None


def test_every_preset_and_seed_is_one_run(site: Path, tmp_path: Path) -> None:
    """The same twice is one; without presets, `run` takes all of an engine and `check` its first."""
    for command, presets in (("run", {"default", "other"}), ("check", {"default"})):
        called(tmp_path, command, "--engine", "frozen", *BALL)
        assert {row["preset"] for row in latest(tmp_path)["rows"]} == presets
    words = ["check", "--engine", "tunnels", "tunnels", *BALL, "--preset", "default", "other", "--seed", "1", "2", "1"]
    called(tmp_path, *words)
    engines = latest(tmp_path)["engines"]
    found = {(entry["preset"], entry["seed"]) for entry in engines}
    assert found == {("default", 1), ("default", 2), ("other", 1), ("other", 2)} and len(engines) == 4
    names = sorted(path.name for path in (last_run(tmp_path) / "recordings").iterdir())
    assert names == sorted(f"ball_drop.tunnels.{preset}.{seed}.npz" for preset, seed in found)


def test_a_whole_comparison_in_processes_of_their_own(site: Path, tmp_path: Path) -> None:
    """Both passes with the real command: an engine that dies, one that is missing, one that prints, one that works."""
    command = [sys.executable, "-m", "scenarios", "compare", "--engine", "talks", "dies", "absent", *BALL]
    command += ["--preset", "default", "--frames", "12", "--jobs", "2", "--out", str(tmp_path / "out")]
    ran = subprocess.run(
        command, cwd=ROOT, env={**os.environ, "PYTHONPATH": str(site)}, capture_output=True, text=True, timeout=120, check=False,
    )
    assert ran.returncode == 3, ran.stderr
    assert "WELCOME" not in ran.stdout and "accuracy" in ran.stderr and "2/2" in ran.stderr and "1/1" in ran.stderr
    found = latest(tmp_path)
    runs = {row["engine"]: (row["status"], row["note"]) for row in found["rows"] if row["metric"] == "run"}
    assert runs["dies"][0] == "crashed" and "signal 9" in runs["dies"][1]
    assert runs["absent"][0] == "not-measured" and "a_package_that_nobody_has" in runs["absent"][1]
    times = {row["metric"]: row["value"] for row in found["rows"] if row["engine"] == "talks"}
    # twelve frames have a slowest one but no 99th percentile: the whole scene is timed
    assert 0.0 < times["frame_time_p50"] <= times["frame_time_p95"] <= times["frame_time_max"]
    assert times["frame_time_p99"] is None and times["deterministic"] == 1.0
    assert len(found["series"]["ball_drop"]["talks/default"]["frame_time_us"]) == 12
    assert [path.name for path in (last_run(tmp_path) / "recordings").iterdir()] == ["ball_drop.talks.default.0.npz"]


@pytest.mark.usefixtures("no_reports")
def test_each_command_has_a_link_to_its_last_run(tmp_path: Path) -> None:
    out, before, names = tmp_path / "out", dict[str, str](), {"compare": "latest"}
    for command in ("check", "run", "compare", "bench", "check"):
        called(tmp_path, command, *BALL, "--engine", "tracker", "--preset", "default", frames=2)
        links = {path.name: path.readlink().name for path in out.glob("latest*")}
        moved = names.get(command, f"latest-{command}")
        assert {name for name, target in links.items() if before.get(name) != target} == {moved}
        before = links
    assert set(before) == {"latest", "latest-check", "latest-run", "latest-bench"}
