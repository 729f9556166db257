"""A stopped run ends in order and can be resumed; folders that are not a run are rejected and left unchanged."""

import json
import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from avatarsim.errors import InvalidInput
from scenarios.__main__ import main
from scenarios.job import Job, Outcome
from scenarios.run import harness
from scenarios.run.provenance import earlier_run, resume_command
from tests.scenarios.bad_engines import joined
from tests.scenarios.command_line import called, last_run, latest

ROOT = Path(__file__).resolve().parents[3]
PLAN = {"schema_version": 1, "words": ["check", "--full"], "runs": []}
GOOD = {"schema_version": 1, "provenance": {"command": "python -m scenarios check --full"}}
BALL = "--filter", "ball_drop"


def folder_with(tmp_path: Path, content: object, plan: str = json.dumps(PLAN)) -> Path:
    folder = tmp_path / "somewhere" / "run"
    folder.mkdir(parents=True)
    if content is not None:
        (folder / "results.json").write_text(content if isinstance(content, str) else json.dumps(content))
        (folder / "plan.json").write_text(plan)
    return folder


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("content", [
    None, "{", "[]", {}, {**GOOD, "schema_version": 0}, {"schema_version": 1}, {**GOOD, "provenance": 3},
    *({**GOOD, "provenance": {"command": f"python -m scenarios{command}"}} for command in ("", " compare")),
])
def test_only_a_run_of_the_same_command_is_resumed(tmp_path: Path, content: object) -> None:
    folder = folder_with(tmp_path, content)
    before = contents(tmp_path)
    with pytest.raises(InvalidInput):
        earlier_run(folder, "check")
    assert called(tmp_path, "check", *BALL, "--resume", str(folder)) == 2 and contents(tmp_path) == before


@pytest.mark.parametrize("plan", ["", "{", "[]", "{}", '{"schema_version": 1}', json.dumps(PLAN | {"schema_version": 0}),
                                  json.dumps(PLAN | {"runs": [3]}), json.dumps(PLAN | {"words": 3}), "[" * 100_000])
def test_a_run_with_a_damaged_plan_is_not_resumed(tmp_path: Path, plan: str, capsys: pytest.CaptureFixture[str]) -> None:
    folder = folder_with(tmp_path, GOOD, plan)
    assert called(tmp_path, "check", *BALL, "--resume", str(folder)) == 2
    assert "plan.json" in capsys.readouterr().err and not (folder / "results.csv").exists()


@pytest.mark.usefixtures("no_reports")
def test_the_link_to_the_last_run_is_moved_in_out_only(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, GOOD)
    assert earlier_run(folder, "check") == folder.resolve()
    words = ["check", "--engine", "tracker", *BALL, "--frames", "3", "--jobs", "0", "--resume", str(folder)]
    main([*words, "--out", str(tmp_path / "out")])
    assert (folder / "results.csv").exists() and not list(folder.parent.glob("latest*")) and not (tmp_path / "out").exists()
    main([*words, "--out", str(folder.parent)])
    assert (folder.parent / "latest-check").resolve() == folder.resolve()


def test_the_command_that_resumes_has_the_option_once() -> None:
    words = ["check", "--filter", "a*,b", "--resume", "/old", "--resume=/older", "--out", "my runs"]
    found = shlex.split(resume_command(Path("/new"), words))
    assert found == ["python", "-m", "scenarios", "check", "--filter", "a*,b", "--out", "my runs", "--resume", "/new"]


def test_resuming_keeps_recordings_and_removes_halves(site: Path, tmp_path: Path) -> None:
    called(tmp_path, "check", "--engine", "frozen", *BALL, frames=40)
    folder = last_run(tmp_path)
    kept = folder / "recordings" / "ball_drop.frozen.default.0.npz"
    before = kept.stat().st_mtime_ns
    # no process has such a large number
    dead, mine = (folder / "recordings" / f".half.npz.{number}" for number in (2**30, os.getpid()))
    dead.write_bytes(b"PK")
    mine.write_bytes(b"PK")
    assert called(tmp_path, "check", "--engine", "frozen", "tunnels", *BALL, "--resume", str(folder), frames=40) == 1
    assert kept.stat().st_mtime_ns == before and len(list(kept.parent.glob("ball*"))) == 2
    assert {row["engine"] for row in latest(tmp_path)["rows"]} == {"frozen", "tunnels"}
    assert not dead.exists() and mine.exists()


