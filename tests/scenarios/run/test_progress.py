"""Progress: a bar on a terminal, elsewhere a line at the end and few before."""

import io

import pytest

from scenarios.run.progress import INTERVAL, Progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_lines_where_nobody_watches() -> None:
    stream = io.StringIO()
    with Progress("accuracy", 2, stream) as progress:
        progress.step("one")
        progress.step("two")
    lines = stream.getvalue().splitlines()
    assert [line.split()[:2] for line in lines] == [["accuracy", "2/2"]] and "\r" not in stream.getvalue()


def test_a_long_pass_says_in_between_that_it_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    stream, now = io.StringIO(), [0.0]
    monkeypatch.setattr("scenarios.run.progress.time.monotonic", lambda: now[0])
    with Progress("accuracy", 3, stream) as progress:
        for _ in range(3):
            now[0] += 0.7 * INTERVAL
            progress.step("one")
    assert [line.split()[1] for line in stream.getvalue().splitlines()] == ["2/3", "3/3"]


def test_a_bar_on_a_terminal() -> None:
    stream = Terminal()
    with Progress("accuracy", 2, stream) as progress:
        progress.step("one")
        progress.step("two")
    assert "\r" in stream.getvalue() and "2/2" in stream.getvalue() and "accuracy" in stream.getvalue()
