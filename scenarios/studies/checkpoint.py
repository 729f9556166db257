"""Checkpoint of a study: a line of JSON per answer, so that a stopped command resumes where it was."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

from avatarsim.errors import InvalidFile
from avatarsim.files import parsed_json, read_text
from avatarsim.running.sources import cpu, version
from runfiles.engines import about
from runfiles.files import plain, write_text
from scenarios.engines import known
from scenarios.run.provenance import code_hash

Entry = Mapping[str, Any]
"""One answer, as JSON holds it."""


def key_of(*parts: object) -> str:
    """Return sixteen hexadecimal digits of all that decides an answer: dataclasses, texts and numbers."""
    plain_parts = [asdict(part) if is_dataclass(part) and not isinstance(part, type) else part for part in parts]
    return _digest(json.dumps(plain(plain_parts), sort_keys=True))


def stamp() -> str:
    """Return sixteen hexadecimal digits of all sources, of the versions of all engines, and of the processor."""
    packages = sorted({package for name in known() for package in about(name).packages})
    engines = [f"{name} {path}" for name, path in known().items()]
    return _digest("|".join([code_hash(), cpu(), *engines, *(f"{package} {version(package)}" for package in packages)]))


def _digest(text: str) -> str:
    return hashlib.blake2b(text.encode("utf-8", "surrogatepass"), digest_size=8).hexdigest()


def _check(key: str, answer: Entry) -> str:
    """Return the checksum of a line: an answer that a disk or a hand has changed is found again."""
    return _digest(key + json.dumps(plain(answer), sort_keys=True))


class Checkpoint:
    """Answers by key, kept in a file; in memory alone without one. Answers of other sources are dropped from the file."""

    def __init__(self, path: Path | None = None, stamped: str | None = None) -> None:
        """`stamped` is the hash of the sources, by default that of those which run."""
        self.path, self.stamp = path, stamped if stamped is not None else stamp() if path else ""
        self.known: dict[str, Entry] = {}
        if path is not None and path.exists():
            # a line that a kill left half written costs its answer and no other
            lines = read_text(path, str(path), "the file of a study", errors="replace").splitlines()
            good = [line for line in lines if self._read(line)]
            if len(good) < len(lines):
                write_text(path, "".join(f"{line}\n" for line in good))

    def _read(self, line: str) -> bool:
        try:
            entry = parsed_json(line, "line", "one that a study wrote")
            key, answer = str(entry["key"]), dict(entry["answer"])
            if entry["stamp"] != self.stamp or entry["check"] != _check(key, answer):
                return False
            self.known[key] = answer
        except (InvalidFile, KeyError, TypeError, ValueError):
            return False
        return True

    def get(self, key: str) -> Entry | None:
        """Return an answer, None where there is none."""
        return self.known.get(key)

    def put(self, key: str, answer: Entry) -> None:
        """Keep an answer."""
        self.known[key] = answer
        if self.path is not None:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                line = {"stamp": self.stamp, "key": key, "check": _check(key, answer), "answer": plain(answer)}
                file.write(json.dumps(line, allow_nan=False) + "\n")
