"""The docs site in a browser: opened from disk its pages complain of nothing and ask for nothing but files beside them.

Not part of `make test`, which needs no browser: `make look` builds the site anew and leaves screenshots in reports/out/look/.
"""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.look.browser import Browser, browser

ROOT = Path(__file__).resolve().parents[2]
SCREENSHOTS = ROOT / "reports" / "out" / "look"
SIZES = {"wide": (1400, 900, False), "narrow": (390, 900, True)}
"""Width and height of the window [px], and whether its user likes the dark."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, as `make docs` builds it."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "-b", "html", "-d", str(folder / "doctrees"), "-c", "docs", "."]
    subprocess.run([*command, str(folder / "html")], cwd=ROOT, check=True)
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    return folder / "html"


@pytest.fixture(scope="module", params=SIZES)
def window(request: pytest.FixtureRequest) -> Iterator[tuple[str, Browser]]:
    """A browser of one size."""
    width, height, dark = SIZES[request.param]
    with browser(width, height, dark) as opened:
        yield request.param, opened


def test_every_page_is_quiet_and_fits_the_window(site: Path, window: tuple[str, Browser]) -> None:
    size, opened = window
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 15
    for page in pages:
        opened.open(page)
        assert opened.errors == [], page.name
        assert [asked for asked in opened.requests if not asked.startswith(("file:", "data:"))] == [], page.name
        assert opened.value("document.documentElement.scrollWidth <= innerWidth"), f"{page.name} is wider than the {size} window"
        assert opened.value("[...document.images].every((one) => one.naturalWidth > 0)"), f"{page.name} lacks an image"
        opened.picture(SCREENSHOTS / f"docs-{page.stem}-{size}.png")


def test_formulas_are_drawn(site: Path, window: tuple[str, Browser]) -> None:
    _, opened = window
    opened.open(site / "docs" / "equations.html")
    # a browser that does not draw MathML writes a fraction's two parts in one line
    tall = "[...document.querySelectorAll('div.math math')].map((one) => one.getBoundingClientRect().height)"
    heights = opened.value(tall)
    assert len(heights) == 10 and max(heights) > 2.0 * min(heights) > 0.0


def test_the_folder_itself_leads_to_the_first_page(site: Path, window: tuple[str, Browser]) -> None:
    _, opened = window
    opened.open(site / "index.html")
    opened.until("location.pathname.endsWith('/docs/index.html')")


def test_a_word_is_found(site: Path, window: tuple[str, Browser]) -> None:
    _, opened = window
    opened.open(site / "search.html", "")
    opened.value("location.search = '?q=certificate'")
    opened.until("document.querySelectorAll('#search-results li').length > 2")
