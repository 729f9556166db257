"""Source of three.js (MIT), the player's renderer: read from an installed package when pages are written."""

import zipfile
from functools import cache
from importlib.util import find_spec
from pathlib import Path

ARCHIVE = ("resources", "templates", "viewer.zip")
"""Path of the page that contains the library in the package trimesh."""
BEGINS, ENDS = "<script>", "\n(function(){"
"""Marks around the library: it is the page's first script, up to the first of the add-ons that follow it."""
MARK = "Three.js Authors"
"""Part of the library's licence, which is kept with it."""
FILE = "three.js"
"""File name of the library next to pages."""


@cache
def library() -> str | None:
    """Return the source of three.js with its licence; None if it is missing or could end its script element."""
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