def test_resuming_with_fewer_words_is_refused(site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """All rows that it does not have would be lost, with their times."""
    path = tmp_path / "mine.toml"
    path.write_text("[frozen.mine]\ngain = 1.0\n")
    both = ["run", "--engine", "frozen", "tunnels", *BALL, "--settings", str(path)]
    called(tmp_path, *both, "--seed", "0", "1")
    folder = last_run(tmp_path)
    before = contents(folder)
    for words in (
        ["run", "--engine", "frozen", *BALL, "--settings", str(path), "--seed", "0", "1"], both, [*both, "--seed", "1", "2"],
        [*both[:4], "--filter", "bounce_ladder", *both[6:], "--seed", "0", "1"],
        [*both, "--seed", "0", "1", "--full"], [*both, "--seed", "0", "1", "--preset", "other"],
    ):
        assert called(tmp_path, *words, "--resume", str(folder)) == 2, words
        assert f"{shlex.join(both)} --seed 0 1" in capsys.readouterr().err
    assert called(tmp_path, *both, "--seed", "0", "1", "--resume", str(folder), frames=5) == 2
    assert "frames 6" in capsys.readouterr().err
    path.write_text("[frozen.mine]\ngain = 2.0\n")
    assert called(tmp_path, *both, "--seed", "0", "1", "--resume", str(folder)) == 2
    assert "gain" in capsys.readouterr().err and contents(folder) == before
    path.write_text("[frozen.mine]\ngain = 1.0\n")
    assert called(tmp_path, *both, "--seed", "0", "1", "2", "--resume", str(folder)) == 0
    assert {row["seed"] for row in latest(tmp_path)["rows"]} == {0, 1, 2}


def test_results_stay_until_the_resuming_command_has_ended(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    called(tmp_path, "run", "--engine", "frozen", *BALL)
    folder = last_run(tmp_path)
    before = (folder / "results.json").read_bytes()

    def stopped(job: Job, folder: Path) -> Outcome:
        raise KeyboardInterrupt

    monkeypatch.setattr(harness, "accuracy", stopped)
    assert called(tmp_path, "run", "--engine", "frozen", "tunnels", *BALL, "--resume", str(folder)) == 130
    assert (folder / "results.json").read_bytes() == before


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGHUP])
def test_a_signal_ends_a_real_run_in_order(tmp_path: Path, sent: signal.Signals) -> None:
    """The signal goes to the whole group, as from a terminal; the scene is long enough not to be finished."""
    site, out = tmp_path / "site", tmp_path / "out"
    site.mkdir()
    command = [sys.executable, "-m", "scenarios", "run", "ball_drop", "--engine", "frozen", "dawdles", "--jobs", "2"]
    running = subprocess.Popen(
        [*command, "--out", str(out)], cwd=ROOT, env={**os.environ, "PYTHONPATH": str(joined(site))}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
        # background jobs of a shell ignore Ctrl-C, those of nohup SIGHUP, and so do their children: here as at a terminal
        preexec_fn=lambda: [signal.signal(number, signal.SIG_DFL) for number in (signal.SIGINT, signal.SIGHUP)],
    )
    try:
        deadline = time.monotonic() + 60.0
        while not list(out.glob("*/recordings/*frozen*.npz")) and time.monotonic() < deadline and running.poll() is None:
            time.sleep(0.1)
        time.sleep(0.5)
        os.killpg(running.pid, sent)
        said, err = running.communicate(timeout=60)
    finally:
        if running.poll() is None:
            os.killpg(running.pid, signal.SIGKILL)
    assert not list(out.glob("latest*")), "they lead to runs that have ended"
    (folder,) = out.iterdir()
    assert running.returncode == 130, err
    assert "Traceback" not in err and f"--resume {folder.resolve()}" in err and "exit code 130" in said
    found = json.loads((folder / "results.json").read_text())
    assert found["exit_code"] is None and {row["engine"] for row in found["rows"]} == {"frozen"}
