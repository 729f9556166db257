"""What a program says while it waits for kernels: one line, and a bar where there is a terminal."""

import io
import re
import sys
from pathlib import Path

import pytest

from avatarsim import console as progress
from avatarsim.jit import places
from avatarsim.jit.first_compile import SECONDS, FirstCompile


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("avatarsim.console._SAID", set())
    monkeypatch.setattr(progress, "QUIET_FOR", 0.0)
    monkeypatch.setattr(progress, "BAR_EVERY", 0.0)


def compiled(first: FirstCompile, count: int) -> None:
    """So many kernels, each compiled when the one before calls it."""
    if count:
        with first.nested():
            first.begin("avatarsim.room")
            compiled(first, count - 1)


def test_one_line_where_there_is_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    first = FirstCompile()
    first.declared = {(Path("avatarsim.room"), str(k)) for k in range(250)}
    compiled(first, 3)
    assert stream.getvalue().count("\n") == 1 and "\r" not in stream.getvalue()
    assert re.findall(r"\d+", stream.getvalue()) == ["250", str(round(250 * SECONDS))]


def test_a_bar_on_a_terminal_that_is_gone_in_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    first = FirstCompile()
    first.declared = {(Path("avatarsim.room"), str(k)) for k in range(4)}
    compiled(first, 3)
    _, bar = stream.getvalue().split("\n")
    assert "kernel 1 of at most 4" in bar and "kernel 3 of at most 4" in bar
    assert bar.endswith("\r") and bar.split("\r")[-2].strip() == ""


def test_kernels_that_are_kept_are_not_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(places, "PLACES", places.Places(tmp_path))
    folder = tmp_path / "avatarsim.room" / "0"
    folder.mkdir(parents=True)
    for name in ("one-0.kernel", "one-1.kernel", "two-0.kernel", "three-0.compiling"):
        (folder / name).touch()
    wanted = {(Path("avatarsim.room/0"), name) for name in ("one", "two", "three", "four")}
    assert places.missing(wanted) == 2 and places.kept_kernels(Path("avatarsim.room/0")) == {"one": 2, "two": 1}


def test_silence_where_progress_is_shown_elsewhere_and_for_kernels_of_others(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    first = FirstCompile()
    first.begin("somewhere.else")
    first.silent = True
    compiled(first, 3)
    assert stream.getvalue() == ""


def test_a_closed_stream_stops_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    closed = io.StringIO()
    closed.close()
    for stream in (None, closed):
        monkeypatch.setattr("avatarsim.console._SAID", set())
        monkeypatch.setattr(sys, "stderr", stream)
        compiled(FirstCompile(), 1)
