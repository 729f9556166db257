"""How many kernels of how many are compiled, and how long the rest takes."""

from pathlib import Path

import pytest

from avatarsim.compile_ahead import PARTS, Compiled, compile_part
from avatarsim.jit import places
from avatarsim.jit.first_compile import FIRST_COMPILE
from avatarsim.jit.places import Places


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


def test_when_all_parts_are_compiled_all_is_done() -> None:
    for part in PARTS:
        compile_part(part)
    found = Compiled()
    assert found.done() > 0.95 * found.total


def test_the_time_left_is_told_once_a_tenth_is_done(folder: Path) -> None:
    clock = Clock()
    found = Compiled(clock)
    assert found.told(found.done()) == "0 of 20 kernels"
    clock.now = 10.0
    compiled(folder, 1)
    assert found.told(found.done()) == "1 of 20 kernels"
    compiled(folder, 5)
    assert found.told(found.done()) == "5 of 20 kernels, about 30 s left"
    compiled(folder, 25)
    assert found.told(found.done()) == "20 of 20 kernels"


def test_what_was_kept_counts_as_done_but_not_as_fast(folder: Path) -> None:
    compiled(folder, 10)
    clock = Clock()
    found = Compiled(clock)
    assert found.left(10) == float("inf")
    clock.now = 4.0
    assert found.left(15) == 4.0
