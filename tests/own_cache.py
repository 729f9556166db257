"""A cache of convex pieces that belongs to one test: files that earlier runs kept in any of the usual places are not seen."""

import tempfile
from pathlib import Path

import pytest


def keep_pieces_in(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Let a test read and keep pieces below a folder alone; returns the folder in which entries land. All places are read, not
    only the first, so that each of them is moved: the variables, the home folder and the temporary one."""
    monkeypatch.delenv("AVATARSIM_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    monkeypatch.setenv("HOME", str(folder / "home"))
    temporary = folder.parent / f"{folder.name}-temporary"
    temporary.mkdir(parents=True)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    return folder / "avatarsim-pieces"
