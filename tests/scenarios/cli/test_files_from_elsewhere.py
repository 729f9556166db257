"""Files of other programs in place of settings, runs and tables: exit code 2, and never an endless wait."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from reports.__main__ import main as reports
from scenarios.__main__ import main as scenarios
from tests.scenarios.command_line import called

Lay = Callable[[Path], object]
DEEP = "[" * 100_000
NO_FILES: dict[str, Lay] = {
    "pipe": os.mkfifo, "folder": Path.mkdir, "device": lambda path: path.symlink_to("/dev/zero"),
    "nowhere": lambda path: path.symlink_to("absent"), "not UTF-8": lambda path: path.write_bytes(b"\xff\xfe\x00"),
    "deep": lambda path: path.write_text(f"a = {DEEP}" if path.suffix == ".toml" else DEEP),
    "huge": lambda path: os.truncate(path, path.write_bytes(b"") + 2**40),
}
"""Things that may be in place of an expected file; the last one takes no disk space."""


@pytest.fixture(params=NO_FILES)
def lay(request: pytest.FixtureRequest) -> Lay:
    return NO_FILES[request.param]


def test_settings(site: Path, tmp_path: Path, lay: Lay, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    lay(path)
    assert called(tmp_path, "check", "--engine", "tunnels", "--filter", "ball_drop", "--settings", str(path)) == 2
    err = capsys.readouterr().err
    assert "mine.toml" in err and "valid: " in err and "Traceback" not in err


def test_a_run_that_is_resumed(site: Path, tmp_path: Path, lay: Lay, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("results.json", "plan.json"):
        folder = tmp_path / name.removesuffix(".json")
        folder.mkdir()
        origin = {"schema_version": 1, "provenance": {"command": "python -m scenarios check"}, "exit_code": None}
        (folder / "results.json").write_text(json.dumps(origin))
        (folder / name).unlink(missing_ok=True)
        lay(folder / name)
        assert called(tmp_path, "check", "--engine", "tunnels", "--filter", "ball_drop", "--resume", str(folder)) == 2
        assert name in capsys.readouterr().err


def test_what_reports_read(tmp_path: Path, lay: Lay, capsys: pytest.CaptureFixture[str]) -> None:
    lay(tmp_path / "results.json")
    assert reports(["write", str(tmp_path)]) == 2 and "results.json" in capsys.readouterr().err
    lay(tmp_path / "base.csv")
    assert reports(["diff", str(tmp_path / "base.csv"), str(tmp_path)]) == 2
    assert reports(["write", str(tmp_path / ("a" * 300))]) == 2
    words = ["check", "--engine", "tracker", "--filter", "ball_drop", "--jobs", "0", "--resume", str(tmp_path / ("a" * 300))]
    assert scenarios(words) == 2
    assert [path.name for path in tmp_path.iterdir() if path.suffix == ".html"] == []
