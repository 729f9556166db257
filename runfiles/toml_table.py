"""TOML tables that are read key by key: each error names the file, the key, the value and the valid range."""

import re
from collections.abc import Collection, Mapping
from pathlib import Path

from avatarsim.errors import InvalidFile
from avatarsim.files import read_toml


class Table:
    """One table of a file. Each method takes out the key that it returns; `end` rejects keys that are left.

    Args:
        path: the file.
        values: the keys of the table.
        place: path of the table in its file, with a dot at its end, "" for the whole file.
    """

    def __init__(self, path: Path, values: Mapping[str, object], place: str = "") -> None:
        self.path, self._values, self._place = path, dict(values), place

    @classmethod
    def read(cls, path: Path) -> "Table":
        """Read a file. Raises InvalidFile."""
        return cls(path, read_toml(path, str(path), "a readable TOML file"))

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def invalid(self, key: str, value: object, valid: str) -> InvalidFile:
        """Return the error that the value of a key is not valid."""
        return InvalidFile(f"{self._place}{key} in {self.path}", value, valid)

    def text(self, key: str, default: str | None = None, pattern: str = "(?s).+", valid: str = "a text") -> str:
        """Return a text that matches `pattern`. Without a default the key is required."""
        value = self._values.pop(key, default)
        if not isinstance(value, str) or (value != default and not re.fullmatch(pattern, value)):
            raise self.invalid(key, value, valid)
        return value

    def flag(self, key: str, default: bool = False) -> bool:
        """Return true or false."""
        value = self._values.pop(key, default)
        if not isinstance(value, bool):
            raise self.invalid(key, value, "true or false")
        return value

    def whole(self, key: str, default: int) -> int:
        """Return a whole number from 1 on."""
        value = self._values.pop(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise self.invalid(key, value, "a whole number from 1 on")
        return value

    def texts(self, key: str, known: Collection[str] | None = None, required: bool = False) -> tuple[str, ...]:
        """Return a list of texts, each one of `known` if that is given."""
        values = self._values.pop(key, [])
        valid = "a list of texts" if known is None else f"a list of {', '.join(sorted(known))}"
        if not isinstance(values, list) or not all(isinstance(one, str) for one in values) or (required and not values):
            raise self.invalid(key, values, valid)
        for one in values:
            if known is not None and one not in known:
                raise self.invalid(key, one, valid)
        return tuple(values)

    def one_of(self, key: str, known: Collection[str]) -> str:
        """Return a text that is one of `known`."""
        return self.text(key, None, "|".join(map(re.escape, known)), f"one of {', '.join(known)}")

    def numbers(self, key: str) -> tuple[int, ...]:
        """Return a list of whole numbers from 1 on."""
        values = self._values.pop(key, [])
        if not isinstance(values, list) or not all(type(one) is int and one > 0 for one in values):
            raise self.invalid(key, values, "a list of whole numbers from 1 on")
        return tuple(values)

    def options(self, key: str) -> dict[str, object]:
        """Return a table of values, lists as tuples."""
        values = self._values.pop(key, {})
        if not isinstance(values, dict):
            raise self.invalid(key, values, "a table")
        return Table(self.path, values).rest()

    def rest(self) -> dict[str, object]:
        """Return all keys that are left, lists as tuples."""
        values, self._values = self._values, {}
        return {name: tuple(value) if isinstance(value, list) else value for name, value in values.items()}

    def tables(self, key: str) -> dict[str, "Table"]:
        """Return the tables [key.NAME] by name."""
        values = self.options(key)
        for name, value in values.items():
            if not isinstance(value, dict):
                raise self.invalid(f"{key}.{name}", value, "a table")
        return {name: Table(self.path, value, f"{self._place}{key}.{name}.") for name, value in values.items()}

    def rows(self, key: str) -> list["Table"]:
        """Return the tables of a list."""
        values = self._values.pop(key, [])
        if not isinstance(values, list) or not all(isinstance(one, dict) for one in values):
            raise self.invalid(key, values, "a list of tables")
        return [Table(self.path, one, f"{self._place}{key}[{k}].") for k, one in enumerate(values)]

    def end(self, known: Collection[str]) -> None:
        """Raise InvalidFile for a key that nothing has taken; `known` are the valid ones."""
        for key, value in self._values.items():
            raise self.invalid(key, value, f"one of the keys {', '.join(sorted(known))}")
