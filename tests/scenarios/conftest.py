"""Fixtures of the tests of the command line: external engines, and a catalogue of one easy scene."""

from dataclasses import replace
from pathlib import Path

import pytest

from scenarios import catalog
from tests.scenarios.bad_engines import joined


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(joined(folder))
    monkeypatch.setattr("reports.write_report", lambda *_: None)
    return folder


@pytest.fixture
def easy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Install a catalogue of one scene with only the bounds of every scene: balls in the air, correct in every engine."""
    scenario = replace(catalog.get("ball_drop"), name="easy", bounds=(), metrics=(), expects={})
    monkeypatch.setattr(catalog, "scenarios", lambda: {"easy": scenario})
    monkeypatch.setattr(catalog, "get", {"easy": scenario}.__getitem__)
