"""Check of results.json against its published schema: when a run has ended, and by every reader."""

import json
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from avatarsim.errors import InvalidFile

SCHEMA = Path(__file__).with_name("schemas") / "results-1.json"
"""The published JSON Schema; a new layout gets a new file and a new number."""
WORDS = ("NaN", "Infinity", "-Infinity")
LONGEST = 80
"""Characters of a wrong value that are shown."""


def check(data: object, path: Path) -> None:
    """Raise InvalidFile with the first place that the schema does not allow, its value and the allowed ones."""
    from jsonschema.exceptions import best_match

    error = best_match(_validator().iter_errors(data))
    if error is not None:
        where = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in error.absolute_path).removeprefix(".")
        text = json.dumps(error.instance, ensure_ascii=False, default=str)
        shortened = text if len(text) <= LONGEST else f"{text[:LONGEST]}..."
        raise InvalidFile(f"{where or 'top level'} of {path}", shortened, f"as {SCHEMA.name} has it: {error.message[:200]}")


@cache
def _validator() -> Any:
    from jsonschema import Draft202012Validator
    from jsonschema.validators import extend

    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))

    def items(validator: Any, wanted: object, instance: object, around: Mapping[str, object]) -> Iterator[Any]:
        """Check one of all elements that look the same to the schema; a run has tens of thousands of rows."""
        if isinstance(instance, list):
            # of those that look alike the first
            first = {_look(element): index for index, element in reversed(list(enumerate(instance)))}
            for index in sorted(first.values()):
                yield from validator.descend(instance[index], wanted, path=index)

    return extend(Draft202012Validator, {"items": items})(schema)


def _look(element: object) -> object:
    """Return all that the schema distinguishes in an element: types, words for numbers, the status of a row, nested content."""
    if isinstance(element, dict):
        return tuple((key, _look(value) if key != "status" else str(value)) for key, value in sorted(element.items()))
    if isinstance(element, str):
        return element if element in WORDS else str
    return json.dumps(element) if isinstance(element, list) else type(element)


SCHEMA_VERSION = 1
"""Layout of results.json; reports refuse every other."""
MAX_BYTES = 2**29
"""Bytes of a results.json that is read. A comparison at full lengths with all engines takes a tenth of it."""
