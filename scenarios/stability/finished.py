"""What is finished, a line of JSON each, so that a sweep that was stopped, or whose code did not change, goes on from there."""

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from scenarios.files import plain
from scenarios.provenance import PACKAGES, code_hash, version
from scenarios.stability.outcome import Outcome, Task

NAME = "stability.jsonl"
"""The file, beside the results of a run."""


def stamp() -> str:
    """What every key holds: the sources that decide what is shown, and the versions of all engines."""
    return "|".join([code_hash(), *(f"{name} {version(name)}" for name in PACKAGES)])


def key_of(task: Task, stamped: str) -> str:
    """Sixteen hexadecimal digits of a task done by these sources."""
    text = json.dumps([stamped, plain(asdict(task))], sort_keys=True)
    return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


class Finished:
    """Outcomes by key, read from a file and added to it one by one."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.known: dict[str, Outcome] = {}
        if path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                self._read(line)

    def _read(self, line: str) -> None:
        try:
            entry = json.loads(line)
            self.known[str(entry["key"])] = Outcome.from_json(entry["outcome"])
        except (ValueError, KeyError, TypeError):
            # the last line of a sweep that was killed may be half written; what it said is asked again
            return

    def missing(self, tasks: Iterable[Task], stamped: str) -> list[Task]:
        """Those that nobody has done yet."""
        return [task for task in tasks if key_of(task, stamped) not in self.known]

    def add(self, task: Task, stamped: str, done: Outcome) -> None:
        """Keep one more, in memory and in the file."""
        key = key_of(task, stamped)
        self.known[key] = done
        self.path.parent.mkdir(parents=True, exist_ok=True)
        entry = {"key": key, "outcome": plain(done.as_json())}
        with self.path.open("a", encoding="utf-8") as file:
            # a line that was cut off must not swallow the next one
            file.write(("" if file.tell() == 0 else "\n") + json.dumps(entry, allow_nan=False))
