"""Studies within a comparison: their arguments, and the handling of one that fails."""

import json
from pathlib import Path

import pytest

from avatarsim.errors import InvalidInput
from runfiles.table import Row
from scenarios.__main__ import parser
from scenarios.cli import comparison
from scenarios.studies.study import Request, Study, in_turn
from tests.scenarios.command_line import latest
from tests.scenarios.conftest import without_reports


def compared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *studies: Study, engines: tuple[str, ...] = ("tracker",)) -> int:
    without_reports(monkeypatch)
    monkeypatch.setattr(comparison, "STUDIES", studies)
    words = ["compare", "--engine", *engines, "--filter", "ball_drop", "--jobs", "0", "--out", str(tmp_path / "out")]
    return comparison.compare(parser().parse_args(words), ["compare"])


def test_a_study_is_told_of_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[Request] = []

    def ask(request: Request) -> tuple[list[Row], list[str]]:
        told.append(request)
        return [], []

    assert compared(tmp_path, monkeypatch, Study("first", ask), Study("second", ask), engines=("avatarsim", "tracker")) == 0
    assert len(told) == 2
    assert list(told[0].scenarios) == ["ball_drop"] and told[0].folder == (tmp_path / "out" / "latest").resolve()
    assert told[0].presets["avatarsim"] == ("default", "paper") and told[0].workers == 0


def test_failing_study_leaves_the_run_incomplete(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = []

    def fails(request: Request) -> tuple[list[Row], list[str]]:
        raise RuntimeError("no disk")

    def works(request: Request) -> tuple[list[Row], list[str]]:
        done.append(request.folder)
        return [], []

    assert compared(tmp_path, monkeypatch, Study("broken", fails), Study("sound", works)) == 3
    assert len(done) == 1
    assert any("RuntimeError: no disk" in note for note in latest(tmp_path)["notes"])
    assert latest(tmp_path)["exit_code"] == 3


def test_a_stopped_study_stops_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stops(request: Request) -> tuple[list[Row], list[str]]:
        raise KeyboardInterrupt

    assert compared(tmp_path, monkeypatch, Study("long", stops)) == 130
    # `latest` links to runs that have ended
    (folder,) = (tmp_path / "out").iterdir()
    assert json.loads((folder / "results.json").read_text())["exit_code"] is None


def test_troubles_carry_the_name_of_their_study(tmp_path: Path) -> None:
    def refuses(request: Request) -> tuple[list[Row], list[str]]:
        raise InvalidInput("a knob", -1, "0 at least")

    studies = [Study("one", refuses), Study("two", lambda request: ([], ["no answer"]))]
    first, second = in_turn(studies, Request(tmp_path, {}, {}, 0))
    assert first.startswith("one: a knob") and second == "two: no answer"
