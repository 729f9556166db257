"""What is said while kernels are compiled: how many of how many, seldom in a log, and how long it will go on."""

import subprocess
import sys
from pathlib import Path

import pytest

from avatarsim import compile_progress
from avatarsim.compile_ahead import PARTS, compile_part
from avatarsim.compile_progress import BAR, EVERY, Progress


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
    monkeypatch.setattr(compile_progress, "kernels", lambda: [Stub(tmp_path)] * 20)
    (tmp_path / "below").mkdir()
    return tmp_path / "below"


def compiled(folder: Path, count: int) -> None:
    for k in range(count):
        (folder / f"{k}.nbc").touch()


IN_MEMORY = """
import gc
import avatarsim.compile_ahead
from avatarsim.compile_progress import kernels
from avatarsim.linking import KernelDispatcher
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
    progress = Progress(lambda line: None)
    assert progress.done() > 0.95 * progress.total


def test_a_line_now_and_then_where_lines_stay(folder: Path) -> None:
    said: list[str] = []
    clock = Clock()
    progress = Progress(said.append, clock)
    progress.show()
    clock.now = EVERY
    progress.show()
    progress.show()
    assert said == ["  0 of 20 kernels"]
    compiled(folder, 5)
    clock.now = 2.0 * EVERY
    progress.show()
    assert said[1:] == [f"  5 of 20 kernels, about {15 * clock.now / 5:.0f} s left"]
    compiled(folder, 25)
    progress.end()
    assert said[2:] == [f"  20 kernels compiled in {clock.now:.0f} s"]


def test_what_was_kept_counts_as_done_but_not_as_fast(folder: Path) -> None:
    compiled(folder, 10)
    clock = Clock()
    progress = Progress(lambda line: None, clock)
    assert progress.left(10) == float("inf")
    clock.now = 4.0
    assert progress.left(15) == 4.0


def test_a_bar_is_written_over_on_a_terminal(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    progress = Progress(print, Clock(), terminal=True)
    compiled(folder, 10)
    progress.show()
    shown = capsys.readouterr().out
    assert shown.startswith("\r") and "\n" not in shown and f"[{'#' * (BAR // 2)}{'.' * (BAR // 2)}] 10 of 20" in shown
