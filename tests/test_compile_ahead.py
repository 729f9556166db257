"""Kernels compiled ahead: once, by one process, and never taken for done when a part failed."""

from pathlib import Path

import pytest

from avatarsim import compile_ahead
from avatarsim.compile_ahead import PARTS, compile_everything, compile_part, part_scene, run_parts


@pytest.fixture
def stamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "everything-compiled"
    monkeypatch.setattr(compile_ahead, "compiled_stamp", lambda: path)
    return path


@pytest.mark.parametrize("part", PARTS)
def test_every_part_runs(part: str) -> None:
    compile_part(part)
    scene, preset = part_scene(part)
    assert scene.effects.dynamics == (part in ("motion", "together")) and (preset == "paper") == (part == "paper")


def test_all_parts_are_compiled_once_and_the_joining_one_last(stamp: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr(compile_ahead, "run_parts", lambda parts, say, started: asked.extend(parts) or True)
    said: list[str] = []
    assert compile_everything(said.append) and stamp.exists() and len(said) == 1
    assert asked == list(PARTS) and asked[-1] == "together"
    assert compile_everything(said.append) and len(said) == 1 and asked == list(PARTS)


def test_a_part_that_fails_leaves_no_stamp(stamp: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compile_ahead, "run_parts", lambda parts, say, started: parts[0] == "together")
    assert not compile_everything(lambda line: None) and not stamp.exists()


def test_a_failing_child_is_reported_by_its_code(capfd: pytest.CaptureFixture[str]) -> None:
    said: list[str] = []
    assert not run_parts(["no-such-part"], said.append, 0.0)
    assert len(said) == 1 and said[0].startswith("  no-such-part: failed with code 2")
    assert "invalid choice: 'no-such-part'" in capfd.readouterr().err


def test_where_nothing_can_be_kept_nothing_is_compiled_ahead(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compile_ahead, "compiled_stamp", lambda: None)
    monkeypatch.setattr(compile_ahead, "run_parts", lambda *_: pytest.fail("compiled"))
    assert compile_everything()
