"""Every metric has a name in words, told apart from every other, and a page shows those instead of the metric's identifier."""

import re
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import pytest

from reports import write_report
from reports.words.metric_words import WORDS, words
from runfiles.metrics import METRICS

Json = dict[str, object]


@pytest.mark.parametrize("metric", METRICS)
def test_every_metric_has_words(metric: str) -> None:
    assert metric in WORDS
    assert "_" not in words(metric) and words(metric)[0].islower() and len(words(metric)) <= 60


def test_no_two_metrics_share_their_words() -> None:
    assert len(set(WORDS.values())) == len(WORDS)


@pytest.mark.parametrize(("metric", "said"), [
    ("stage_share_coupling", "share of the frame in coupling"), ("rows_dropped_per_frame", "rows dropped per frame"),
    ("of_another_version", "of another version"),
])
def test_families_and_strangers_lose_their_underscores(metric: str, said: str) -> None:
    assert words(metric) == said


class Shown(HTMLParser):
    """Text that a reader sees: no scripts, no styles, no identifiers in <code>."""

    def __init__(self) -> None:
        super().__init__()
        self.text: list[str] = []
        self._inside = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside += tag in ("script", "style", "code")

    def handle_endtag(self, tag: str) -> None:
        self._inside -= tag in ("script", "style", "code")

    def handle_data(self, data: str) -> None:
        if not self._inside:
            self.text.append(data)


def test_pages_speak_of_metrics_in_words(run_dir: Callable[[object], Path], results: Json) -> None:
    folder = run_dir(results)
    write_report(folder)
    pages = [folder / "index.html", *(folder / "scenes").glob("*.html")]
    assert len(pages) == 4
    for page in pages:
        shown = Shown()
        shown.feed(page.read_text(encoding="utf-8"))
        text = " ".join(shown.text)
        identifiers = [metric for metric in METRICS if "_" in metric and re.search(rf"\b{metric}\b", text)]
        assert identifiers == [], page.name
    index = (folder / "index.html").read_text(encoding="utf-8")
    assert "error of restitution" in index and 'title="restitution_error_max"' in index
