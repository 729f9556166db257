"""The command line called as by a user, and the files that it leaves."""

import json
from pathlib import Path

import pytest

from scenarios.__main__ import main


def called(tmp_path: Path, *words: str, frames: int = 6, jobs: int = 0) -> int:
    return main([*words, "--out", str(tmp_path / "out"), "--jobs", str(jobs), "--frames", str(frames)])


def last_run(tmp_path: Path) -> Path:
    """Return the run that ended last, of any command."""
    newest = max((tmp_path / "out").glob("latest*"), key=lambda link: link.lstat().st_mtime_ns)
    return newest.resolve()


def latest(tmp_path: Path) -> dict:
    return json.loads((last_run(tmp_path) / "results.json").read_text())


def last(capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    said = capsys.readouterr()
    return said.out.strip().splitlines()[-1], said.err
