"""Kernels compiled ahead: once, by one process, and never taken for done when a part failed."""

import gc
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from avatarsim import compile_ahead
from avatarsim.cleaning import Shield, clean
from avatarsim.compile_ahead import (
    PARTS,
    SHARES,
    compile_everything,
    compile_into,
    compile_part,
    compile_share,
    is_compiled,
    part_scene,
    run_shares,
    stamp_name,
)
from avatarsim.engine import Settings
from avatarsim.jit import linking, places
from avatarsim.jit.first_compile import FIRST_COMPILE
from avatarsim.jit.places import NAME, CannotKeep, Places
from avatarsim.jit.processor import compiled_for, usable
from avatarsim.scene.tracker import rest
from avatarsim.simulator import AvatarsimEngine
from tests.cleaning.rooms import FLOOR, RATE, lowered, model, swinging, walker, wall


@pytest.fixture
def stamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(places, "PLACES", Places(tmp_path / "kernels"))
    return tmp_path / "kernels" / stamp_name(compiled_for())


@pytest.mark.parametrize("part", [*PARTS, "together"])
def test_every_part_runs(part: str) -> None:
    compile_part(part)
    scene, preset = part_scene(part)
    assert scene.effects.dynamics == (part in ("motion", "together", "worlds"))
    assert preset == (part if part in ("ik", "paper") else "default")


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


def test_a_start_that_touches_calls_nothing_that_the_parts_do_not() -> None:
    for part in ("distance", "motion", "worlds"):
        compile_part(part)
    known = called()
    scene, _ = part_scene("motion")
    with AvatarsimEngine() as engine:
        engine.load(replace(scene, bodies=tuple(replace(body, position=(0.0, 0.0, 0.05)) if body.name == "ball" else body
                                                for body in scene.bodies)), Settings(), 1.0 / 60.0)
        engine.advance(rest(()), 1.0 / 60.0)
        assert engine.contacts()
    assert "collision.signed_distance" in str(known) and called() == known


def test_cleaning_calls_nothing_that_its_part_does_not() -> None:
    for part in ("distance", "posture", "cleaning"):
        compile_part(part)
    known = called()
    motion = lowered(swinging(30, 0.4, along=1.0), np.linspace(0.2, -0.2, 30))
    clean(motion, replace(model(), avatar=replace(walker(), ignore=(("left", "right"),))), (FLOOR, wall(0.8)))
    shield = Shield(model(), (FLOOR,), RATE)
    for frame in range(30):
        shield(shield.coordinates.rows(motion)[frame])
    assert "free_until" in str(known) and called() == known


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


def test_where_nothing_can_be_kept_nothing_is_compiled_ahead_and_that_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    blocked = tmp_path / "a_file"
    blocked.write_text("", encoding="utf-8")
    monkeypatch.setattr(places, "PLACES", Places(blocked / "kernels"))
    monkeypatch.setattr(compile_ahead, "run_shares", lambda *_: pytest.fail("compiled"))
    monkeypatch.setattr("avatarsim.console._SAID", set())
    assert compile_everything() and compile_everything()
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "cannot be kept" in said and str(blocked) in said


def test_what_is_compiled_for_any_processor_whose_code_runs_here_counts(stamp: Path) -> None:
    base = stamp.parents[2]
    for cpu in usable():
        made = base / stamp_name(cpu)
        made.parent.mkdir(parents=True, exist_ok=True)
        made.touch()
        monkeyed = Places(base)
        places.use_places(monkeyed)
        assert is_compiled()
        made.unlink()
        places.use_places(Places(base))
        assert not is_compiled()
    assert stamp_name(compiled_for()._replace(name="another")) not in {stamp_name(cpu) for cpu in usable()}


def test_a_folder_to_carry_elsewhere_may_be_read_by_all_and_a_folder_of_the_user_keeps_its_mode(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def kept(shares: object, stream: object) -> bool:
        entry = tmp_path / "carried" / NAME / "avatarsim.x" / "0" / "x.kernel"
        entry.parent.mkdir(parents=True, mode=0o700)
        entry.write_bytes(b"code")
        entry.chmod(0o600)
        return True

    monkeypatch.setattr(places, "PLACES", places.PLACES)
    monkeypatch.setattr(compile_ahead, "run_shares", kept)
    said = io.StringIO()
    assert compile_into(tmp_path / "carried", said)
    assert "set AVATARSIM_CACHE_DIR to the folder above it\n" in said.getvalue()
    modes = {path.stat().st_mode & 0o777 for path in (tmp_path / "carried").rglob("*") if path.is_dir()}
    assert modes == {0o755} and (tmp_path / "carried").stat().st_mode & 0o777 == 0o755
    assert {path.stat().st_mode & 0o777 for path in (tmp_path / "carried").rglob("*") if path.is_file()} == {0o644}
    (tmp_path / "carried").chmod(0o700)
    assert compile_into(tmp_path / "carried", said) and (tmp_path / "carried").stat().st_mode & 0o777 == 0o700


def test_a_share_whose_kernels_cannot_be_kept_ends_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def keep(part: str) -> None:
        places.current().keep_no_more(OSError(28, "No space left on device"))

    monkeypatch.setattr(places, "PLACES", places.PLACES)
    monkeypatch.setattr(compile_ahead, "compile_part", keep)
    monkeypatch.setattr(FIRST_COMPILE, "silent", False)
    with pytest.raises(SystemExit, match="cannot be kept: .* No space left on device"):
        compile_share(("distance", "posture"), tmp_path)
    assert isinstance(places.current(), Places) and places.current().only == tmp_path
    with pytest.raises(CannotKeep):
        places.current().keep_no_more(OSError(28, "No space left on device"))
