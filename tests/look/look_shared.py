"""Drives on the docs site: opened from disk they report no error, request nothing, fit the window and play."""

from pathlib import Path

import pytest

from docs.extensions.shared_pages import DRIVES, write
from tests.look.browser import Browser
from tests.look.conftest import SCREENSHOTS
from tests.look.shown_pages import COLOURS, SHOWN


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the pages, as `make docs` builds them."""
    made = tmp_path_factory.mktemp("shared")
    write(made)
    return made


@pytest.mark.parametrize("name", DRIVES)
def test_a_drive_is_played_from_its_file_alone(folder: Path, opened: tuple[Browser, str], name: str) -> None:
    one, window = opened
    one.open(folder / f"{name}.html")
    one.until(f"{SHOWN} >= 0")
    assert one.value(COLOURS) > 30
    one.picture(SCREENSHOTS / f"shared-{name}-{window}.png")
    before = one.value(SHOWN)
    one.click("Play")
    one.until(f"{SHOWN} !== {before}")
    assert one.errors == [] and [each for each in one.requests if not each.startswith(("file:", "data:", "blob:"))] == []
    assert one.value("document.documentElement.scrollWidth <= innerWidth")
