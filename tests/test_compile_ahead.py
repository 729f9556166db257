"""Kernels compiled ahead: once, by one process, and never taken for done when a part failed."""

import gc
import io
from pathlib import Path

import pytest

from avatarsim import compile_ahead, linking
from avatarsim.compile_ahead import PARTS, SHARES, compile_everything, compile_part, part_scene, run_shares


@pytest.fixture
def stamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "everything-compiled"
    monkeypatch.setattr(compile_ahead, "compiled_stamp", lambda: path)
    return path


@pytest.mark.parametrize("part", [*PARTS, "together"])
def test_every_part_runs(part: str) -> None:
    compile_part(part)
    scene, preset = part_scene(part)
    assert scene.effects.dynamics == (part in ("motion", "together")) and (preset == "paper") == (part == "paper")


def called() -> set[str]:
    """Large kernels that are in memory, and kernels that Python called, with their types."""
    kernels = [one for one in gc.get_objects() if type(one) is linking.KernelDispatcher]
    found = {f"{one.py_func.__module__}.{one.py_func.__qualname__}{types}" for one in kernels for types in one.overloads}
    return found | set(linking._CALLEES)


def test_a_scene_with_posture_and_motion_calls_nothing_that_these_do_not() -> None:
    for part in PARTS:
        compile_part(part)
    known = called()
    compile_part("together")
    assert len(known) > 100 and called() == known


def test_all_parts_are_compiled_once(stamp: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[str, ...]] = []
    monkeypatch.setattr(compile_ahead, "run_shares", lambda shares, stream: asked.extend(shares) or True)
    said = io.StringIO()
    assert compile_everything(said) and stamp.exists() and said.getvalue().count("\n") == 1
    assert asked == list(SHARES)
    assert compile_everything(said) and said.getvalue().count("\n") == 1 and asked == list(SHARES)


def test_a_part_that_fails_leaves_no_stamp(stamp: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compile_ahead, "run_shares", lambda shares, stream: False)
    assert not compile_everything(io.StringIO()) and not stamp.exists()


def test_a_failing_child_is_reported_by_its_code(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    def fail(part: str) -> None:
        if part == "bad":
            raise RuntimeError(f"nobody knows how to compile {part} parts")

    monkeypatch.setattr(compile_ahead, "compile_part", fail)
    said = io.StringIO()
    assert run_shares((("good",), ("good", "good")), said) and "failed" not in said.getvalue()
    assert not run_shares((("good",), ("good", "bad")), said)
    assert said.getvalue().splitlines()[-1] == "  good, bad: failed with code 1"
    assert "nobody knows how to compile bad parts" in capfd.readouterr().err


def test_where_nothing_can_be_kept_nothing_is_compiled_ahead(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compile_ahead, "compiled_stamp", lambda: None)
    monkeypatch.setattr(compile_ahead, "run_shares", lambda *_: pytest.fail("compiled"))
    assert compile_everything()
