"""Pages of the WebSocket server: all files, nothing else, with a policy that limits their requests to it."""


import tomllib
from pathlib import Path

import pytest

from avatarsim.live.ports.pages import FILES, FOLDER, page
from tests.live.ports.opened import Opened


@pytest.mark.parametrize("path", FILES)
def test_a_page_is_served_with_a_policy_that_keeps_it_here(live: Opened, path: str) -> None:
    status, said = live.asked(path, "Host: localhost", upgrade=False)
    head, _, body = said.partition("\r\n\r\n")
    assert status == 200 and body.encode("latin-1") == (FOLDER / FILES[path]).read_bytes()
    assert "Content-Security-Policy: default-src 'none'; script-src 'self'" in head and "nosniff" in head
    assert not live.ports.refusals.counts


def test_every_file_of_the_folder_is_served_and_no_other() -> None:
    assert sorted(FILES.values()) == sorted(file.name for file in FOLDER.iterdir())
    assert page("/../pages.py") is None and page("") is None


def test_pages_are_in_the_package() -> None:
    root = Path(__file__).resolve().parents[3]
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    folder = FOLDER.relative_to(root / "avatarsim").as_posix()
    kept = project["tool"]["setuptools"]["package-data"]["avatarsim"]
    assert {f"{folder}/*{file.suffix}" for file in FOLDER.iterdir()} <= set(kept)
