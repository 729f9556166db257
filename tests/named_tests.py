"""Tests that a file holds: tables of claims that name tests are compared with them."""

import ast
from functools import cache
from pathlib import Path

TESTS = Path(__file__).resolve().parent


@cache
def names_in(file: str) -> frozenset[str]:
    """Return names of the tests in a file, given from `tests/`."""
    tree = ast.parse((TESTS / file).read_text(encoding="utf-8"))
    return frozenset(node.name for node in tree.body if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"))


def exists(entry: str) -> bool:
    """Return whether "file::function" is there."""
    file, _, function = entry.partition("::")
    return function in names_in(file)
