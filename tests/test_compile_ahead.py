"""Kernels compiled ahead: once, by one process, and never taken for done when a part failed."""

import io
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from avatarsim import compile_ahead
from avatarsim.compile_ahead import (
    PARTS,
    SHARES,
    SOURCES,
    WITHOUT_FRAMES,
    Compiled,
    compile_everything,
    compile_into,
    compile_part,
    compile_share,
    is_compiled,
    part_scene,
    run_shares,
    stamp_names,
)
from avatarsim.jit import places
from avatarsim.jit.first_compile import FIRST_COMPILE
from avatarsim.jit.places import NAME, SUFFIX, CannotKeep, Places
from avatarsim.jit.processor import compiled_for, usable
from avatarsim.jit.source_hash import ROOT, _closure, kernel_folder
from tests.jit.kernel_package import plain_environment


@pytest.fixture
def stamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(places, "PLACES", Places(tmp_path / "kernels"))
    return tmp_path / "kernels" / stamp_names(compiled_for())[0]


def test_every_part_runs_and_then_all_is_done() -> None:
    for part in (*PARTS, "together"):
        compile_part(part)
        if part not in WITHOUT_FRAMES:
            scene, preset = part_scene(part)
            assert scene.effects.dynamics == (part != "posture"), part
            assert preset == (part if part in ("ik", "paper") else "default")
    found = Compiled()
    assert found.done() > 0.95 * found.total


def copied_ahead(into: Path) -> bool:
    """Copy what was compiled ahead, with which `make test` begins: kernels of these sources that are no younger than its stamps.
    Return False where there are no stamps."""
    base, stamps = places.current().write, stamp_names(compiled_for())
    if base is None or not all((base / stamp).exists() for stamp in stamps):
        return False
    last = max((base / stamp).stat().st_mtime_ns for stamp in stamps)
    for source in (*ROOT.rglob("*.py"), *ROOT.parent.joinpath("reference").rglob("*.py")):
        folder = kernel_folder(str(source))
        for file in (base / folder).glob("*"):
            if file.stat().st_mtime_ns <= last:
                (into / folder).mkdir(parents=True, exist_ok=True)
                shutil.copy2(file, into / folder)
    return True


def test_no_command_compiles_after_all_was_compiled_ahead(tmp_path: Path) -> None:
    homes = {name: str(tmp_path / name) for name in ("HOME", "TMPDIR")}
    (tmp_path / "TMPDIR").mkdir()
    options: dict[str, Any] = {"env": plain_environment(ROOT, **homes), "cwd": ROOT.parent, "text": True}
    kernels = tmp_path / "HOME" / ".cache" / NAME
    if not copied_ahead(kernels):
        subprocess.run([sys.executable, "-m", "avatarsim", "compile"], stdout=subprocess.PIPE, check=True, **options)
    assert len([*kernels.rglob(f"*{SUFFIX}")]) > 600
    command = [sys.executable, "-m", "tests.late_commands", str(tmp_path)]
    asked = subprocess.run(command, stdout=subprocess.PIPE, check=True, **options)
    answers = [json.loads(line) for line in asked.stdout.splitlines()]
    assert len(answers) >= 10
    for answer in answers:
        assert answer["code"] in (0, 1, 3) and "Traceback" not in answer["printed"], answer
        assert answer["late"] == [] and "compiling" not in answer["printed"], answer
    # and a command that compiles nothing prints nothing of it
    again = subprocess.run([sys.executable, "-m", "avatarsim"], stdout=subprocess.PIPE, check=True, **options)
    assert again.stdout == ""


def test_the_stamp_depends_on_every_source_of_a_part() -> None:
    files = {file for source in SOURCES for file in _closure(source)}
    assert {ROOT / "cleaning" / "chords.py", ROOT / "many_worlds.py", ROOT.parent / "reference" / "target_kernels.py"} <= files


def test_all_parts_are_compiled_once(stamp: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[str, ...]] = []

    def run(shares: list[tuple[str, ...]], stream: object) -> bool:
        asked.extend(shares)
        return True

    monkeypatch.setattr(compile_ahead, "run_shares", run)
    said = io.StringIO()
    assert compile_everything(said) and stamp.exists() and is_compiled() and asked == list(SHARES)
    assert compile_everything(said) and asked == list(SHARES) and said.getvalue() == ""


def test_a_part_that_fails_leaves_no_stamp(stamp: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compile_ahead, "run_shares", lambda shares, stream: False)
    assert not compile_everything(io.StringIO()) and not stamp.exists()


def test_a_failing_child_is_reported_by_its_code(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    def fail(part: str) -> None:
        if part == "bad":
            raise RuntimeError(f"nobody knows how to compile {part} parts")

    monkeypatch.setattr(compile_ahead, "compile_part", fail)
    said = io.StringIO()
    assert run_shares((("good",), ("good", "good")), said) and "good: " not in said.getvalue()
    assert not run_shares((("good",), ("good", "bad")), said)
    assert re.search(r"good, bad: .* code 1\b", said.getvalue().splitlines()[-1])
    assert "nobody knows how to compile bad parts" in capfd.readouterr().err


def test_code_of_any_processor_that_runs_here_counts(stamp: Path) -> None:
    base = stamp.parents[2]
    for cpu in usable():
        for made in (base / name for name in stamp_names(cpu)):
            made.parent.mkdir(parents=True, exist_ok=True)
            made.touch()
        monkeyed = Places(base)
        places.use_places(monkeyed)
        assert is_compiled()
        made.unlink()
        places.use_places(Places(base))
        assert not is_compiled()
    assert stamp_names(compiled_for()._replace(name="another")) not in [stamp_names(cpu) for cpu in usable()]


def test_a_carried_folder_is_readable_and_a_users_keeps_its_mode(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(FIRST_COMPILE, "declared", {(Path("avatarsim.room"), str(k)) for k in range(20)})
    monkeypatch.setattr(places, "PLACES", Places(tmp_path))
    (tmp_path / "avatarsim.room").mkdir()
    return tmp_path / "avatarsim.room"


def compiled(folder: Path, count: int) -> None:
    for k in range(count):
        (folder / f"{k}-0.kernel").touch()



def test_what_was_kept_counts_as_done_but_not_as_fast(folder: Path) -> None:
    compiled(folder, 10)
    clock = Clock()
    found = Compiled(clock)
    assert found.left(10) == float("inf")
    clock.now = 4.0
    assert found.left(15) == 4.0
    compiled(folder, 25)
    assert found.done() == found.total == 20 and found.left(20) == 0.0
