"""Source of three.js (MIT), which draws what the player plays: read from an installed package when pages are written."""

import zipfile
from functools import cache
from importlib.util import find_spec
from pathlib import Path

ARCHIVE = ("resources", "templates", "viewer.zip")
"""Where the package trimesh keeps the page that carries the library."""
BEGINS, ENDS = "<script>", "\n(function(){"
"""The library is the page's first script, up to the first of the add-ons that follow it."""
MARK = "Three.js Authors"
"""Part of the library's licence, which stays with it."""
FILE = "three.js"
"""Its name beside pages."""


@cache
def library() -> str | None:
    """Return the source of three.js with its licence; None where there is none, or where it could end its script."""
    spec = find_spec("trimesh")
    for place in (spec and spec.submodule_search_locations) or ():
        try:
            with zipfile.ZipFile(Path(place).joinpath(*ARCHIVE)) as archive:
                page = archive.read(archive.namelist()[0]).decode("utf-8")
        except (OSError, zipfile.BadZipFile, IndexError, UnicodeDecodeError):
            continue
        source, ended, _ = page.partition(BEGINS)[2].partition(ENDS)
        if ended and MARK in source and "</script" not in source.lower():
            return source
    return None
