"""What a program says while it waits for kernels: one line, and a bar where there is a terminal."""

import io
import sys

import pytest

from avatarsim import console as progress
from avatarsim.jit.first_compile import FirstCompile


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
    compiled(first, 3)
    assert stream.getvalue().count("\n") == 1 and "one to two minutes" in stream.getvalue() and "\r" not in stream.getvalue()


def test_a_bar_on_a_terminal_that_is_gone_in_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    first = FirstCompile()
    first.declared = 4
    compiled(first, 3)
    line, bar = stream.getvalue().split("\n")
    assert "one to two minutes" in line and "kernel 1 of at most 4" in bar and "kernel 3 of at most 4" in bar
    assert bar.endswith("\r") and bar.split("\r")[-2].strip() == ""


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
