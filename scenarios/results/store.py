"""Store of results by content hash: one small file each, whole or absent, so that a killed run loses nothing it had finished.

An entry carries the checksum of its content: commands take it as they wrote it; what a disk or a hand has changed is found again.
"""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.files import read_json
from runfiles.files import clear_halves, plain, write_json

Entry = Mapping[str, Any]


class Store:
    """Entries in `folder`, which is made. Raises InvalidInput where none can be made."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InvalidInput("folder of results", str(folder), "a folder that can be made") from error
        clear_halves(folder)

    def path(self, kind: str, key: str) -> Path:
        """The file of one entry."""
        return self.folder / f"{key}.{kind}.json"

    def get(self, kind: str, key: str) -> Entry | None:
        """The entry, None where there is none or where what lies there is not one: it is then found again."""
        path = self.path(kind, key)
        try:
            found = read_json(path, str(path), "an entry of the store")
        except InvalidFile:
            return None
        if not isinstance(found, dict) or found.pop("sha256", "") != _checksum(found):
            return None
        return found if found.get("key") == key and found.get("kind") == kind else None

    def put(self, kind: str, key: str, entry: Entry) -> None:
        """Keep an entry."""
        content = {"key": key, "kind": kind, **entry}
        write_json(self.path(kind, key), {**content, "sha256": _checksum(content)})


def _checksum(content: Entry) -> str:
    """Of JSON as it is written, which an entry that was read has again."""
    return hashlib.sha256(json.dumps(plain(content)).encode("utf-8", "surrogatepass")).hexdigest()
