"""A cache folder of its own for every mesh test."""

from pathlib import Path

import pytest

from tests.own_cache import keep_pieces_in


@pytest.fixture(autouse=True)
def cache_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder for cache entries."""
    return keep_pieces_in(tmp_path / "cache", monkeypatch)
