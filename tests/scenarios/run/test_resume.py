"""Folders that are no run are refused and left alone; a run that is stopped ends in order and can go on."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from avatarsim.errors import InvalidInput
from scenarios.__main__ import main
from scenarios.run.provenance import earlier_run, resume_command
from tests.scenarios.bad_engines import joined

ROOT = Path(__file__).resolve().parents[3]
PLAN = {"schema_version": 1, "words": ["check", "--full"], "runs": []}
GOOD = {"schema_version": 1, "provenance": {"command": "python -m scenarios check --full"}}


def folder_with(tmp_path: Path, content: object) -> Path:
    folder = tmp_path / "somewhere" / "run"
    folder.mkdir(parents=True)
    if content is not None:
        (folder / "results.json").write_text(content if isinstance(content, str) else json.dumps(content))
        (folder / "plan.json").write_text(json.dumps(PLAN))
    return folder


@pytest.mark.parametrize("content", [
    None, "{", "[]", {}, {**GOOD, "schema_version": 0}, {"schema_version": 1}, {**GOOD, "provenance": 3},
    {**GOOD, "provenance": {"command": "python -m scenarios compare"}},
    {**GOOD, "provenance": {"command": "python -m scenarios"}},
])
def test_only_a_run_of_the_same_command_can_go_on(tmp_path: Path, content: object) -> None:
    folder = folder_with(tmp_path, content)
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(InvalidInput):
        earlier_run(folder, "check")
    words = ["check", "--filter", "ball_drop", "--resume", str(folder), "--out", str(tmp_path / "out"), "--jobs", "0"]
    assert main([*words, "--frames", "3"]) == 2
    assert sorted(tmp_path.rglob("*")) == before, "nothing was written"


def test_a_run_of_the_same_command_is_taken(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, GOOD)
    assert earlier_run(folder, "check") == folder.resolve()


def test_latest_is_moved_in_out_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("reports.write_report", lambda *_: None)
    folder = folder_with(tmp_path, GOOD)
    words = ["check", "--engine", "tracker", "--filter", "ball_drop", "--frames", "3", "--jobs", "0", "--resume", str(folder)]
    main([*words, "--out", str(tmp_path / "out")])
    assert (folder / "results.csv").exists() and not list(folder.parent.glob("latest*")) and not (tmp_path / "out").exists()
    main([*words, "--out", str(folder.parent)])
    assert (folder.parent / "latest-check").resolve() == folder.resolve()


@pytest.mark.parametrize("plan", ["", "{", "[]", "{}", '{"schema_version": 1}', json.dumps(PLAN | {"schema_version": 0}),
                                  json.dumps(PLAN | {"runs": [3]}), json.dumps(PLAN | {"words": 3}), "[" * 100_000])
def test_a_run_whose_plan_is_damaged_cannot_go_on(tmp_path: Path, plan: str, capsys: pytest.CaptureFixture[str]) -> None:
    folder = folder_with(tmp_path, GOOD)
    (folder / "plan.json").write_text(plan)
    words = ["check", "--filter", "ball_drop", "--resume", str(folder), "--out", str(tmp_path / "out"), "--jobs", "0"]
    assert main([*words, "--frames", "3"]) == 2
    assert "plan.json" in capsys.readouterr().err and not (folder / "results.csv").exists()


def test_what_goes_on_names_the_whole_command_once_and_quoted() -> None:
    words = ["check", "--filter", "a*,b", "--resume", "/old", "--resume=/older", "--out", "my runs"]
    said = resume_command(Path("/new"), words)
    assert said == "python -m scenarios check --filter 'a*,b' --out 'my runs' --resume /new"


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_a_real_run_in_order(tmp_path: Path, sent: signal.Signals) -> None:
    """To the whole group, as a terminal does; long enough a scene that it cannot be over."""
    site = tmp_path / "site"
    site.mkdir()
    out = tmp_path / "out"
    command = [sys.executable, "-m", "scenarios", "run", "ball_drop", "--engine", "frozen", "dawdles", "--jobs", "2"]
    running = subprocess.Popen(
        [*command, "--out", str(out)], cwd=ROOT, env={**os.environ, "PYTHONPATH": str(joined(site))}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
        # background jobs of a shell ignore Ctrl-C, those of nohup SIGHUP, as would all that they start: here as at a terminal
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
    (folder,) = [path for path in out.iterdir() if not path.is_symlink()]
    assert running.returncode == 130, err
    assert "Traceback" not in err and f"--resume {folder.resolve()}" in err
    assert said.strip().splitlines()[-1].startswith("avatarsim: exit code 130 (stopped before the end)")
    found = json.loads((folder / "results.json").read_text())
    assert found["exit_code"] is None and {row["engine"] for row in found["rows"]} == {"frozen"}
