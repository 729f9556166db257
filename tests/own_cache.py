"""A cache of convex pieces that belongs to one test: files that earlier runs kept in any of the usual places are not seen."""

import tempfile
from pathlib import Path

import pytest

from avatarsim.files import bases
from avatarsim.jit.places import NAME, VARIABLE


def around_kernels() -> Path:
    """Return the folder around that of the kernels that this process uses."""
    known = bases(NAME, VARIABLE)
    return next((base for base in known if base.is_dir()), known[0]).parent


def keep_pieces_in(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Let a test read and keep pieces below a folder alone; returns the folder in which entries land. All places are read, not
    only the first, so that each of them is moved: the variables, the home folder and the temporary one. Compiled kernels stay
    where they are: their folder is chosen once, and from an empty one on a process compiles all that it uses."""
    monkeypatch.setenv(VARIABLE, str(around_kernels()))
    monkeypatch.delenv("AVATARSIM_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    monkeypatch.setenv("HOME", str(folder / "home"))
    temporary = folder.parent / f"{folder.name}-temporary"
    temporary.mkdir(parents=True)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    return folder / "avatarsim-pieces"
