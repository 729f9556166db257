"""Progress: a bar on a terminal, plain lines elsewhere."""

import io

from scenarios.running.progress import Progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_lines_where_nobody_watches() -> None:
    stream = io.StringIO()
    with Progress("accuracy", 2, stream) as progress:
        progress.step("one")
        progress.step("two")
    lines = stream.getvalue().splitlines()
    assert [line.split()[1] for line in lines] == ["1/2", "2/2"] and lines[1].endswith("two") and "\r" not in stream.getvalue()


def test_a_bar_on_a_terminal() -> None:
    stream = Terminal()
    with Progress("accuracy", 2, stream) as progress:
        progress.step("one")
        progress.step("two")
    assert "\r" in stream.getvalue() and "2/2" in stream.getvalue() and "accuracy" in stream.getvalue()
