"""Source of three.js (MIT), which draws the replays: read from an installed package when a report is written, never kept here."""

import zipfile
from functools import cache
from importlib.metadata import PackageNotFoundError
from importlib.util import find_spec
from pathlib import Path

ARCHIVE = ("resources", "templates", "viewer.zip")
"""Where the package trimesh keeps the page that carries the library."""
BEGINS, ENDS = "<script>", "\n(function(){"
"""The library is the page's first script, up to the first of the add-ons that follow it."""
MARK = "Three.js Authors"
"""Stands in the library's licence, which stays with it."""
WORDS = (
    "The 3D replay is not here: three.js draws it, which is read from the Python package trimesh, and that is not installed or "
    "holds no three.js. pip install '.[assets]', then make report."
)


@cache
def library() -> str | None:
    """The source text of three.js with its licence; None where there is none, or where it could end the script it stands in."""
    try:
        spec = find_spec("trimesh")
        if spec is None or not spec.submodule_search_locations:
            return None
        path = Path(next(iter(spec.submodule_search_locations))).joinpath(*ARCHIVE)
        with zipfile.ZipFile(path) as archive:
            page = archive.read(archive.namelist()[0]).decode("utf-8")
    except (ImportError, PackageNotFoundError, OSError, zipfile.BadZipFile, KeyError, IndexError, UnicodeDecodeError):
        return None
    _, begun, rest = page.partition(BEGINS)
    source, ended, _ = rest.partition(ENDS)
    sound = begun and ended and MARK in source and "</script" not in source.lower()
    return source if sound else None
