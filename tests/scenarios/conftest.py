"""Fixtures of the tests of the command line: engines that join, and a catalogue of one easy scene."""

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
    """A catalogue of one scene that asks for no more than every scene does: balls in the air, which no engine gets wrong."""
    scenario = replace(catalog.get("ball_drop"), name="easy", bounds=(), metrics=(), expects={})
    monkeypatch.setattr(catalog, "scenarios", lambda: {"easy": scenario})
    monkeypatch.setattr(catalog, "get", {"easy": scenario}.__getitem__)
