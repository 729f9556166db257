"""Fixtures of the tests of the command line: external engines, and a catalogue of one easy scene."""

from dataclasses import replace
from pathlib import Path

import pytest

from scenarios import catalog, own_scenes
from tests.scenarios.bad_engines import joined


def without_reports(patch: pytest.MonkeyPatch) -> None:
    """Leave out the pages and the summary of a run: they have their own tests, and take longer than a small run."""
    patch.setattr("reports.write_report", lambda *_: None)
    patch.setattr("reports.terminal_summary", lambda *_: "a summary")


@pytest.fixture(autouse=True)
def no_own_scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no test take the scenes of another one's files."""
    monkeypatch.setenv(own_scenes.VARIABLE, "")


@pytest.fixture
def no_reports(monkeypatch: pytest.MonkeyPatch) -> None:
    without_reports(monkeypatch)


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, no_reports: None) -> Path:
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(joined(folder))
    return folder


@pytest.fixture
def easy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Install a catalogue of one scene with only the bounds of every scene: balls in the air, correct in every engine."""
    scenario = replace(catalog.get("ball_drop"), name="easy", bounds=(), metrics=(), expects={})
    monkeypatch.setattr(catalog, "scenarios", lambda: {"easy": scenario})
    monkeypatch.setattr(catalog, "get", {"easy": scenario}.__getitem__)
