"""Windows in which pages are tested: wide and narrow, light and dark."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.look.browser import Browser, browser

SCREENSHOTS = Path(__file__).resolve().parents[2] / "reports" / "out" / "look"
SIZES = {"wide": (1400, 900), "narrow": (390, 900)}
WINDOWS = [f"{size}-{colours}" for size in SIZES for colours in ("light", "dark")]


COLOURS = """
(() => {
  const canvas = document.getElementById("view"), pen = canvas.getContext("2d");
  return new Set(new Uint32Array(pen.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
})()
"""
"""Number of different colours in a picture that a page draws by itself."""


@pytest.fixture(scope="module", params=WINDOWS)
def opened(request: pytest.FixtureRequest) -> Iterator[tuple[Browser, str]]:
    """Yield a browser with a window of each size, in each colour scheme, and a name for its screenshots."""
    size, _, colours = request.param.partition("-")
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    with browser(*SIZES[size], dark=colours == "dark") as one:
        yield one, request.param
