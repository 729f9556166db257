"""Checkpoints of a sweep: a line of JSON per finished task; one that was stopped, or whose code did not change, goes on there."""

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from avatarsim.errors import InvalidFile
from avatarsim.files import parsed_json, read_text
from avatarsim.running.sources import version
from runfiles.files import plain, write_text
from scenarios.results.provenance import PACKAGES, code_hash
from scenarios.stability.outcome import ABSENT, TOO_LATE, Outcome, Task

NAME = "stability.jsonl"
"""The file of what is finished."""


PASSING = (TOO_LATE, ABSENT)
"""States that may be the machine's fault: too much else at work, a package that was not there. They are asked again."""


def stamp() -> str:
    """What decides an outcome besides the task: the sources, and the versions of all engines; sixteen hexadecimal digits."""
    text = "|".join([code_hash(), *(f"{name} {version(name)}" for name in PACKAGES)])
    return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


def key_of(task: Task) -> str:
    """Sixteen hexadecimal digits of a task."""
    return hashlib.blake2b(json.dumps(plain(asdict(task)), sort_keys=True).encode(), digest_size=8).hexdigest()


class Finished:
    """Outcomes by task, read from a file and added to it one by one; what other sources made is dropped from it."""

    def __init__(self, path: Path, stamped: str) -> None:
        self.path, self.stamped = path, stamped
        self.known: dict[str, Outcome] = {}
        if path.exists():
            # a byte that a killed sweep left half of costs its line and no other
            lines = read_text(path, str(path), "the file of a sweep of stability", errors="replace").splitlines()
            good = [line for line in lines if self._read(line)]
            if len(good) < len(lines):
                write_text(path, "".join(f"{line}\n" for line in good))

    def _read(self, line: str) -> bool:
        try:
            entry = parsed_json(line, "line", "what a sweep of stability wrote")
            if entry["stamp"] != self.stamped:
                return False
            self.known[str(entry["key"])] = Outcome.from_json(entry["outcome"])
        except (InvalidFile, KeyError, OverflowError, TypeError, ValueError):
            # the last line of a sweep that was killed may be half written; what it said is asked again
            return False
        return True

    def missing(self, tasks: Iterable[Task]) -> list[Task]:
        """Those that are not finished yet."""
        return [task for task in tasks if key_of(task) not in self.known]

    def of(self, task: Task) -> Outcome:
        """What came of a task that is finished."""
        return self.known[key_of(task)]

    def add(self, task: Task, done: Outcome) -> None:
        """Keep one more, in memory and, unless another day may have another answer, in the file."""
        key = key_of(task)
        self.known[key] = done
        if done.state in PASSING:
            return
        self.path.parent.mkdir(parents=True, exist_ok=True)
        entry = {"stamp": self.stamped, "key": key, "outcome": plain(done.as_json())}
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(entry, allow_nan=False) + "\n")
