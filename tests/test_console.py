"""Silence for a second, then a bar on a terminal or a line now and then."""

import io

import pytest

from avatarsim.console import Progress


class Clock:
    """A clock that a test sets."""

    def __init__(self) -> None:
        self.now = 100.0

    def monotonic(self) -> float:
        return self.now


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr("avatarsim.console.time", clock)
    return clock


def run(stream: io.StringIO | None, clock: Clock) -> None:
    """25 seconds of work, a word every half second."""
    with Progress("decomposing duck.obj", stream) as progress:
        for k in range(50):
            clock.now += 0.5
            progress.step(k / 50, f"{k} parts")


def test_lines_without_a_terminal(clock: Clock) -> None:
    stream = io.StringIO()
    run(stream, clock)
    lines = stream.getvalue().splitlines()
    assert len(lines) == 5 and lines[0].split() == ["decomposing", "duck.obj", "2", "%", "1.0", "s", "1", "parts"]


def test_a_bar_on_a_terminal_that_is_wiped_at_the_end(clock: Clock) -> None:
    stream = Terminal()
    run(stream, clock)
    drawn = stream.getvalue().split("\r")
    assert len(drawn) > 40 and "[###" in drawn[-4] and "\n" not in stream.getvalue()
    assert drawn[-2].strip() == "" and drawn[-1] == ""


def test_short_work_and_no_stream_say_nothing(clock: Clock) -> None:
    stream = io.StringIO()
    with Progress("quick", stream) as progress:
        clock.now += 0.9
        assert not progress.due and not Progress("quick", None).due
        progress.step(0.5, "x")
        assert stream.getvalue() == ""
        clock.now += 0.1
        assert progress.due
    run(None, clock)
