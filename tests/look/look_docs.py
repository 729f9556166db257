"""The docs site in a browser: opened from disk its pages report no error and request nothing but local files.

Not part of `make test`, which needs no browser: `make look` builds the site anew and leaves screenshots in reports/out/look/.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.look.browser import Browser
from tests.look.conftest import SCREENSHOTS

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.parametrize("opened", ["wide-light", "narrow-dark"], indirect=True)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the site, as `make docs` builds it."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "-b", "html", "-d", str(folder / "doctrees"), "-c", "docs", "."]
    subprocess.run([*command, str(folder / "html")], cwd=ROOT, check=True)
    return folder / "html"


def test_every_page_is_quiet_and_fits_the_window(site: Path, opened: tuple[Browser, str]) -> None:
    one, size = opened
    # the first page of the folder itself redirects to another one, which has a test of its own
    pages = sorted({*site.rglob("*.html")} - {site / "index.html"})
    assert len(pages) > 15
    for page in pages:
        one.open(page)
        assert one.errors == [], page.name
        assert [asked for asked in one.requests if not asked.startswith(("file:", "data:"))] == [], page.name
        assert one.value("document.documentElement.scrollWidth <= innerWidth"), f"{page.name} is wider than the {size} window"
        assert one.value("[...document.images].every((image) => image.naturalWidth > 0)"), f"{page.name} lacks an image"
        one.picture(SCREENSHOTS / f"docs-{page.stem}-{size}.png")


def test_formulas_are_drawn_and_words_are_found(site: Path, opened: tuple[Browser, str]) -> None:
    one, _ = opened
    one.open(site / "docs" / "equations.html")
    # a browser that does not draw MathML writes a fraction's two parts in one line
    tall = "[...document.querySelectorAll('div.math math')].map((one) => one.getBoundingClientRect().height)"
    heights = one.value(tall)
    assert len(heights) == 10 and max(heights) > 2.0 * min(heights) > 0.0
    # the folder itself leads to the first page
    one.open(site / "index.html")
    one.until("location.pathname.endsWith('/docs/index.html')")
    one.open(site / "search.html")
    one.value("location.search = '?q=certificate'")
    one.until("document.querySelectorAll('#search-results li').length > 2")
