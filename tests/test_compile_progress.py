"""How many kernels of how many are compiled, and how long the rest takes."""

import subprocess
import sys
from pathlib import Path

import pytest

from avatarsim import compile_ahead as compile_progress
from avatarsim.compile_ahead import PARTS, Compiled, compile_part
from avatarsim.jit import places
from avatarsim.jit.places import Places


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


class Stub:
    """A kernel of which only the folder matters."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(compile_progress, "kernels", lambda: [Stub(Path("below"))] * 20)
    monkeypatch.setattr(places, "PLACES", Places(tmp_path))
    (tmp_path / "below").mkdir()
    return tmp_path / "below"


def compiled(folder: Path, count: int) -> None:
    for k in range(count):
        (folder / f"{k}.kernel").touch()


IN_MEMORY = """
import gc
import avatarsim.compile_ahead
from avatarsim.compile_ahead import kernels
from avatarsim.jit.linking import KernelDispatcher
made = {id(one) for one in gc.get_objects() if type(one) is KernelDispatcher and one.py_func.__module__.startswith("avatarsim.")}
print({id(one) for one in kernels()} == made, len(made) > 500)
"""


def test_every_kernel_in_memory_is_known() -> None:
    """In a process of its own: tests may have replaced modules here, or hidden what there is from the collector."""
    said = subprocess.run([sys.executable, "-c", IN_MEMORY], capture_output=True, text=True, check=True, timeout=120.0)
    assert said.stdout.split() == ["True", "True"]


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
