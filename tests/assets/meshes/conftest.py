"""Every test of this room has a cache folder of its own."""

from pathlib import Path

import pytest

from tests.own_cache import keep_pieces_in


@pytest.fixture(autouse=True)
def cache_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which entries land."""
    return keep_pieces_in(tmp_path / "cache", monkeypatch)
