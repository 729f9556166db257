"""State is read by name: `state.is_pressed`, not `flags[PRESSED]`, so that a search finds what writes and what reads a field."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

HOUSE = Path(__file__).resolve().parents[2]
FILES = sorted((HOUSE / "avatarsim").rglob("*.py"))

BY_PLACE = {
    "counts": "what is counted in a frame: names and numbers go to a record together (`counters.Tally`)",
    "counts_out": "the same",
    "c": "the same",
    "tally": "the same, of overlaps",
    "rows": "packed rows of the contact solver: places are offsets of vectors of four (`rigid/solver.py`)",
    "words": "the head of an arena, which has no names before it is opened (`jit/arena.py`)",
    "jobs": "rows of addresses that Python hands to one kernel call (`batch.py`)",
    "row": "the same", "_job": "the same",
    "lead": "the fourth column of the broad phase's room to move",
    "node": "the target of a followed path is the node AIM of its tree",
    "known": "a mask of bits, no place", "height": "a capacity, no place",
}
"""Arrays that a constant may index, and why."""


def indexed(file: Path) -> Iterator[str]:
    """Arrays of a file that are indexed by a constant in capitals, as `array[NAME]` or `array[NAME, k]`."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Subscript):
            # a slice takes a part and no field
            places = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            kept = [place for place in places if not isinstance(place, ast.Slice)]
            names = [part.id for place in kept for part in ast.walk(place) if isinstance(part, ast.Name)]
            if any(name.isupper() and len(name) > 1 for name in names):
                yield ast.unparse(node.value).split(".")[-1]


@pytest.mark.parametrize("file", FILES, ids=[str(file.relative_to(HOUSE)) for file in FILES])
def test_no_state_is_read_by_number(file: Path) -> None:
    assert set(indexed(file)) - set(BY_PLACE) == set()


def test_each_exception_is_needed() -> None:
    assert set(BY_PLACE) <= {name for file in FILES for name in indexed(file)}
