"""Settings that a user brings for an engine: each adds a row of its own beside the engine's presets."""

import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from avatarsim.errors import InvalidFile, UnknownName

EXAMPLE = "scenarios/settings_example.toml"
"""A file that every engine takes as it is, from the folder of the checkout."""
NAME = re.compile(r"[A-Za-z0-9_.=-]+")
"""What a row may be called: its name becomes part of file names, addresses and tables."""


@dataclass(frozen=True)
class OwnSettings:
    """`name` of the row, the engine's preset `base` to begin from, and the `options` that override it."""

    engine: str
    name: str
    base: str
    options: Mapping[str, object]


def read(path: Path, engines: Iterable[str]) -> tuple[OwnSettings, ...]:
    """Read a TOML file with a table [engine.name] per row: `preset` is the base ("default"), all else are options.

    Raises InvalidFile, or UnknownName for an engine that nobody registered."""
    known = list(engines)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", "a readable TOML file") from error
    rows = []
    for engine, tables in content.items():
        if engine not in known:
            raise UnknownName(f"engine in {path}", engine, known)
        if not isinstance(tables, dict) or not tables or not all(isinstance(entry, dict) for entry in tables.values()):
            raise InvalidFile(f"[{engine}] in {path}", tables, f"tables [{engine}.name] with settings in them")
        for name, entry in tables.items():
            if not NAME.fullmatch(name):
                valid = "letters a to z, digits, - _ . =: it becomes part of file names"
                raise InvalidFile(f"name of a row in {path}", name, valid)
            options = {key: value for key, value in entry.items() if key != "preset"}
            rows.append(OwnSettings(engine, name, str(entry.get("preset", "default")), options))
    if not rows:
        raise InvalidFile(str(path), "nothing", "a table [engine.name] for each row")
    return tuple(rows)
