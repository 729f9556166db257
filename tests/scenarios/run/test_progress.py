"""Progress: a bar on a terminal, otherwise a final line and few lines before."""

import io

import pytest

from scenarios.run.progress import INTERVAL, Progress


@pytest.mark.parametrize(("pause", "counts"), [(0.0, ["3/3"]), (0.7 * INTERVAL, ["2/3", "3/3"])])
def test_a_line_at_the_end_and_few_before(pause: float, counts: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    stream, now = io.StringIO(), [0.0]
    monkeypatch.setattr("scenarios.run.progress.time.monotonic", lambda: now[0])
    with Progress("accuracy", 3, stream) as progress:
        for _ in range(3):
            now[0] += pause
            progress.step("one")
    assert [line.split()[:2] for line in stream.getvalue().splitlines()] == [["accuracy", count] for count in counts]
    assert "\r" not in stream.getvalue()
