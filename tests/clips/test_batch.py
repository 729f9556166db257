"""Clips that a folder's certificate lists as not done: a damaged list is refused."""

from pathlib import Path

import pytest

from avatarsim.clips.batch import WHOLE, left_undone
from avatarsim.errors import InvalidFile


@pytest.mark.parametrize("content", [b"{", b"[]", b'{"not_done": 3}', b'{"not_done": [{"name": 3}]}', b"\xff"])
def test_a_damaged_certificate_of_the_folder_is_refused(tmp_path: Path, content: bytes) -> None:
    assert left_undone(tmp_path, frozenset()) == ()
    (tmp_path / WHOLE).write_bytes(content)
    with pytest.raises(InvalidFile, match=WHOLE):
        left_undone(tmp_path, frozenset())
